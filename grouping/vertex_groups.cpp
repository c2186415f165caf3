#include "grouping/vertex_groups.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace sheaf::grouping {
namespace {

bool isVertex(const VertexGroups& groups, std::uint32_t v) {
  return v < groups.state.size();
}

std::string checkSizes(const VertexGroups& g) {
  if (g.owner.size() != g.state.size() || g.positions.size() != g.state.size())
    return fmt::format("{} states, {} owners and {} positions", g.state.size(), g.owner.size(), g.positions.size());
  if (g.s.size() != g.members.size() || g.t.size() != g.members.size())
    return fmt::format("{} members, {} s and {} t", g.members.size(), g.s.size(), g.t.size());
  if (g.dimensions != 2 && g.dimensions != 3) return fmt::format("{} dimensions", g.dimensions);
  if (!(g.epsilon >= 0.0 && g.extent >= 0.0 && std::isfinite(g.epsilon) && std::isfinite(g.extent)))
    return fmt::format("epsilon {} of an extent {}", g.epsilon, g.extent);
  return {};
}

std::string checkDefinition(const VertexGroups& groups, const VertexGroup& g) {
  if (g.kind != groups.kind) return "is of another kind than the rest";
  for (const std::uint32_t v : {g.origin, g.end}) {
    if (v == kNoIndex) continue;
    if (!isVertex(groups, v)) return fmt::format("is defined by vertex {} of {}", v, groups.state.size());
    if (groups.state[v] != VertexState::kDefining) return fmt::format("vertex {} is not marked as defining", v);
  }
  if (!isFinite(g.base) || !isFinite(g.axis_s) || !isFinite(g.axis_t)) return "has no finite frame";
  if (g.kind == GroupKind::kLine) return g.plane == kNoIndex && g.axis_t == Vec3(0.0F) ? "" : "is a line with a plane";
  if (g.end != kNoIndex) return "is a plane with two defining vertices";
  if (g.plane >= groups.planes.size()) return fmt::format("has plane {} of {}", g.plane, groups.planes.size());
  const PlaneFrame& frame = groups.planes[g.plane];
  return g.axis_s == frame.axis_s && g.axis_t == frame.axis_t ? "" : "has axes that are not its plane's";
}

std::string checkMembers(const VertexGroups& groups, std::uint32_t index) {
  const VertexGroup& g = groups.groups[index];
  const float s_end = g.kind == GroupKind::kLine ? 1.0F : 0.0F;
  if (!(g.s_min <= 0.0F && g.s_max >= s_end && g.t_min <= 0.0F && g.t_max >= 0.0F))
    return "has ranges that leave out its defining vertices";
  if (groups.segment_only && g.s_max > 1.0F) return "reaches beyond its segment";
  for (std::uint32_t m = g.first_member; m < g.first_member + g.member_count; ++m) {
    const std::uint32_t v = groups.members[m];
    if (!isVertex(groups, v)) return fmt::format("has member {} of {} vertices", v, groups.state.size());
    if (groups.owner[v] != index || groups.state[v] != VertexState::kGrouped)
      return fmt::format("has member {}, which is not marked as its own", v);
    if (m > g.first_member && groups.members[m - 1] >= v) return fmt::format("member {} is out of order", v);
    if (!(groups.s[m] >= g.s_min && groups.s[m] <= g.s_max && groups.t[m] >= g.t_min && groups.t[m] <= g.t_max))
      return fmt::format("member {} is outside the ranges", v);
    if (groups.positions[v] != pointOn(g, groups.s[m], groups.t[m]))
      return fmt::format("member {} is not where its parameters put it", v);
  }
  return {};
}

std::string checkGroups(const VertexGroups& groups) {
  std::uint64_t next_member = 0;
  for (std::uint32_t i = 0; i < groups.groups.size(); ++i) {
    const VertexGroup& g = groups.groups[i];
    if (g.first_member != next_member || g.member_count == 0 || next_member + g.member_count > groups.members.size())
      return fmt::format("group {}: members {}+{} of {}", i, g.first_member, g.member_count, groups.members.size());
    next_member += g.member_count;
    if (std::string reason = checkDefinition(groups, g); !reason.empty()) return fmt::format("group {}: {}", i, reason);
    if (std::string reason = checkMembers(groups, i); !reason.empty()) return fmt::format("group {}: {}", i, reason);
  }
  if (next_member != groups.members.size())
    return fmt::format("{} members, {} of them in groups", groups.members.size(), next_member);
  return {};
}

// Members were found grouped and owned, each by its own group; so equal counts leave no other owned or grouped vertex.
std::string checkStates(const VertexGroups& groups) {
  std::vector<bool> defines(groups.state.size(), false);
  for (const VertexGroup& g : groups.groups)
    for (const std::uint32_t v : {g.origin, g.end})
      if (v != kNoIndex) defines[v] = true;
  std::array<std::size_t, 4> count{};
  std::size_t owned = 0;
  for (std::size_t v = 0; v < groups.state.size(); ++v) {
    if (groups.state[v] > VertexState::kGrouped) return fmt::format("vertex {}: has no known state", v);
    if ((groups.state[v] == VertexState::kDefining) != defines[v])
      return fmt::format("vertex {}: is marked as defining but defines no group", v);
    ++count[static_cast<std::size_t>(groups.state[v])];
    owned += groups.owner[v] != kNoIndex;
  }
  const auto [unused, free, defining, grouped] = count;
  if (grouped != groups.members.size() || owned != grouped)
    return fmt::format("{} members, {} vertices grouped, {} owned", groups.members.size(), grouped, owned);
  const GroupingStats& stats = groups.stats;
  if (stats.free != free || stats.defining != defining || stats.grouped != grouped ||
      stats.vertices != free + defining + grouped)
    return "figures that are not those of its vertices";
  return {};
}

}  // namespace

mesh::Mesh snappedMesh(const mesh::Mesh& mesh, const VertexGroups& groups) {
  mesh::Mesh snapped = mesh;
  snapped.positions = groups.positions;
  return snapped;
}

std::string findInconsistency(const VertexGroups& groups) {
  if (std::string reason = checkSizes(groups); !reason.empty()) return reason;
  if (std::string reason = checkGroups(groups); !reason.empty()) return reason;
  return checkStates(groups);
}

}  // namespace sheaf::grouping
