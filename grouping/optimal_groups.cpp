#include "grouping/optimal_groups.h"

#include <fmt/format.h>

#include <cassert>

#include "core/error.h"
#include "core/stage_timer.h"
#include "grouping/dominating_set.h"
#include "grouping/group_assembly.h"
#include "grouping/group_quality.h"
#include "grouping/slabs.h"

namespace sheaf::grouping {
namespace {

// Joins vertices whose slabs hold each other's projection along some axis.
BitGraph graphOf(const Slabs& slabs) {
  BitGraph graph(slabs.vertex_count);
  for (const SlabOrder& order : slabs.axes)
    for (std::uint32_t i = 0; i < slabs.vertex_count; ++i)
      for (std::uint32_t j = i + 1; j < slabs.vertex_count && order.x[j] - order.x[i] <= slabs.common_half; ++j)
        graph.join(order.vertex[i], order.vertex[j]);
  return graph;
}

std::uint32_t retainedBy(const VertexGroups& groups) {
  return groups.stats.free + groups.stats.defining;
}

VertexSet retainedVertices(const VertexGroups& groups, std::span<const std::uint32_t> in_use) {
  VertexSet set;
  for (std::uint32_t i = 0; i < in_use.size(); ++i)
    if (groups.state[in_use[i]] != VertexState::kGrouped) set.push_back(i);
  return set;
}

// Every vertex outside the set goes to the nearest plane through one inside; ties to the lower vertex, then axis.
Findings findingsOf(const Slabs& slabs, std::span<const std::uint32_t> in_use, const VertexSet& retained,
                    std::size_t mesh_vertex_count) {
  Findings findings;
  findings.owner.assign(mesh_vertex_count, kNoIndex);
  std::vector<bool> is_retained(slabs.vertex_count, false);
  for (const std::uint32_t r : retained) {
    is_retained[r] = true;
    for (std::uint32_t axis = 0; axis < slabs.axis_count; ++axis) findings.seeds.push_back({in_use[r], kNoIndex, axis});
  }
  for (std::uint32_t v = 0; v < slabs.vertex_count; ++v) {
    if (is_retained[v]) continue;
    float least = std::numeric_limits<float>::infinity();
    for (std::uint32_t seed = 0; seed < findings.seeds.size(); ++seed) {
      const std::uint32_t axis = seed % slabs.axis_count;
      const float d = std::abs(slabs.xOf(v, axis) - slabs.xOf(retained[seed / slabs.axis_count], axis));
      if (d < least) least = d, findings.owner[in_use[v]] = seed;
    }
  }
  return findings;
}

}  // namespace

OptimalGroups groupOptimally(const mesh::Mesh& mesh, const OptimalOptions& options) {
  const std::int64_t start_ns = nowNs();
  const std::vector<std::uint32_t> in_use = verticesInUse(mesh.positions, mesh.triangles);
  if (in_use.size() > kMaxOptimalVertices)
    throw Error(ErrorCode::kUnsupported, fmt::format("the optimal search takes at most {} vertices, this mesh uses {}",
                                                     kMaxOptimalVertices, in_use.size()));
  PlanarOptions planar;
  planar.epsilon = options.epsilon;
  planar.planes = options.planes;
  planar.key = TableKey::kUnion;
  OptimalGroups result;
  result.greedy = retainedBy(groupPlanar(mesh, planar));
  planar.key = TableKey::kDynamic;
  result.groups = groupPlanar(mesh, planar);
  result.dynamic = retainedBy(result.groups);
  if (in_use.empty()) return result;

  VertexGroups& out = result.groups;
  const Slabs slabs = makeSlabs(mesh.positions, in_use, out.planes, out.epsilon * out.extent, {});
  const BitGraph graph = graphOf(slabs);
  const auto share = [](std::uint64_t done, std::uint64_t all) { return double(done) / double(all); };
  const auto report = [&](double done) {
    if (options.progress && !options.progress(done)) out.interrupted = true;
    return !out.interrupted;
  };
  const VertexSet small =
      shrinkDominatingSet(graph, retainedVertices(out, in_use), options.search_steps,
                          [&](std::uint64_t step) { return report(0.5 * share(step, options.search_steps)); });
  const ProvenSet proven =
      proveDominatingSet(graph, small, out.interrupted ? 0 : options.max_nodes,
                         [&](std::uint64_t node) { return report(0.5 + 0.5 * share(node, options.max_nodes)); });
  result.best = static_cast<std::uint32_t>(proven.best.size());
  result.at_least = proven.at_least;
  result.nodes = proven.nodes;
  assembleGroups(mesh.positions, in_use, findingsOf(slabs, in_use, proven.best, mesh.vertexCount()), Placement({}),
                 out);
  finishGroups(mesh, false, start_ns, out);
  return result;
}

}  // namespace sheaf::grouping
