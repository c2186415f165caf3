#include "grouping/graph_parts.h"

#include <cassert>
#include <utility>

namespace sheaf::grouping {
namespace {

class PartGrower {
 public:
  PartGrower(const DualGraph& graph, std::size_t size) : graph_(graph) {
    parts_.size = size;
    parts_.order.reserve(graph.first.size());
    parts_.position.assign(graph.first.size(), kNoIndex);
  }

  GraphParts grow() {
    while (parts_.order.size() < graph_.first.size()) growPart();
    return std::move(parts_);
  }

 private:
  bool isTaken(std::uint32_t cluster) const { return parts_.position[cluster] != kNoIndex; }

  void take(std::uint32_t cluster) {
    parts_.position[cluster] = static_cast<std::uint32_t>(parts_.order.size());
    parts_.order.push_back(cluster);
  }

  void growPart() {
    std::size_t next = parts_.order.size();
    const std::size_t end = std::min(next + parts_.size, graph_.first.size());
    while (next < end) {
      if (next == parts_.order.size()) take(nextSeed());
      forEachNeighbour(parts_.order[next++], [&](std::uint32_t neighbour) {
        if (isTaken(neighbour)) return;
        if (parts_.order.size() < end)
          take(neighbour);
        else
          seeds_.push_back(neighbour);
      });
    }
  }

  // The first one outside an earlier part, else the first of another piece of the mesh.
  std::uint32_t nextSeed() {
    while (next_seed_ < seeds_.size())
      if (const std::uint32_t seed = seeds_[next_seed_++]; !isTaken(seed)) return seed;
    while (isTaken(next_cluster_)) ++next_cluster_;
    return next_cluster_;
  }

  template <typename Body>
  void forEachNeighbour(std::uint32_t cluster, const Body& body) const {
    for (std::uint32_t id = graph_.first[cluster]; id != kNoIndex;) {
      const DualEdge& e = graph_.edges[id];
      const int side = e.sideOf(cluster);
      body(e.face[1 - side]);
      id = e.next[side];
    }
  }

  const DualGraph& graph_;
  GraphParts parts_;
  std::vector<std::uint32_t> seeds_;  // neighbours of parts, in the order in which they were met
  std::size_t next_seed_ = 0;
  std::uint32_t next_cluster_ = 0;
};

}  // namespace

GraphParts cutIntoParts(const DualGraph& graph, std::size_t size) {
  assert(size > 0);
  return PartGrower(graph, size).grow();
}

PartGraph partGraph(const DualGraph& whole, const GraphParts& parts, std::size_t part) {
  PartGraph out;
  const auto clusters = parts.clustersOf(part);
  const auto begin = static_cast<std::uint32_t>(part * parts.size);
  out.own = static_cast<std::uint32_t>(clusters.size());
  out.clusters.assign(clusters.begin(), clusters.end());
  std::vector<std::uint32_t> outside;
  for (std::uint32_t i = 0; i < out.own; ++i)
    for (std::uint32_t id = whole.first[clusters[i]]; id != kNoIndex;) {
      const DualEdge& e = whole.edges[id];
      const int side = e.sideOf(clusters[i]);
      const std::uint32_t other = parts.position[e.face[1 - side]] - begin;  // beyond `own`: outside
      if (other > i) out.graph.edges.push_back({{i, other}, {}, e.length, 0.0F, false});
      if (other >= out.own) outside.push_back(e.face[1 - side]);
      id = e.next[side];
    }
  std::ranges::sort(outside);
  outside.erase(std::unique(outside.begin(), outside.end()), outside.end());
  out.clusters.insert(out.clusters.end(), outside.begin(), outside.end());
  for (DualEdge& e : out.graph.edges)
    if (e.face[1] >= out.own) {
      const std::uint32_t cluster = parts.order[begin + e.face[1]];
      e.face[1] = out.own + static_cast<std::uint32_t>(std::ranges::lower_bound(outside, cluster) - outside.begin());
    }
  linkEdges(out.clusters.size(), out.graph);
  return out;
}

}  // namespace sheaf::grouping
