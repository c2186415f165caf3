#include "grouping/group_assembly.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "core/error.h"

namespace sheaf::grouping {
namespace {

// Drops seeds without members and renumbers the owners. Returns the member count of each seed that stays.
std::vector<std::uint32_t> dropEmptySeeds(Findings& findings) {
  std::vector<std::uint32_t> count(findings.seeds.size(), 0);
  for (const std::uint32_t o : findings.owner)
    if (o != kNoIndex) ++count[o];
  std::vector<std::uint32_t> renumbered(count.size());
  std::uint32_t kept = 0;
  for (std::uint32_t g = 0; g < count.size(); ++g) {
    renumbered[g] = kept;
    if (count[g] == 0) continue;
    findings.seeds[kept] = findings.seeds[g];
    count[kept++] = count[g];
  }
  findings.seeds.resize(kept);
  count.resize(kept);
  for (std::uint32_t& o : findings.owner)
    if (o != kNoIndex) o = renumbered[o];
  return count;
}

VertexGroup groupOf(const Findings::Seed& seed, std::span<const Vec3> positions, std::span<const PlaneFrame> planes) {
  VertexGroup g;
  g.kind = seed.end == kNoIndex ? GroupKind::kPlane : GroupKind::kLine;
  g.plane = seed.plane;
  g.origin = seed.origin;
  g.end = seed.end;
  g.base = positions[seed.origin];
  if (g.kind == GroupKind::kLine) {
    g.axis_s = positions[seed.end] - g.base;
    g.s_max = 1.0F;
  } else {
    g.axis_s = planes[seed.plane].axis_s;
    g.axis_t = planes[seed.plane].axis_t;
  }
  return g;
}

void extendRanges(VertexGroup& g, float s, float t) {
  g.s_min = std::min(g.s_min, s), g.s_max = std::max(g.s_max, s);
  g.t_min = std::min(g.t_min, t), g.t_max = std::max(g.t_max, t);
}

void markDefining(VertexGroups& out) {
  for (const VertexGroup& g : out.groups) {
    if (g.origin != kNoIndex) out.state[g.origin] = VertexState::kDefining;
    if (g.end != kNoIndex) out.state[g.end] = VertexState::kDefining;
  }
}

}  // namespace

std::vector<std::uint32_t> verticesInUse(std::span<const Vec3> positions, std::span<const mesh::Triangle> triangles) {
  std::vector<bool> used(positions.size(), triangles.empty());
  for (const mesh::Triangle& t : triangles)
    for (const std::uint32_t v : t) used[v] = true;
  std::vector<std::uint32_t> vertices;
  vertices.reserve(positions.size());
  for (std::uint32_t v = 0; v < positions.size(); ++v)
    if (used[v]) vertices.push_back(v);
  checkPositions(positions, vertices);
  return vertices;
}

void checkPositions(std::span<const Vec3> positions, std::span<const std::uint32_t> vertices) {
  for (const std::uint32_t v : vertices) {
    const Vec3 size = glm::abs(positions[v]);
    if (!(size.x <= kMaxCoordinate && size.y <= kMaxCoordinate && size.z <= kMaxCoordinate))
      throw Error(ErrorCode::kBadInput, fmt::format("vertex {}: position ({}, {}, {}) is not finite or beyond {}", v,
                                                    positions[v].x, positions[v].y, positions[v].z, kMaxCoordinate));
  }
}

double extentOf(std::span<const Vec3> positions, std::span<const std::uint32_t> vertices) {
  Box3 box;
  for (const std::uint32_t v : vertices) box.extend(positions[v]);
  if (box.empty()) return 0.0;
  const DVec3 size = DVec3(box.hi) - DVec3(box.lo);
  return std::max({size.x, size.y, size.z});
}

void chooseMetric(const mesh::Mesh& mesh, Metric metric, Limit limit, VertexGroups& out) {
  out.metric = metric;
  out.limit = limit;
  if (metric != Metric::kQuadric || !mesh.triangles.empty()) return;
  out.metric = Metric::kDistance;
  out.warnings.push_back("the quadric metric needs faces and there are none: grouped by distance instead");
}

float Placement::lineParameter(const VertexGroup& group, std::uint32_t vertex, const DVec3& from_base) const {
  const DVec3 along(group.axis_s);
  // A vertex that cannot reach anywhere is a member only if it lies on the line.
  const bool can_move = !ellipsoids_.empty() && ellipsoids_[vertex].determinant() > 0.0;
  const Sym3 a = can_move ? inverse(ellipsoids_[vertex]) : Sym3::scaledIdentity(1.0);
  const double t = placeOnLine(a, -from_base, along);
  return static_cast<float>(segment_only_ ? std::clamp(t, 0.0, 1.0) : t);
}

Placement::Parameters Placement::parametersOf(const VertexGroup& group, const PlaneFrame* frame, std::uint32_t vertex,
                                              const Vec3& position) const {
  const DVec3 from_base = DVec3(position) - DVec3(group.base);
  if (group.kind == GroupKind::kLine) return {lineParameter(group, vertex, from_base), 0.0F};
  DVec3 target = from_base;  // along the normal it makes no difference to s and t
  if (!ellipsoids_.empty()) {
    const DVec3 normal(frame->normal);
    const DVec3 reach = ellipsoids_[vertex].times(normal);
    // A vertex that cannot reach anywhere is a member only if it lies in the plane.
    if (glm::dot(normal, reach) > 0.0) target += placeOnPlane(normal, reach, -glm::dot(normal, from_base));
  }
  return {static_cast<float>(glm::dot(target, DVec3(group.axis_s))),
          static_cast<float>(glm::dot(target, DVec3(group.axis_t)))};
}

void assembleGroups(std::span<const Vec3> positions, std::span<const std::uint32_t> in_use, Findings findings,
                    const Placement& placement, VertexGroups& out) {
  const std::vector<std::uint32_t> count = dropEmptySeeds(findings);
  out.groups.clear();
  out.groups.reserve(findings.seeds.size());
  for (std::size_t g = 0; g < findings.seeds.size(); ++g) {
    out.groups.push_back(groupOf(findings.seeds[g], positions, out.planes));
    out.groups[g].member_count = count[g];
  }
  out.owner = std::move(findings.owner);
  listMembers(out);

  out.positions.assign(positions.begin(), positions.end());
  out.state.assign(positions.size(), VertexState::kUnused);
  for (const std::uint32_t v : in_use) out.state[v] = VertexState::kFree;
  markDefining(out);
  out.s.resize(out.members.size());
  out.t.resize(out.members.size());
  // By vertex and not by group: members of a group ascend, and positions and ellipsoids are read as they lie in memory.
  std::vector<std::uint32_t> next(out.groups.size());
  for (std::size_t g = 0; g < next.size(); ++g) next[g] = out.groups[g].first_member;
  for (const std::uint32_t v : in_use) {
    if (out.owner[v] == kNoIndex) continue;
    assert(out.state[v] == VertexState::kFree);
    VertexGroup& g = out.groups[out.owner[v]];
    const PlaneFrame* frame = g.kind == GroupKind::kPlane ? &out.planes[g.plane] : nullptr;
    const auto [s, t] = placement.parametersOf(g, frame, v, positions[v]);
    const std::uint32_t m = next[out.owner[v]]++;
    out.s[m] = s, out.t[m] = t;
    extendRanges(g, s, t);
    out.state[v] = VertexState::kGrouped;
    out.positions[v] = pointOn(g, s, t);
  }
}

void listMembers(VertexGroups& groups) {
  std::vector<std::uint32_t> next(groups.groups.size());
  std::uint32_t total = 0;
  for (std::size_t g = 0; g < groups.groups.size(); ++g) {
    groups.groups[g].first_member = next[g] = total;
    total += groups.groups[g].member_count;
  }
  groups.members.resize(total);
  for (std::uint32_t v = 0; v < groups.owner.size(); ++v)
    if (groups.owner[v] != kNoIndex) groups.members[next[groups.owner[v]]++] = v;
}

void dropUngrouped(VertexGroups& groups) {
  for (VertexState& state : groups.state)
    if (state == VertexState::kDefining) state = VertexState::kFree;
  std::uint32_t kept_groups = 0, kept_members = 0;
  for (std::uint32_t g = 0; g < groups.groups.size(); ++g) {
    VertexGroup group = groups.groups[g];
    const std::uint32_t begin = group.first_member, end = begin + group.member_count;
    group.first_member = kept_members;
    group.s_min = group.t_min = group.t_max = 0.0F;
    group.s_max = group.kind == GroupKind::kLine ? 1.0F : 0.0F;
    for (std::uint32_t m = begin; m < end; ++m) {
      const std::uint32_t v = groups.members[m];
      if (groups.owner[v] == kNoIndex) continue;
      groups.owner[v] = kept_groups;
      groups.members[kept_members] = v;
      groups.s[kept_members] = groups.s[m], groups.t[kept_members] = groups.t[m];
      extendRanges(group, groups.s[m], groups.t[m]);
      ++kept_members;
    }
    group.member_count = kept_members - group.first_member;
    if (group.member_count > 0) groups.groups[kept_groups++] = group;
  }
  groups.groups.resize(kept_groups);
  groups.members.resize(kept_members);
  groups.s.resize(kept_members);
  groups.t.resize(kept_members);
  markDefining(groups);
}

}  // namespace sheaf::grouping
