#include "grouping/update_groups.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "core/stage_timer.h"
#include "grouping/group_assembly.h"
#include "grouping/group_quality.h"
#include "grouping/line_test.h"
#include "grouping/quadric.h"
#include "grouping/slabs.h"

namespace sheaf::grouping {
namespace {

// Moved vertices that are in use; by the quadric metric also those around them, whose ellipsoids have changed.
std::vector<std::uint32_t> verticesToCheck(const mesh::Mesh& mesh, std::span<const std::uint32_t> moved,
                                           const VertexGroups& groups) {
  std::vector<bool> is_moved(mesh.vertexCount(), false);
  for (const std::uint32_t v : moved) is_moved[v] = true;
  std::vector<bool> check = is_moved;
  if (groups.metric == Metric::kQuadric)
    for (const mesh::Triangle& t : mesh.triangles)
      if (is_moved[t[0]] || is_moved[t[1]] || is_moved[t[2]])
        for (const std::uint32_t v : t) check[v] = check[v] || groups.state[v] == VertexState::kGrouped;
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < mesh.vertexCount(); ++v)
    if (check[v] && groups.state[v] != VertexState::kUnused) vertices.push_back(v);
  return vertices;
}

// Finds groups for vertices. Vertices are numbered as in `vertices`.
class Fitter {
 public:
  Fitter(const mesh::Mesh& mesh, std::span<const std::uint32_t> vertices, const VertexGroups& groups, double eps,
         std::span<const Sym3> ellipsoids)
      : groups_(groups), by_plane_(groups.planes.size()) {
    if (groups.kind == GroupKind::kLine) {
      lines_.emplace_back(mesh.positions, vertices, eps, ellipsoids, groups.segment_only);
      return;
    }
    slabs_ = makeSlabs(mesh.positions, vertices, groups.planes, eps, ellipsoids);
    for (std::uint32_t g = 0; g < groups.groups.size(); ++g)
      by_plane_[groups.groups[g].plane].emplace_back(placeOf(groups.groups[g]), g);
    for (auto& planes : by_plane_) std::sort(planes.begin(), planes.end());
  }

  bool fits(std::uint32_t i, std::uint32_t group) const {
    const VertexGroup& g = groups_.groups[group];
    if (g.kind == GroupKind::kPlane) return slabs_.isCut(i, g.plane, placeOf(g));
    return lines_[0].takes(i, lines_[0].position(i) - DVec3(g.base), DVec3(g.axis_s));
  }

  // The nearest group within reach, ties to the earlier, or kNoIndex.
  std::uint32_t nearest(std::uint32_t i) const {
    return groups_.kind == GroupKind::kPlane ? nearestPlane(i) : firstLine(i);
  }

 private:
  static float placeOnNormal(const Vec3& normal, const Vec3& base) {
    return static_cast<float>(glm::dot(DVec3(normal), DVec3(base)));
  }
  float placeOf(const VertexGroup& g) const { return placeOnNormal(groups_.planes[g.plane].normal, g.base); }

  std::uint32_t nearestPlane(std::uint32_t i) const {
    std::uint32_t best = kNoIndex;
    float least = std::numeric_limits<float>::infinity();
    for (std::uint32_t axis = 0; axis < by_plane_.size(); ++axis) {
      const auto& planes = by_plane_[axis];
      const auto above = std::lower_bound(planes.begin(), planes.end(), std::pair(slabs_.xOf(i, axis), 0U));
      for (auto at = above == planes.begin() ? above : above - 1; at != planes.end() && at <= above; ++at) {
        if (!slabs_.isCut(i, axis, at->first)) continue;
        float share = std::abs(slabs_.xOf(i, axis) - at->first);
        if (share > 0.0F) share /= slabs_.halfOf(i, axis);
        if (share < least || (share == least && at->second < best)) least = share, best = at->second;
      }
    }
    return best;
  }

  std::uint32_t firstLine(std::uint32_t i) const {
    for (std::uint32_t g = 0; g < groups_.groups.size(); ++g)
      if (fits(i, g)) return g;
    return kNoIndex;
  }

  const VertexGroups& groups_;
  Slabs slabs_;
  std::vector<std::vector<std::pair<float, std::uint32_t>>> by_plane_;  // place along the normal, group
  std::vector<LineTest> lines_;                                         // one, if the groups are lines
};

// Takes moved vertices out of the definitions of groups. Returns how many defined some group.
std::uint32_t releaseDefining(const mesh::Mesh& mesh, std::span<const std::uint32_t> vertices, VertexGroups& groups) {
  std::uint32_t released = 0;
  for (const std::uint32_t v : vertices) {
    if (groups.state[v] != VertexState::kDefining || mesh.positions[v] == groups.positions[v]) continue;
    groups.state[v] = VertexState::kFree;
    ++released;
  }
  if (released == 0) return 0;
  for (VertexGroup& g : groups.groups) {
    if (g.origin != kNoIndex && groups.state[g.origin] == VertexState::kFree) g.origin = kNoIndex;
    if (g.end != kNoIndex && groups.state[g.end] == VertexState::kFree) g.end = kNoIndex;
  }
  return released;
}

// The parameters of members by vertex, so that members can change groups.
std::vector<Placement::Parameters> parametersByVertex(const VertexGroups& groups) {
  std::vector<Placement::Parameters> parameters(groups.state.size());
  for (std::size_t m = 0; m < groups.members.size(); ++m) parameters[groups.members[m]] = {groups.s[m], groups.t[m]};
  return parameters;
}

// Makes the lists of members anew from states and owners.
void relistMembers(std::span<const Placement::Parameters> parameters, VertexGroups& groups) {
  for (VertexGroup& g : groups.groups) g.member_count = 0;
  for (const std::uint32_t o : groups.owner)
    if (o != kNoIndex) ++groups.groups[o].member_count;
  listMembers(groups);
  groups.s.resize(groups.members.size());
  groups.t.resize(groups.members.size());
  for (std::size_t m = 0; m < groups.members.size(); ++m) {
    groups.s[m] = parameters[groups.members[m]].s;
    groups.t[m] = parameters[groups.members[m]].t;
  }
  dropUngrouped(groups);
}

std::uint32_t countKeptBases(const VertexGroups& groups) {
  // The planes through one vertex share one base; they stand one after another.
  std::uint32_t count = 0;
  const VertexGroup* last = nullptr;
  for (const VertexGroup& g : groups.groups) {
    const bool same_base = last != nullptr && last->origin == kNoIndex && last->base == g.base;
    if (g.origin == kNoIndex && !same_base) ++count;
    if (g.kind == GroupKind::kLine && g.end == kNoIndex) ++count;
    last = &g;
  }
  return count;
}

}  // namespace

UpdateReport updateGroups(const mesh::Mesh& mesh, std::span<const std::uint32_t> moved, VertexGroups& groups) {
  assert(mesh.vertexCount() == groups.state.size());
  const std::int64_t start_ns = nowNs();
  const std::vector<std::uint32_t> vertices = verticesToCheck(mesh, moved, groups);
  checkPositions(mesh.positions, vertices);

  UpdateReport report;
  report.released = releaseDefining(mesh, vertices, groups);
  const double eps = groups.epsilon * groups.extent;
  const bool quadric = groups.metric == Metric::kQuadric;
  const std::vector<Sym3> ellipsoids = quadric ? vertexEllipsoids(mesh, eps, groups.limit) : std::vector<Sym3>{};
  const Fitter fitter(mesh, vertices, groups, eps, ellipsoids);
  const Placement placement(ellipsoids, groups.segment_only);
  std::vector<Placement::Parameters> parameters = parametersByVertex(groups);

  for (const std::uint32_t v : moved) groups.positions[v] = mesh.positions[v];
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    const std::uint32_t v = vertices[i];
    if (groups.state[v] == VertexState::kDefining) continue;  // listed, but where it was
    const std::uint32_t before = groups.owner[v];
    const std::uint32_t now = before != kNoIndex && fitter.fits(i, before) ? before : fitter.nearest(i);
    report.projected += now != kNoIndex && now == before;
    report.reinserted += now != kNoIndex && now != before;
    report.ejected += now == kNoIndex && before != kNoIndex;
    groups.owner[v] = now;
    groups.state[v] = now == kNoIndex ? VertexState::kFree : VertexState::kGrouped;
    groups.positions[v] = mesh.positions[v];
    if (now == kNoIndex) continue;
    const VertexGroup& g = groups.groups[now];
    const PlaneFrame* frame = g.kind == GroupKind::kPlane ? &groups.planes[g.plane] : nullptr;
    parameters[v] = placement.parametersOf(g, frame, v, mesh.positions[v]);
    groups.positions[v] = pointOn(g, parameters[v].s, parameters[v].t);
  }
  relistMembers(parameters, groups);
  finishGroups(mesh, false, start_ns, groups);
  report.kept_bases = countKeptBases(groups);
  return report;
}

}  // namespace sheaf::grouping
