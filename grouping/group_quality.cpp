#include "grouping/group_quality.h"

#include "core/stage_timer.h"
#include "grouping/group_assembly.h"

namespace sheaf::grouping {
namespace {

DVec3 areaVector(std::span<const Vec3> positions, const mesh::Triangle& t) {
  const DVec3 a(positions[t[0]]);
  return glm::cross(DVec3(positions[t[1]]) - a, DVec3(positions[t[2]]) - a);
}

bool isMoved(const VertexGroups& groups, const mesh::Triangle& t) {
  for (const std::uint32_t v : t)
    if (groups.state[v] == VertexState::kGrouped) return true;
  return false;
}

void countStates(VertexGroups& groups) {
  GroupingStats& stats = groups.stats;
  stats.free = stats.defining = stats.grouped = 0;
  for (const VertexState state : groups.state) {
    stats.free += state == VertexState::kFree;
    stats.defining += state == VertexState::kDefining;
    stats.grouped += state == VertexState::kGrouped;
  }
  stats.vertices = stats.free + stats.defining + stats.grouped;
  stats.eliminated = stats.vertices == 0 ? 0.0 : double(stats.grouped) / stats.vertices;
}

void measureDisplacement(std::span<const Vec3> original, VertexGroups& groups) {
  double max2 = 0.0, sum = 0.0, sum2 = 0.0;
  for (const std::uint32_t v : groups.members) {
    const DVec3 d = DVec3(groups.positions[v]) - DVec3(original[v]);
    const double d2 = glm::dot(d, d);
    max2 = std::max(max2, d2);
    sum += std::sqrt(d2);
    sum2 += d2;
  }
  const double per_extent = groups.extent > 0.0 ? 1.0 / groups.extent : 0.0;
  const double n = std::max(1U, groups.stats.vertices);
  groups.stats.displacement_max = std::sqrt(max2) * per_extent;
  groups.stats.displacement_mean = sum / n * per_extent;
  groups.stats.displacement_rms = std::sqrt(sum2 / n) * per_extent;
}

void measureFaces(std::span<const Vec3> original, std::span<const mesh::Triangle> triangles, VertexGroups& groups) {
  GroupingStats& stats = groups.stats;
  stats.flipped_faces = stats.collapsed_faces = 0;
  double max = 0.0, sum2 = 0.0;
  std::size_t count = 0;
  for (const mesh::Triangle& t : triangles) {
    const DVec3 before = areaVector(original, t);
    if (before == DVec3(0.0)) continue;
    if (!isMoved(groups, t)) {
      ++count;
      continue;
    }
    const DVec3 after = areaVector(groups.positions, t);
    if (after == DVec3(0.0)) {
      ++stats.collapsed_faces;
      continue;
    }
    const double cosine = glm::dot(before, after);
    stats.flipped_faces += cosine < 0.0;
    const double angle = std::atan2(glm::length(glm::cross(before, after)), cosine);
    max = std::max(max, angle);
    sum2 += angle * angle;
    ++count;
  }
  stats.normal_deviation_max_rad = max;
  stats.normal_deviation_rms_rad = count == 0 ? 0.0 : std::sqrt(sum2 / double(count));
}

bool isTurnedOver(std::span<const Vec3> original, const VertexGroups& groups, const mesh::Triangle& t) {
  if (!isMoved(groups, t)) return false;
  const DVec3 before = areaVector(original, t);
  return before != DVec3(0.0) && !(glm::dot(before, areaVector(groups.positions, t)) > 0.0);
}

}  // namespace

void measure(std::span<const Vec3> original, std::span<const mesh::Triangle> triangles, VertexGroups& groups) {
  countStates(groups);
  measureDisplacement(original, groups);
  measureFaces(original, triangles, groups);
}

void restoreFlippedFaces(std::span<const Vec3> original, std::span<const mesh::Triangle> triangles,
                         VertexGroups& groups) {
  const std::uint32_t restored_before = groups.stats.restored_vertices;
  for (bool changed = true; changed;) {
    changed = false;
    for (const mesh::Triangle& t : triangles) {
      if (!isTurnedOver(original, groups, t)) continue;
      for (const std::uint32_t v : t) {
        if (groups.state[v] != VertexState::kGrouped) continue;
        groups.state[v] = VertexState::kFree;
        groups.owner[v] = kNoIndex;
        groups.positions[v] = original[v];
        ++groups.stats.restored_vertices;
        changed = true;
      }
    }
  }
  if (groups.stats.restored_vertices != restored_before) dropUngrouped(groups);
}

void finishGroups(const mesh::Mesh& mesh, bool restore_flipped, std::int64_t start_ns, VertexGroups& groups) {
  groups.stats.search_ms = 1e-6 * static_cast<double>(nowNs() - start_ns);
  measure(mesh.positions, mesh.triangles, groups);
  const bool safe = groups.metric == Metric::kQuadric && groups.limit == Limit::kSafe;
  if (!(restore_flipped || safe) || groups.stats.flipped_faces + groups.stats.collapsed_faces == 0) return;
  restoreFlippedFaces(mesh.positions, mesh.triangles, groups);
  measure(mesh.positions, mesh.triangles, groups);
}

}  // namespace sheaf::grouping
