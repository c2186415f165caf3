#include "scenes/floor_light.h"

#include <cassert>

namespace sheaf::scenes {
namespace {

constexpr int kKeyDirections = 16;
constexpr int kSkyDirections = 32;
constexpr double kKeyRadius = 0.055;  // tangent of the key's half angle: what makes its shadows soft

/// Direction i of n, evenly spread over the unit disc: a sunflower pattern by repeated turns of the golden angle, with
/// square roots only.
std::vector<std::array<double, 2>> discDirections(int n) {
  constexpr double kCosGolden = -0.7373688780783197;
  constexpr double kSinGolden = 0.6754902942615238;
  std::vector<std::array<double, 2>> points;
  std::array<double, 2> turn = {1.0, 0.0};
  for (int i = 0; i < n; ++i) {
    const double radius = std::sqrt((i + 0.5) / n);
    points.push_back({radius * turn[0], radius * turn[1]});
    turn = {turn[0] * kCosGolden - turn[1] * kSinGolden, turn[0] * kSinGolden + turn[1] * kCosGolden};
  }
  return points;
}

/// The shadow of triangles on the floor for one direction, as a mask of texels.
class ShadowMask {
 public:
  explicit ShadowMask(const FloorArea& area)
      : area_(area), texels_(static_cast<std::size_t>(area.texels) * static_cast<std::size_t>(area.texels)) {}

  void clear() { texels_.assign(texels_.size(), 0); }
  const std::vector<std::uint8_t>& texels() const { return texels_; }

  /// Marks the texels whose centres the shadow of the triangle covers. Points below the floor count as lying on it.
  void add(const std::array<DVec3, 3>& triangle, const DVec3& to_light) {
    std::array<std::array<double, 2>, 3> p;
    bool above = false;
    for (std::size_t i = 0; i < 3; ++i) {
      const double height = triangle[i].y - area_.height;
      above = above || height > 1e-6;
      const double shift = std::max(height, 0.0) / to_light.y;
      p[i] = {toTexel(triangle[i].x - shift * to_light.x - area_.center_x),
              toTexel(triangle[i].z - shift * to_light.z - area_.center_z)};
    }
    if (above) fill(p);
  }

 private:
  double toTexel(double from_center) const { return (from_center / area_.side + 0.5) * area_.texels; }

  /// Only triangles that face the light: a solid's other ones shade the same texels once more.
  void fill(const std::array<std::array<double, 2>, 3>& p) {
    const double last = area_.texels - 1.0;
    const auto first = [&](double lo) { return static_cast<int>(std::clamp(std::ceil(lo - 0.5), 0.0, last + 1.0)); };
    const auto end = [&](double hi) { return static_cast<int>(std::clamp(std::floor(hi - 0.5), -1.0, last)) + 1; };
    const auto edge = [](const std::array<double, 2>& a, const std::array<double, 2>& b, double x, double y) {
      return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
    };
    const double area = edge(p[0], p[1], p[2][0], p[2][1]);
    if (area >= 0.0) return;
    const int x_end = end(std::max({p[0][0], p[1][0], p[2][0]}));
    const int y_end = end(std::max({p[0][1], p[1][1], p[2][1]}));
    for (int y = first(std::min({p[0][1], p[1][1], p[2][1]})); y < y_end; ++y)
      for (int x = first(std::min({p[0][0], p[1][0], p[2][0]})); x < x_end; ++x) {
        const double cx = x + 0.5;
        const double cy = y + 0.5;
        const bool inside =
            edge(p[0], p[1], cx, cy) <= 0.0 && edge(p[1], p[2], cx, cy) <= 0.0 && edge(p[2], p[0], cx, cy) <= 0.0;
        if (inside)
          texels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(area_.texels) + static_cast<std::size_t>(x)] =
              1;
      }
  }

  FloorArea area_;
  std::vector<std::uint8_t> texels_;
};

std::vector<std::array<DVec3, 3>> worldTriangles(std::span<const Occluder> occluders) {
  std::vector<std::array<DVec3, 3>> triangles;
  for (const Occluder& o : occluders)
    for (const mesh::Triangle& t : o.mesh->triangles) {
      std::array<DVec3, 3>& world = triangles.emplace_back();
      for (std::size_t i = 0; i < 3; ++i)
        world[i] = DVec3(o.world_from_object * DVec4(DVec3(o.mesh->positions[t[i]]), 1.0));
    }
  return triangles;
}

/// Mean over the directions of what is lit.
LightMap litPart(const FloorArea& area, const std::vector<std::array<DVec3, 3>>& triangles,
                 const std::vector<DVec3>& directions) {
  ShadowMask mask(area);
  std::vector<int> shadowed(mask.texels().size(), 0);
  for (const DVec3& to_light : directions) {
    mask.clear();
    for (const auto& t : triangles) mask.add(t, to_light);
    for (std::size_t i = 0; i < shadowed.size(); ++i) shadowed[i] += mask.texels()[i];
  }
  LightMap lit{area.texels, std::vector<float>(shadowed.size())};
  const auto count = static_cast<double>(directions.size());
  for (std::size_t i = 0; i < shadowed.size(); ++i) lit.values[i] = static_cast<float>(1.0 - shadowed[i] / count);
  return lit;
}

/// Mean over a (2 radius + 1)^2 neighbourhood: hides the steps that a finite number of directions leaves.
void blur(LightMap& map, int radius) {
  std::vector<float> line(static_cast<std::size_t>(map.side));
  for (const bool along_x : {true, false})
    for (int k = 0; k < map.side; ++k) {
      const auto at = [&](int i) -> float& {
        const int c = std::clamp(i, 0, map.side - 1);
        return map.values[static_cast<std::size_t>((along_x ? k : c) * map.side + (along_x ? c : k))];
      };
      for (int i = 0; i < map.side; ++i) {
        double sum = 0.0;
        for (int d = -radius; d <= radius; ++d) sum += static_cast<double>(at(i + d));
        line[static_cast<std::size_t>(i)] = static_cast<float>(sum / (2 * radius + 1));
      }
      for (int i = 0; i < map.side; ++i) at(i) = line[static_cast<std::size_t>(i)];
    }
}

}  // namespace

FloorLight computeFloorLight(const FloorArea& area, std::span<const Occluder> occluders,
                             const DVec3& direction_to_key) {
  assert(direction_to_key.y > 0.0);
  const std::vector<std::array<DVec3, 3>> triangles = worldTriangles(occluders);

  std::vector<DVec3> key;
  const DVec3 aside = glm::normalize(glm::cross(direction_to_key, DVec3(0.0, 0.0, 1.0)));
  const DVec3 along = glm::cross(direction_to_key, aside);
  for (const auto& [a, b] : discDirections(kKeyDirections))
    key.push_back(direction_to_key + kKeyRadius * (a * aside + b * along));

  // Points of the disc lifted to the hemisphere are spread by the cosine with which the floor receives them. The disc
  // stops short of the horizon, whose shadows are without end.
  std::vector<DVec3> sky;
  for (const auto& [a, b] : discDirections(kSkyDirections)) {
    const double x = 0.97 * a;
    const double z = 0.97 * b;
    sky.emplace_back(x, std::sqrt(1.0 - x * x - z * z), z);
  }

  FloorArea coarse = area;
  coarse.texels = std::max(1, area.texels / 4);
  FloorLight light{litPart(area, triangles, key), litPart(coarse, triangles, sky)};
  blur(light.key, std::max(1, area.texels / 512));
  blur(light.sky, 2);
  blur(light.sky, 2);
  return light;
}

double LightMap::at(double u, double v) const {
  assert(side >= 2);
  const double x = std::clamp(u * side - 0.5, 0.0, side - 1.0);
  const double y = std::clamp(v * side - 0.5, 0.0, side - 1.0);
  const auto i = static_cast<std::size_t>(std::min(x, side - 2.0));
  const auto j = static_cast<std::size_t>(std::min(y, side - 2.0));
  const double fx = x - static_cast<double>(i);
  const double fy = y - static_cast<double>(j);
  const float* top = values.data() + j * static_cast<std::size_t>(side) + i;
  const float* bottom = top + side;
  const auto mix = [fx](const float* row) {
    return static_cast<double>(row[0]) * (1.0 - fx) + static_cast<double>(row[1]) * fx;
  };
  return mix(top) * (1.0 - fy) + mix(bottom) * fy;
}

}  // namespace sheaf::scenes
