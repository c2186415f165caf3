#include "grouping/direction_groups.h"

#include <array>
#include <bit>
#include <cassert>
#include <unordered_map>

namespace sheaf::grouping {
namespace {

struct HashOfBits {
  std::size_t operator()(const std::array<std::uint32_t, 3>& bits) const {
    std::uint64_t h = 0;
    for (const std::uint32_t b : bits) h = (h ^ b) * 0x9E3779B97F4A7C15ULL, h ^= h >> 29U;
    return static_cast<std::size_t>(h);
  }
};

}  // namespace

DirectionGroups groupDirections(std::span<const Vec3> normals, const PlanarOptions& options) {
  assert(options.metric == Metric::kDistance);
  DirectionGroups result;
  std::unordered_map<std::array<std::uint32_t, 3>, std::uint32_t, HashOfBits> known;
  for (const Vec3& n : normals) {
    const Vec3 unsigned_zero = n + Vec3(0.0F);  // -0 and 0 are one direction
    const auto key =
        std::bit_cast<std::array<std::uint32_t, 3>>(std::array{unsigned_zero.x, unsigned_zero.y, unsigned_zero.z});
    const auto [entry, is_new] = known.try_emplace(key, static_cast<std::uint32_t>(result.directions.size()));
    if (is_new) result.directions.push_back(unsigned_zero);
    result.direction.push_back(entry->second);
  }
  mesh::Mesh sphere;
  sphere.positions = result.directions;
  PlanarOptions of_sphere = options;
  of_sphere.extent = 2.0;
  result.groups = groupPlanar(sphere, of_sphere);
  for (const std::uint32_t v : result.groups.members) {
    const DVec3 before(result.directions[v]), after(result.groups.positions[v]);
    const double angle = std::atan2(glm::length(glm::cross(before, after)), glm::dot(before, after));
    result.angle_max_rad = std::max(result.angle_max_rad, angle);
  }
  return result;
}

}  // namespace sheaf::grouping
