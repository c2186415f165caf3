#include "grouping/carried_groups.h"

#include <algorithm>
#include <cassert>
#include <tuple>
#include <utility>
#include <vector>

#include "grouping/group_assembly.h"
#include "mesh/weld.h"

namespace sheaf::grouping {
namespace {

/// A vertex that is to be a member, and where its parameters stand.
struct Carried {
  std::uint32_t patch = 0;  ///< groups are split by patch
  std::uint32_t group = 0;  ///< before
  std::uint32_t vertex = 0;
  std::uint32_t member = 0;  ///< into the members before
};

bool isBefore(const Carried& a, const Carried& b) {
  return std::tie(a.patch, a.group, a.vertex) < std::tie(b.patch, b.group, b.vertex);
}

void copySettings(const VertexGroups& from, VertexGroups& to) {
  to.planes = from.planes;
  to.kind = from.kind;
  to.metric = from.metric;
  to.limit = from.limit;
  to.dimensions = from.dimensions;
  to.segment_only = from.segment_only;
  to.interrupted = from.interrupted;
  to.epsilon = from.epsilon;
  to.extent = from.extent;
  to.stats.search_ms = from.stats.search_ms;
}

/// Makes groups of the members. `to` has states and positions. groupOf(member) is the group that begins with it.
template <typename GroupOf>
void gather(const VertexGroups& from, std::vector<Carried> members, const GroupOf& groupOf, VertexGroups& to) {
  std::ranges::sort(members, isBefore);
  const Carried* last = nullptr;
  for (const Carried& c : members) {
    if (last == nullptr || last->group != c.group || last->patch != c.patch) {
      VertexGroup& group = to.groups.emplace_back(groupOf(c));
      group.first_member = static_cast<std::uint32_t>(to.members.size());
      group.member_count = 0;
    }
    last = &c;
    ++to.groups.back().member_count;
    to.members.push_back(c.vertex);
    to.s.push_back(from.s[c.member]);
    to.t.push_back(from.t[c.member]);
    to.state[c.vertex] = VertexState::kGrouped;
    to.owner[c.vertex] = static_cast<std::uint32_t>(to.groups.size() - 1);
  }
  dropUngrouped(to);  // narrows the ranges to the members that are here and marks who defines
}

/// #V, where a grouped vertex stands among the members.
std::vector<std::uint32_t> memberOfVertex(const VertexGroups& groups) {
  std::vector<std::uint32_t> member(groups.state.size(), kNoIndex);
  for (std::uint32_t m = 0; m < groups.members.size(); ++m) member[groups.members[m]] = m;
  return member;
}

/// Who is at a place: the patch and the group, while there is only one of either.
struct Tenant {
  std::uint32_t patch = kNoIndex;
  std::uint32_t group = kNoIndex;
  bool is_known = false;
  bool is_alone = true;
};

/// #V, whether all vertices at the place of this one are in one patch and one group.
std::vector<bool> aloneAtPlace(const VertexGroups& groups, const PatchSet& set) {
  const std::vector<std::uint32_t> place = mesh::firstAtSamePlace(groups.positions);
  std::vector<Tenant> tenants(place.size());
  for (std::uint32_t p = 0; p < set.patches.size(); ++p)
    for (const std::uint32_t v : set.verticesOf(set.patches[p])) {
      Tenant& tenant = tenants[place[v]];
      if (!tenant.is_known)
        tenant = {p, groups.owner[v], true, true};
      else if (tenant.patch != p || tenant.group != groups.owner[v])
        tenant.is_alone = false;
    }
  std::vector<bool> alone(place.size());
  for (std::size_t v = 0; v < place.size(); ++v) alone[v] = tenants[place[v]].is_alone;
  return alone;
}

/// The direction that most of the members go across, of equally many the first. members  one or more
std::uint32_t commonPlane(const VertexGroups& groups, std::span<const Carried> members) {
  std::vector<std::uint32_t> planes;
  for (const Carried& c : members) planes.push_back(groups.groups[c.group].plane);
  std::ranges::sort(planes);
  std::uint32_t common = kNoIndex;
  std::size_t most = 0;
  for (std::size_t begin = 0, end = 0; begin < planes.size(); begin = end) {
    while (end < planes.size() && planes[end] == planes[begin]) ++end;
    if (end - begin > most) most = end - begin, common = planes[begin];
  }
  return common;
}

}  // namespace

GroupCarrier::GroupCarrier(const VertexGroups& groups)
    : groups_(groups), member_(memberOfVertex(groups)), copy_(groups.state.size(), kNoIndex) {}

VertexGroups GroupCarrier::carry(const mesh::Mesh& mesh, std::span<const std::uint32_t> source) {
  assert(source.size() == mesh.vertexCount());
  VertexGroups out;
  copySettings(groups_, out);
  out.positions = mesh.positions;
  out.state.assign(source.size(), VertexState::kUnused);
  out.owner.assign(source.size(), kNoIndex);
  std::vector<Carried> members;
  for (std::uint32_t v = 0; v < source.size(); ++v) {
    const std::uint32_t from = source[v];
    if (from == kNoIndex) continue;
    out.positions[v] = groups_.positions[from];
    out.state[v] = VertexState::kFree;
    if (copy_[from] == kNoIndex) copy_[from] = v;
    if (member_[from] != kNoIndex) members.push_back({0, groups_.owner[from], v, member_[from]});
  }
  const auto copyOf = [&](std::uint32_t v) { return v == kNoIndex ? kNoIndex : copy_[v]; };
  const auto groupOf = [&](const Carried& c) {
    VertexGroup group = groups_.groups[c.group];
    group.origin = copyOf(group.origin);
    group.end = copyOf(group.end);
    return group;
  };
  gather(groups_, std::move(members), groupOf, out);
  for (const std::uint32_t from : source)
    if (from != kNoIndex) copy_[from] = kNoIndex;
  return out;
}

VertexGroups framedByPatch(const VertexGroups& groups, const PatchSet& patches) {
  assert(groups.kind == GroupKind::kPlane);
  VertexGroups out;
  copySettings(groups, out);
  out.positions = groups.positions;
  out.state = groups.state;
  out.owner.assign(groups.state.size(), kNoIndex);
  for (VertexState& state : out.state)
    if (state != VertexState::kUnused) state = VertexState::kFree;
  out.planes.assign(patches.patches.size(), PlaneFrame{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}});
  const std::vector<std::uint32_t> member = memberOfVertex(groups);
  const std::vector<bool> alone = aloneAtPlace(groups, patches);
  std::vector<Carried> members, inside;
  for (std::uint32_t p = 0; p < patches.patches.size(); ++p) {
    inside.clear();
    for (const std::uint32_t v : patches.verticesOf(patches.patches[p]))
      if (member[v] != kNoIndex && alone[v]) inside.push_back({p, groups.owner[v], v, member[v]});
    if (inside.empty()) continue;
    const std::uint32_t plane = commonPlane(groups, inside);
    out.planes[p] = groups.planes[plane];
    std::erase_if(inside, [&](const Carried& c) { return groups.groups[c.group].plane != plane; });
    members.insert(members.end(), inside.begin(), inside.end());
  }
  const auto groupOf = [&](const Carried& c) {
    VertexGroup group = groups.groups[c.group];
    group.plane = c.patch;
    group.origin = kNoIndex;
    return group;
  };
  gather(groups, std::move(members), groupOf, out);
  return out;
}

}  // namespace sheaf::grouping
