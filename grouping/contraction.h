// grouping/contraction: the greedy contraction of a dual graph [HFC]: the cheapest dual edge is contracted until none
// is left.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "grouping/cluster_cost.h"
#include "grouping/dual_graph.h"

namespace sheaf::grouping {

/// Merge i makes node #C + i of two older nodes; nodes [0, #C) are the clusters that there were before.
struct MergeTree {
  std::vector<std::array<std::uint32_t, 2>> children;  ///< #merges, the lower node first
  std::vector<float> cost;                             ///< #merges, of each when it was made
};

/// What is known of a cluster of a dual graph, by its number there.
using MomentsOf = std::function<ClusterMoments(std::uint32_t cluster)>;

/// Clusters with more neighbours than this are hubs.
inline constexpr std::uint32_t kHubDegree = 64;

/// Equal costs (rounded to float) go to the lower dual edge. Where two dual edges become parallel, the one of the
/// cluster with more neighbours stays.
/// Every cost is up to date but those of hubs, whose neighbours would all have to be looked at again after each merge:
/// a hub's edges are evaluated anew when it has grown by an eighth, and each of them once more before it is contracted.
/// O(C log C) time; at most 250 bytes per cluster, `graph` included, where it has 1.5 dual edges for each.
MergeTree contract(DualGraph graph, const MomentsOf& moments_of, const CostWeights& weights);

/// What has become of a part of a dual graph.
struct ContractedPart {
  /// Two clusters that share a border of this length, in the model frame: numbers of those that are left, from there on
  /// of the halo.
  struct Link {
    std::array<std::uint32_t, 2> cluster;
    double length;
  };

  MergeTree tree;                       ///< of the part's own clusters
  std::vector<std::uint32_t> node;      ///< #left, in `tree`
  std::vector<ClusterMoments> moments;  ///< #left
  std::vector<Link> links;              ///< each pair at most once
};

/// Contracts a part of a larger dual graph. Clusters [0, own) are the part; the others are its halo, their neighbours
/// in other parts: no edge to them is contracted, but each counts as a neighbour. graph       every edge has its
/// face[0] in the part least       stops when no more clusters of the part are left moments_of  of the halo, too
ContractedPart contractPart(DualGraph graph, std::uint32_t own, std::uint32_t least, const MomentsOf& moments_of,
                            const CostWeights& weights);

}  // namespace sheaf::grouping
