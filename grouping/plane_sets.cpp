#include "grouping/plane_sets.h"

#include <fmt/format.h>

#include "core/error.h"

namespace sheaf::grouping {
namespace {

// axis_s is the coordinate axis after the one that the normal is most along, made orthogonal to the normal: at least 45
// degrees lie between the two. For x, y and z themselves this gives (y, z), (z, x) and (x, y).
PlaneFrame frameOf(const DVec3& normal) {
  int most = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(normal[k]) > std::abs(normal[most])) most = k;
  DVec3 next(0.0);
  next[(most + 1) % 3] = 1.0;
  const DVec3 axis_s = glm::normalize(next - glm::dot(next, normal) * normal);
  return {Vec3(normal), Vec3(axis_s), Vec3(glm::cross(normal, axis_s))};
}

}  // namespace

std::vector<PlaneFrame> axisPlanes() {
  return planesFromNormals(std::vector<DVec3>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
}

std::vector<PlaneFrame> dodecahedronPlanes() {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  return planesFromNormals(std::vector<DVec3>{{0, 1, g}, {0, 1, -g}, {1, g, 0}, {1, -g, 0}, {g, 0, 1}, {g, 0, -1}});
}

std::vector<PlaneFrame> axisAndDodecahedronPlanes() {
  std::vector<PlaneFrame> planes = axisPlanes();
  for (const PlaneFrame& frame : dodecahedronPlanes()) planes.push_back(frame);
  return planes;
}

std::vector<PlaneFrame> planesFromNormals(std::span<const DVec3> normals) {
  if (normals.empty()) throw Error(ErrorCode::kBadInput, "plane set: has no planes");
  std::vector<PlaneFrame> planes;
  for (const DVec3& n : normals) {
    const double length = glm::length(n);
    if (!(length > 1e-150 && length < 1e150))
      throw Error(ErrorCode::kBadInput,
                  fmt::format("plane set: normal {} ({}, {}, {}) has no direction", planes.size() + 1, n.x, n.y, n.z));
    planes.push_back(frameOf(n / length));
  }
  return planes;
}

}  // namespace sheaf::grouping
