#include "grouping/cluster_queries.h"

#include <algorithm>
#include <cmath>

#include "grouping/dual_graph.h"
#include "mesh/triangle_queries.h"

namespace sheaf::grouping {
namespace {

using mesh::Corners;

// Clusters of so many faces are not looked into any further: testing the faces is cheaper.
constexpr std::uint32_t kFewFaces = 8;
// Of the size and distance of a box, far above round-off in double precision.
constexpr double kSlack = 1e-9;
// The bound of what is not met at all.
constexpr double kNever = std::numeric_limits<double>::infinity();
// The axes of a box are floats: a length along them may be longer than it is in space, by less than this.
constexpr double kAxesStretch = 1.001;

bool hasFewFaces(const FaceClusters& clusters, std::uint32_t node) {
  return clusters.faceCountOf(node) <= kFewFaces;
}

Corners cornersOf(const mesh::Mesh& mesh, std::uint32_t face) {
  const mesh::Triangle& t = mesh.triangles[face];
  return {DVec3(mesh.positions[t[0]]), DVec3(mesh.positions[t[1]]), DVec3(mesh.positions[t[2]])};
}

DVec3 alongAxes(const ClusterShape& shape, const DVec3& v) {
  return {glm::dot(v, DVec3(shape.frame.axis_s)), glm::dot(v, DVec3(shape.frame.axis_t)),
          glm::dot(v, DVec3(shape.frame.normal))};
}

double largestCoordinate(const ClusterShape& shape) {
  const DVec3 reach = glm::max(glm::abs(DVec3(shape.lo)), glm::abs(DVec3(shape.hi)));
  return std::max({reach.x, reach.y, reach.z});
}

// Least t of the ray within the box, or kNever. In the coordinates in which the box was measured, which are
// linear in those of space, so that the axes need be neither unit nor at right angles.
double entryOf(const ClusterShape& shape, const Ray& ray) {
  const DVec3 from_center = ray.origin - DVec3(shape.center);
  const DVec3 o = alongAxes(shape, from_center), d = alongAxes(shape, ray.direction);
  const double slack = kSlack * (largestCoordinate(shape) + glm::length(from_center));
  double enter = ray.t_min, leave = ray.t_max;
  for (int i = 0; i < 3; ++i) {
    const double lo = double{shape.lo[i]} - slack - o[i], hi = double{shape.hi[i]} + slack - o[i];
    if (d[i] == 0.0) {
      if (lo > 0.0 || hi < 0.0) return kNever;
      continue;
    }
    const double t0 = lo / d[i], t1 = hi / d[i];
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  return enter <= leave ? enter : kNever;
}

// No point of the box is nearer than this.
double leastDistance(const ClusterShape& shape, const DVec3& point) {
  const DVec3 p = alongAxes(shape, point - DVec3(shape.center));
  const DVec3 beyond = glm::max(glm::max(DVec3(shape.lo) - p, p - DVec3(shape.hi)), DVec3(0.0));
  return std::max(0.0, glm::length(beyond) / kAxesStretch - kSlack * (glm::length(p) + largestCoordinate(shape)));
}

// Visits the faces of all clusters for which bound(shape) is at most limit(), of two parts the nearer one first. A
// cluster without a stored shape is as near as the one it is part of.
template <typename Bound, typename Limit, typename VisitFace>
void searchNearFirst(const FaceClusters& clusters, const Bound& bound, const Limit& limit, const VisitFace& visitFace) {
  struct Open {
    std::uint32_t node;
    double bound;
  };
  const auto boundOf = [&](std::uint32_t node, double above) {
    const ClusterShape* shape = clusters.storedShape(node);
    return shape == nullptr ? above : std::max(above, bound(*shape));
  };
  std::vector<Open> open;
  for (const std::uint32_t root : clusters.roots) {
    open.push_back({root, boundOf(root, -kNever)});
    while (!open.empty()) {
      const Open next = open.back();
      open.pop_back();
      if (next.bound > limit() || next.bound == kNever) continue;
      if (hasFewFaces(clusters, next.node)) {
        for (const std::uint32_t face : clusters.facesOf(next.node)) visitFace(face);
        continue;
      }
      const auto [left, right] = clusters.childrenOf(next.node);
      Open near{left, boundOf(left, next.bound)}, far{right, boundOf(right, next.bound)};
      if (far.bound < near.bound) std::swap(near, far);
      open.push_back(far);
      open.push_back(near);
    }
  }
}

// A box in the space of a, as an interval around its middle on each of three axes.
struct PlacedBox {
  DVec3 middle{0.0};
  std::array<DVec3, 3> half{};  // axis times half the size, with room for axes that are not quite orthonormal
};

PlacedBox placed(const ClusterShape& shape, const DMat4& a_from_object) {
  const DMat3 turn(a_from_object);
  const std::array<DVec3, 3> axes = {turn * DVec3(shape.frame.axis_s), turn * DVec3(shape.frame.axis_t),
                                     turn * DVec3(shape.frame.normal)};
  const double room = (kAxesStretch - 1.0) * largestCoordinate(shape);
  PlacedBox box;
  box.middle = DVec3(a_from_object * DVec4(DVec3(shape.center), 1.0));
  for (int i = 0; i < 3; ++i) {
    const double lo = shape.lo[i], hi = shape.hi[i];
    box.middle += 0.5 * (lo + hi) * axes[i];
    box.half[i] = (0.5 * (hi - lo) + room) * axes[i];
  }
  return box;
}

bool separates(const DVec3& axis, const PlacedBox& a, const PlacedBox& b) {
  double reach = 0.0;
  for (int i = 0; i < 3; ++i) reach += std::abs(glm::dot(axis, a.half[i])) + std::abs(glm::dot(axis, b.half[i]));
  return std::abs(glm::dot(axis, b.middle - a.middle)) > reach;
}

// [E05] §4.4.1: the axes of both, and what is at right angles to one of each.
bool apart(const PlacedBox& a, const PlacedBox& b) {
  for (const PlacedBox* box : {&a, &b})
    for (int i = 0; i < 3; ++i) {
      const DVec3& u = box->half[(i + 1) % 3];
      const DVec3& v = box->half[(i + 2) % 3];
      if (separates(glm::cross(u, v), a, b)) return true;
    }
  for (const DVec3& u : a.half)
    for (const DVec3& v : b.half)
      if (separates(glm::cross(u, v), a, b)) return true;
  return false;
}

class OverlapSearch {
 public:
  OverlapSearch(const ClusteredMesh& a, const ClusteredMesh& b, const DMat4& a_from_b, std::size_t most)
      : a_(a), b_(b), a_from_b_(a_from_b), most_(most) {}

  std::vector<FacePair> run() {
    for (const std::uint32_t root_a : a_.clusters.roots)
      for (const std::uint32_t root_b : b_.clusters.roots) search(root_a, root_b);
    std::ranges::sort(found_);
    return std::move(found_);
  }

 private:
  void search(std::uint32_t root_a, std::uint32_t root_b) {
    open_.push_back({root_a, root_b});
    while (!open_.empty() && found_.size() < most_) {
      const auto [a, b] = open_.back();
      open_.pop_back();
      const ClusterShape* shape_a = a_.clusters.storedShape(a);
      const ClusterShape* shape_b = b_.clusters.storedShape(b);
      if (shape_a != nullptr && shape_b != nullptr && apart(placed(*shape_a, DMat4(1.0)), placed(*shape_b, a_from_b_)))
        continue;
      const bool few_a = hasFewFaces(a_.clusters, a), few_b = hasFewFaces(b_.clusters, b);
      if (few_a && few_b) {
        testFaces(a, b);
      } else if (few_b || (!few_a && a_.clusters.faceCountOf(a) >= b_.clusters.faceCountOf(b))) {
        for (const std::uint32_t part : a_.clusters.childrenOf(a)) open_.push_back({part, b});
      } else {
        for (const std::uint32_t part : b_.clusters.childrenOf(b)) open_.push_back({a, part});
      }
    }
    open_.clear();
  }

  void testFaces(std::uint32_t a, std::uint32_t b) {
    for (const std::uint32_t face_b : b_.clusters.facesOf(b)) {
      if (!hasFiniteCorners(b_.mesh, b_.mesh.triangles[face_b])) continue;
      Corners corners_b = cornersOf(b_.mesh, face_b);
      for (DVec3& p : corners_b) p = DVec3(a_from_b_ * DVec4(p, 1.0));
      for (const std::uint32_t face_a : a_.clusters.facesOf(a)) {
        if (found_.size() == most_) return;
        if (hasFiniteCorners(a_.mesh, a_.mesh.triangles[face_a]) &&
            mesh::overlap(cornersOf(a_.mesh, face_a), corners_b))
          found_.push_back({face_a, face_b});
      }
    }
  }

  const ClusteredMesh& a_;
  const ClusteredMesh& b_;
  const DMat4& a_from_b_;
  std::size_t most_;
  std::vector<FacePair> open_;  // of nodes
  std::vector<FacePair> found_;
};

}  // namespace

std::optional<RayHit> closestHit(const mesh::Mesh& mesh, const FaceClusters& clusters, const Ray& ray) {
  std::optional<RayHit> best;
  const auto limit = [&] { return best ? best->t : ray.t_max; };
  const auto bound = [&](const ClusterShape& shape) { return entryOf(shape, ray); };
  searchNearFirst(clusters, bound, limit, [&](std::uint32_t face) {
    if (!hasFiniteCorners(mesh, mesh.triangles[face])) return;
    const std::optional<double> t = mesh::meetLine(cornersOf(mesh, face), ray.origin, ray.direction);
    if (!t || *t < ray.t_min || *t > limit()) return;
    if (!best || *t < best->t || face < best->face) best = RayHit{face, *t};
  });
  return best;
}

std::optional<SurfacePoint> closestPoint(const mesh::Mesh& mesh, const FaceClusters& clusters, const DVec3& point,
                                         double max_distance) {
  std::optional<SurfacePoint> best;
  const auto limit = [&] { return best ? best->distance : max_distance; };
  const auto bound = [&](const ClusterShape& shape) { return leastDistance(shape, point); };
  searchNearFirst(clusters, bound, limit, [&](std::uint32_t face) {
    if (!hasFiniteCorners(mesh, mesh.triangles[face])) return;
    const DVec3 nearest = mesh::closestPoint(cornersOf(mesh, face), point);
    const double distance = glm::distance(nearest, point);
    if (!(distance <= limit())) return;
    if (!best || distance < best->distance || face < best->face) best = SurfacePoint{face, nearest, distance};
  });
  return best;
}

std::vector<FacePair> overlappingFaces(const ClusteredMesh& a, const ClusteredMesh& b, const DMat4& a_from_b,
                                       std::size_t most) {
  return OverlapSearch(a, b, a_from_b, most).run();
}

}  // namespace sheaf::grouping
