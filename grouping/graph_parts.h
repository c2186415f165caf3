// grouping/graph_parts: a dual graph cut into compact parts of equal size.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "grouping/dual_graph.h"

namespace sheaf::grouping {

/// Clusters in an order in which every run of `size` is a part; the last part may be smaller.
struct GraphParts {
  std::size_t size = 1;
  std::vector<std::uint32_t> order;     ///< #C clusters
  std::vector<std::uint32_t> position;  ///< #C, where each stands in `order`

  std::size_t count() const { return (order.size() + size - 1) / size; }
  std::span<const std::uint32_t> clustersOf(std::size_t part) const {
    const std::size_t begin = part * size;
    return std::span(order).subspan(begin, std::min(size, order.size() - begin));
  }
};

/// A part grows over dual edges from one cluster outwards, so it is compact; where others wall it in, it goes on
/// elsewhere. It begins where an earlier part has left neighbours, else at the lowest cluster that is left.
/// size  at least 1
/// O(C + E)
GraphParts cutIntoParts(const DualGraph& graph, std::size_t size);

/// A part as a dual graph of its own: its clusters, in their order, and as its halo their neighbours in other parts,
/// ascending. Edges are those that have an end in the part: face[0] is always in it.
struct PartGraph {
  DualGraph graph;
  std::vector<std::uint32_t> clusters;  ///< in the whole graph: the part's own, then the halo
  std::uint32_t own = 0;
};

PartGraph partGraph(const DualGraph& whole, const GraphParts& parts, std::size_t part);

}  // namespace sheaf::grouping
