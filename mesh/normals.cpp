// [TW98] Thuermer and Wuethrich, Computing vertex normals from polygonal facets, JGT 3(1), 1998.
// [AS64] Abramowitz and Stegun, Handbook of Mathematical Functions, 1964.
#include "mesh/normals.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <span>

namespace sheaf::mesh {
namespace {

constexpr Vec3 kAnyNormal{0.0F, 1.0F, 0.0F};
// Cosines of dihedral angles may be off by this much and still count as equal, so that flat regions do not crack.
constexpr double kCosSlack = 1e-9;

struct Face {
  DVec3 edge[3];     // from corner k to corner k + 1
  DVec3 normal;      // unit, if usable
  double square[3];  // squared lengths of the edges
  bool usable;
};

// Differences of floats are nearly exact in double, so the normal is good down to very thin triangles.
Face faceOf(const Mesh& mesh, const Triangle& t) {
  const DVec3 p0(mesh.positions[t[0]]), p1(mesh.positions[t[1]]), p2(mesh.positions[t[2]]);
  Face f;
  f.edge[0] = p1 - p0;
  f.edge[1] = p2 - p1;
  f.edge[2] = p0 - p2;
  for (int k = 0; k < 3; ++k) f.square[k] = glm::dot(f.edge[k], f.edge[k]);
  const DVec3 cross = glm::cross(f.edge[0], f.edge[1]);
  const double square = glm::dot(cross, cross);
  // Below a sine of 1e-12 the direction would be rounding noise. False for NaN and infinity, too.
  f.usable = square > 1e-24 * f.square[0] * f.square[1] && square <= std::numeric_limits<double>::max();
  f.normal = f.usable ? cross * (1.0 / std::sqrt(square)) : DVec3(0.0);
  return f;
}

// [AS64] 4.4.46, to 2e-8, by additions, multiplications and square roots only: the same bits on every machine, which
// std::acos does not promise.
double angleOfCosine(double c) {
  const double x = std::min(std::abs(c), 1.0);
  double p = -0.0012624911;
  for (const double a :
       {0.0066700901, -0.0170881256, 0.0308918810, -0.0501743046, 0.0889789874, -0.2145988016, 1.5707963050})
    p = p * x + a;
  const double angle = std::sqrt(1.0 - x) * p;
  return c < 0.0 ? kPi - angle : angle;
}

std::array<double, 3> cornerAngles(const Face& f) {
  const auto angle = [&](int before, int after) {
    const double scale = std::sqrt(f.square[before] * f.square[after]);
    return angleOfCosine(-glm::dot(f.edge[before], f.edge[after]) / scale);
  };
  const double a0 = angle(2, 0), a1 = angle(0, 1);
  return {a0, a1, std::max(0.0, kPi - a0 - a1)};
}

Vec3 unitOrAny(const DVec3& sum) {
  const double square = glm::dot(sum, sum);
  // Normals of triangles that face each other cancel but for rounding.
  return square > 1e-12 ? Vec3(sum / std::sqrt(square)) : kAnyNormal;
}

void smoothEverything(Mesh& mesh) {
  mesh.normals.assign(mesh.vertexCount(), Vec3(0.0F));
  for (const Triangle& t : mesh.triangles) {
    const Face f = faceOf(mesh, t);
    if (!f.usable) continue;
    const std::array<double, 3> angles = cornerAngles(f);
    for (std::size_t k = 0; k < 3; ++k) mesh.normals[t[k]] += Vec3(f.normal * angles[k]);
  }
  for (Vec3& n : mesh.normals) n = unitOrAny(DVec3(n));
}

constexpr std::uint32_t kSmooth = 0xFFFFFFFFU;

// Number of each vertex that may have a crease, dense from 0; kSmooth for the others. If all normals around a vertex
// are within half the crease angle of one direction, no two of them are further apart than the crease angle.
std::uint32_t numberSuspects(const Mesh& mesh, double crease_angle_rad, std::vector<std::uint32_t>& suspect_of) {
  const double least_cos = std::cos(0.5 * crease_angle_rad) + 1e-6;
  suspect_of.assign(mesh.vertexCount(), kSmooth);
  for (const Triangle& t : mesh.triangles) {
    const Face f = faceOf(mesh, t);
    if (!f.usable) continue;
    for (const std::uint32_t v : t)
      if (glm::dot(f.normal, DVec3(mesh.normals[v])) < least_cos) suspect_of[v] = 0;
  }
  std::uint32_t count = 0;
  for (std::uint32_t& s : suspect_of)
    if (s != kSmooth) s = count++;
  return count;
}

// Corners (3 f + k) of each suspect, by ascending triangle.
struct SuspectCorners {
  std::vector<std::uint32_t> first;  // #suspects + 1
  std::vector<std::uint32_t> corner;
};

SuspectCorners collectCorners(const Mesh& mesh, const std::vector<std::uint32_t>& suspect_of, std::uint32_t count) {
  SuspectCorners out;
  out.first.assign(std::size_t{count} + 1, 0);
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t)
      if (suspect_of[v] != kSmooth) ++out.first[suspect_of[v]];
  std::exclusive_scan(out.first.begin(), out.first.end(), out.first.begin(), 0U);
  out.corner.resize(out.first.back());
  for (std::size_t f = 0; f < mesh.triangleCount(); ++f)
    for (std::size_t k = 0; k < 3; ++k)
      if (const std::uint32_t s = suspect_of[mesh.triangles[f][k]]; s != kSmooth)
        out.corner[out.first[s]++] = static_cast<std::uint32_t>(3 * f + k);
  // Filling moved each start to its end, which is the next one's start.
  std::copy_backward(out.first.begin(), out.first.end() - 1, out.first.end());
  out.first[0] = 0;
  return out;
}

// Splits the fan of one vertex at its creases. Scratch memory is kept between calls.
class FanSplitter {
 public:
  FanSplitter(Mesh& mesh, double crease_angle_rad) : mesh_(mesh), least_cos_(std::cos(crease_angle_rad) - kCosSlack) {}

  // corners  of one vertex, by ascending triangle; those that leave the vertex get a new one
  void split(std::span<const std::uint32_t> corners) {
    measureFaces(corners);
    joinOverEdges(corners);
    assignVertices(corners);
  }

 private:
  struct Spoke {
    std::uint32_t end;  // the edge's other vertex
    std::uint32_t face;
    auto operator<=>(const Spoke&) const = default;
  };

  void measureFaces(std::span<const std::uint32_t> corners) {
    const std::size_t n = corners.size();
    normal_.resize(n);
    angle_.resize(n);
    part_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Face f = faceOf(mesh_, mesh_.triangles[corners[i] / 3]);
      normal_[i] = f.normal;
      angle_[i] = f.usable ? cornerAngles(f)[corners[i] % 3] : 0.0;
      part_[i] = static_cast<std::uint32_t>(i);
    }
  }

  std::uint32_t rootOf(std::uint32_t i) {
    while (part_[i] != i) i = part_[i] = part_[part_[i]];
    return i;
  }

  void joinOverEdges(std::span<const std::uint32_t> corners) {
    spokes_.clear();
    for (std::uint32_t i = 0; i < corners.size(); ++i) {
      if (normal_[i] == DVec3(0.0)) continue;  // without area: must not bridge a crease
      const Triangle& t = mesh_.triangles[corners[i] / 3];
      const std::uint32_t k = corners[i] % 3;
      spokes_.push_back({t[(k + 1) % 3], i});
      spokes_.push_back({t[(k + 2) % 3], i});
    }
    std::sort(spokes_.begin(), spokes_.end());
    for (std::size_t s = 1; s < spokes_.size(); ++s) {
      if (spokes_[s - 1].end != spokes_[s].end) continue;
      const std::uint32_t a = spokes_[s - 1].face, b = spokes_[s].face;
      if (glm::dot(normal_[a], normal_[b]) < least_cos_) continue;
      const std::uint32_t root_a = rootOf(a), root_b = rootOf(b);
      part_[std::max(root_a, root_b)] = std::min(root_a, root_b);
    }
  }

  void assignVertices(std::span<const std::uint32_t> corners) {
    const std::uint32_t centre = mesh_.triangles[corners[0] / 3][corners[0] % 3];
    vertex_of_.assign(corners.size(), kSmooth);
    sum_.assign(corners.size(), DVec3(0.0));
    for (std::uint32_t i = 0; i < corners.size(); ++i) sum_[rootOf(i)] += normal_[i] * angle_[i];
    bool centre_taken = false;
    for (std::uint32_t i = 0; i < corners.size(); ++i) {
      std::uint32_t v = centre;  // triangles without area stay: what they show does not matter
      if (normal_[i] != DVec3(0.0)) {
        std::uint32_t& part_vertex = vertex_of_[rootOf(i)];
        if (part_vertex == kSmooth) {
          part_vertex = centre_taken ? appendCopy(centre) : centre;
          mesh_.normals[part_vertex] = unitOrAny(sum_[rootOf(i)]);
          centre_taken = true;
        }
        v = part_vertex;
      }
      mesh_.triangles[corners[i] / 3][corners[i] % 3] = v;
    }
  }

  std::uint32_t appendCopy(std::uint32_t v) {
    const auto copy = [v](auto& values) {
      if (!values.empty()) values.push_back(values[v]);
    };
    copy(mesh_.positions);
    copy(mesh_.normals);
    copy(mesh_.texcoords);
    copy(mesh_.colors);
    return static_cast<std::uint32_t>(mesh_.vertexCount() - 1);
  }

  Mesh& mesh_;
  double least_cos_;
  std::vector<DVec3> normal_;
  std::vector<double> angle_;
  std::vector<std::uint32_t> part_;  // union-find, roots are the lowest
  std::vector<Spoke> spokes_;
  std::vector<DVec3> sum_;
  std::vector<std::uint32_t> vertex_of_;
};

template <typename T>
void unshare(std::vector<T>& values, const std::vector<Triangle>& triangles) {
  if (values.empty()) return;
  std::vector<T> corners;
  corners.reserve(3 * triangles.size());
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t) corners.push_back(values[v]);
  values = std::move(corners);
}

}  // namespace

void makeSmoothNormals(Mesh& mesh, double crease_angle_rad) {
  assertValid(mesh);
  smoothEverything(mesh);
  if (crease_angle_rad >= kPi) return;
  std::vector<std::uint32_t> suspect_of;
  const std::uint32_t suspects = numberSuspects(mesh, std::max(crease_angle_rad, 0.0), suspect_of);
  if (suspects == 0) return;
  const SuspectCorners around = collectCorners(mesh, suspect_of, suspects);
  std::vector<std::uint32_t>().swap(suspect_of);
  FanSplitter splitter(mesh, std::max(crease_angle_rad, 0.0));
  for (std::uint32_t s = 0; s < suspects; ++s)
    splitter.split(std::span(around.corner).subspan(around.first[s], around.first[s + 1] - around.first[s]));
}

void makeFlatNormals(Mesh& mesh) {
  assertValid(mesh);
  unshare(mesh.positions, mesh.triangles);
  unshare(mesh.texcoords, mesh.triangles);
  unshare(mesh.colors, mesh.triangles);
  if (mesh.triangles.empty()) mesh.positions.clear();
  mesh.normals.clear();
  mesh.normals.reserve(mesh.vertexCount());
  std::uint32_t corner = 0;
  for (Triangle& t : mesh.triangles) {
    for (std::uint32_t& v : t) v = corner++;
    const Face f = faceOf(mesh, t);
    mesh.normals.insert(mesh.normals.end(), 3, f.usable ? Vec3(f.normal) : kAnyNormal);
  }
}

}  // namespace sheaf::mesh
