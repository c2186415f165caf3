// The Cornell box (Goral, Torrance, Greenberg, Battaile, SIGGRAPH 1984), dimensions after the measured data that
// Cornell University's Program of Computer Graphics published; here ten times as large, with the opening towards +Z and
// the floor's middle near the origin. The renderer has neither area lights nor reflected light, so both are computed
// here, once, into vertex colours: radiosity on a coarse grid of patches.
#include "scenes/builtin_scenes.h"
#include "scenes/shapes.h"

namespace sheaf::scenes {
namespace {

constexpr int kLattice = 24;     // light is computed at (kLattice + 1)^2 points of every face
constexpr int kPatches = 6;      // reflected light comes from kPatches^2 patches of every face
constexpr int kLampPatches = 5;  // per side of the lamp
constexpr int kBounces = 4;
constexpr double kLampRadiance = 27.0;  // saturates to white, as on the published pictures

/// A parallelogram, nearly: the box's walls are not quite rectangular. Counter-clockwise from the top left, seen from
/// the side that is lit.
struct Face {
  std::array<DVec3, 4> corners;
  DVec3 reflectance;
  double emitted = 0.0;

  DVec3 at(double u, double v) const {
    return glm::mix(glm::mix(corners[0], corners[3], u), glm::mix(corners[1], corners[2], u), v);
  }
  DVec3 normal() const { return glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0])); }
  double area() const {
    return 0.5 * (glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0])) +
                  glm::length(glm::cross(corners[2] - corners[0], corners[3] - corners[0])));
  }
};

/// A convex block that stands on the floor: the inside of its five visible faces.
struct Block {
  std::vector<Face> faces;
};

/// From the published frame (seen through the opening x grows to the left and z into the box; millimetres) to ours.
/// The real box is half a metre wide; here it is ten times as large.
DVec3 fromMeasured(double x, double y, double z) {
  return DVec3(278.0 - x, y, 279.6 - z) * 0.01;
}

const DVec3 kWhite(0.73, 0.71, 0.68);
const DVec3 kRed(0.57, 0.04, 0.04);
const DVec3 kGreen(0.10, 0.38, 0.08);

std::vector<Face> walls() {
  const auto m = fromMeasured;
  return {
      {{m(549.6, 0, 559.2), m(552.8, 0, 0), m(0, 0, 0), m(0, 0, 559.2)}, kWhite},                // floor
      {{m(556, 548.8, 0), m(556, 548.8, 559.2), m(0, 548.8, 559.2), m(0, 548.8, 0)}, kWhite},    // ceiling
      {{m(556, 548.8, 559.2), m(549.6, 0, 559.2), m(0, 0, 559.2), m(0, 548.8, 559.2)}, kWhite},  // back
      {{m(556, 548.8, 0), m(552.8, 0, 0), m(549.6, 0, 559.2), m(556, 548.8, 559.2)}, kRed},      // left
      {{m(0, 548.8, 559.2), m(0, 0, 559.2), m(0, 0, 0), m(0, 548.8, 0)}, kGreen},                // right
      // A centimetre below the ceiling, so that depth keeps the two apart.
      {{m(343, 547.8, 227), m(343, 547.8, 332), m(213, 547.8, 332), m(213, 547.8, 227)}, DVec3(0.0), kLampRadiance},
  };
}

/// footprint  measured (x, z), counter-clockwise seen from above in our frame
Block block(const std::array<std::array<double, 2>, 4>& footprint, double height) {
  const auto corner = [&](std::size_t i, double y) {
    return fromMeasured(footprint[i % 4][0], y, footprint[i % 4][1]);
  };
  Block b;
  b.faces.push_back({{corner(2, height), corner(3, height), corner(0, height), corner(1, height)}, kWhite});
  for (std::size_t i = 0; i < 4; ++i)
    b.faces.push_back({{corner(i, height), corner(i, 0.0), corner(i + 1, 0.0), corner(i + 1, height)}, kWhite});
  return b;
}

std::vector<Block> blocks() {
  return {block({{{130, 65}, {82, 225}, {240, 272}, {290, 114}}}, 165.0),
          block({{{423, 247}, {265, 296}, {314, 456}, {472, 406}}}, 330.0)};
}

/// True if the open segment passes through the inside of a block; touching a face does not count.
bool isBlocked(const std::vector<Block>& all, const DVec3& from, const DVec3& to) {
  for (const Block& b : all) {
    double enter = 0.0;
    double leave = 1.0;
    for (const Face& f : b.faces) {
      const DVec3 normal = f.normal();
      const double from_height = glm::dot(normal, from - f.corners[0]);
      const double to_height = glm::dot(normal, to - f.corners[0]);
      if (from_height >= 0.0 && to_height >= 0.0) {
        leave = -1.0;
        break;
      }
      const double crossing = from_height / (from_height - to_height);
      if (from_height > 0.0)
        enter = std::max(enter, crossing);
      else if (to_height > 0.0)
        leave = std::min(leave, crossing);
    }
    if (enter + 1e-6 < leave) return true;
  }
  return false;
}

/// A piece of a face that sends light.
struct Patch {
  DVec3 center;
  DVec3 normal;
  double area;
  DVec3 reflectance;
  DVec3 radiosity;
};

/// Part of a patch's radiosity that arrives at a point: point-to-disc form factor, finite also where they touch.
double formFactor(const DVec3& point, const DVec3& normal, const Patch& patch, const std::vector<Block>& all) {
  const DVec3 way = patch.center - point;
  const double distance2 = glm::dot(way, way);
  const double here = glm::dot(normal, way);
  const double there = -glm::dot(patch.normal, way);
  if (here <= 1e-9 || there <= 1e-9) return 0.0;
  const double factor = here * there / distance2 * patch.area / (kPi * distance2 + patch.area);
  return isBlocked(all, point, patch.center) ? 0.0 : factor;
}

std::vector<Patch> cut(const Face& face, int per_side) {
  std::vector<Patch> patches;
  for (int j = 0; j < per_side; ++j)
    for (int i = 0; i < per_side; ++i)
      patches.push_back({face.at((i + 0.5) / per_side, (j + 0.5) / per_side), face.normal(),
                         face.area() / (per_side * per_side), face.reflectance, DVec3(face.emitted)});
  return patches;
}

/// The lamp's patches and those of all other faces, these with the light they reflect after some bounces.
std::vector<Patch> solve(const std::vector<Face>& faces, const std::vector<Block>& all) {
  std::vector<Patch> patches;
  for (const Face& f : faces) {
    const std::vector<Patch> more = cut(f, f.emitted > 0.0 ? kLampPatches : kPatches);
    patches.insert(patches.end(), more.begin(), more.end());
  }
  const std::size_t n = patches.size();
  std::vector<float> factors(n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      factors[i * n + j] = static_cast<float>(formFactor(patches[i].center, patches[i].normal, patches[j], all));
  std::vector<DVec3> emitted;
  for (const Patch& p : patches) emitted.push_back(p.radiosity);
  for (int bounce = 0; bounce < kBounces; ++bounce) {
    std::vector<DVec3> next = emitted;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        next[i] += patches[i].reflectance * patches[j].radiosity * static_cast<double>(factors[i * n + j]);
    for (std::size_t i = 0; i < n; ++i) patches[i].radiosity = next[i];
  }
  return patches;
}

/// What leaves a face at (kLattice + 1)^2 points, row by row.
std::vector<DVec3> lightOn(const Face& face, const std::vector<Patch>& patches, const std::vector<Block>& all) {
  std::vector<DVec3> light;
  const DVec3 normal = face.normal();
  for (int j = 0; j <= kLattice; ++j)
    for (int i = 0; i <= kLattice; ++i) {
      // A little away from edges and surface: there, walls and blocks meet.
      const double u = 0.002 + 0.996 * i / kLattice;
      const double v = 0.002 + 0.996 * j / kLattice;
      const DVec3 point = face.at(u, v) + 1e-4 * normal;
      DVec3 arriving(0.0);
      if (face.emitted == 0.0)
        for (const Patch& p : patches) arriving += p.radiosity * formFactor(point, normal, p, all);
      light.push_back(face.emitted > 0.0 ? DVec3(1.0) : face.reflectance * arriving);
    }
  return light;
}

mesh::Mesh litFace(const Face& face, const std::vector<DVec3>& light, int n) {
  mesh::Mesh m = gridSurface({n, n, false, false}, [&](double u, double v) {
    return SurfacePoint{face.at(u, v), face.normal()};
  });
  for (const Vec2& uv : m.texcoords) {
    const double x = static_cast<double>(uv.x) * kLattice;
    const double y = static_cast<double>(uv.y) * kLattice;
    const auto i = static_cast<std::size_t>(std::min(x, kLattice - 1.0));
    const auto j = static_cast<std::size_t>(std::min(y, kLattice - 1.0));
    const auto at = [&](std::size_t di, std::size_t dj) { return light[(j + dj) * (kLattice + 1) + i + di]; };
    const double fx = x - static_cast<double>(i);
    const double fy = y - static_cast<double>(j);
    const DVec3 color = glm::mix(glm::mix(at(0, 0), at(1, 0), fx), glm::mix(at(0, 1), at(1, 1), fx), fy);
    m.colors.emplace_back(Vec3(glm::min(color, DVec3(1.0))), 1.0F);
  }
  return m;
}

}  // namespace

Scene buildCornell(const BuiltinArguments& arguments) {
  const int n = arguments.whole("n");
  const std::vector<Block> all_blocks = blocks();
  std::vector<Face> room = walls();
  std::vector<Face> faces = room;
  for (const Block& b : all_blocks) faces.insert(faces.end(), b.faces.begin(), b.faces.end());
  const std::vector<Patch> patches = solve(faces, all_blocks);

  Scene scene;
  Material material;
  material.name = "lit paint";
  material.base_color = Vec4(1.0F);
  material.shading = Shading::kUnlit;
  scene.materials.push_back(material);
  const auto add = [&](const std::vector<Face>& part) {
    mesh::Mesh m;
    for (const Face& f : part) append(m, litFace(f, lightOn(f, patches, all_blocks), n));
    Instance instance;
    instance.mesh = static_cast<std::uint32_t>(scene.meshes.size());
    scene.meshes.push_back(std::move(m));
    scene.instances.push_back(instance);
  };
  add(room);
  for (const Block& b : all_blocks) add(b.faces);

  // Published: eye (278, 273, -800), focal length 35 and film 25 millimetres.
  Camera camera;
  camera.name = "measured";
  camera.eye = fromMeasured(278.0, 273.0, -800.0);
  camera.target = fromMeasured(278.0, 273.0, 0.0);
  camera.vertical_fov_rad = 2.0 * std::atan(12.5 / 35.0);
  scene.cameras.push_back(camera);
  scene.ambient = {Vec3(1.0F), Vec3(1.0F)};
  scene.background = Vec3(0.0F);
  return scene;
}

}  // namespace sheaf::scenes
