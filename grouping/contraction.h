// grouping/contraction: the greedy contraction of the dual graph [HFC]: the cheapest dual edge is contracted until none
// is left.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "grouping/cluster_cost.h"
#include "grouping/dual_graph.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

/// Merge i makes node #F + i of two older nodes; nodes [0, #F) are the faces.
struct MergeTree {
  std::vector<std::array<std::uint32_t, 2>> children;  ///< #merges, the lower node first
  std::vector<float> cost;                             ///< #merges, of each when it was made
};

/// Clusters with more neighbours than this are hubs.
inline constexpr std::uint32_t kHubDegree = 64;

/// Large meshes are contracted region by region, because jumping about in memory takes more time than all arithmetic.
struct ContractionPlan {
  /// Up to so many dual edges every merge is the cheapest of all.
  std::size_t exact_edges = std::size_t{1} << 18U;
  /// Beyond, edges are contracted in rounds, each up to a cost that an eighth of them keeps to. Within a round it goes
  /// through the regions, runs of this many edges, one after the other: in each the cheapest comes first, but where two
  /// regions touch, one may be ahead of the other by up to a round. When so few edges are left, order is exact again.
  std::size_t region_edges = std::size_t{1} << 16U;
};

/// Equal costs (rounded to float) go to the lower dual edge. Where two dual edges become parallel, the one of the
/// cluster with more neighbours stays.
/// turned  #F or empty: faces whose normal counts the other way round
/// Every cost is up to date but those of hubs, whose neighbours would all have to be looked at again after each merge:
/// a hub's edges are evaluated anew when it has grown by an eighth, and each of them once more before it is contracted.
/// O(F log F) time; at most 250 bytes per face, input not counted.
MergeTree contractGreedily(const mesh::Mesh& mesh, const ModelFrame& frame, DualGraph graph,
                           const std::vector<bool>& turned, const CostWeights& weights,
                           const ContractionPlan& plan = {});

}  // namespace sheaf::grouping
