// grouping/dominating_set: few vertices of a graph such that every other one is joined to one of them.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace sheaf::grouping {

/// An undirected graph as a square of bits; every vertex counts as joined to itself.
class BitGraph {
 public:
  explicit BitGraph(std::uint32_t vertex_count)
      : vertex_count_(vertex_count), words_((vertex_count + 63) / 64), bits_(std::size_t{vertex_count} * words_, 0) {
    for (std::uint32_t v = 0; v < vertex_count; ++v) join(v, v);
  }
  std::uint32_t vertexCount() const { return vertex_count_; }
  std::size_t wordCount() const { return words_; }
  const std::uint64_t* row(std::uint32_t v) const { return bits_.data() + v * words_; }
  bool joins(std::uint32_t a, std::uint32_t b) const { return (row(a)[b / 64] >> (b % 64) & 1U) != 0; }
  void join(std::uint32_t a, std::uint32_t b) {
    bits_[a * words_ + b / 64] |= std::uint64_t{1} << (b % 64);
    bits_[b * words_ + a / 64] |= std::uint64_t{1} << (a % 64);
  }

 private:
  std::uint32_t vertex_count_;
  std::size_t words_;
  std::vector<std::uint64_t> bits_;
};

using VertexSet = std::vector<std::uint32_t>;  // ascending

/// Tries to make a dominating set smaller by weighted local search: drop the vertex that is missed least, then repair
/// by adding the one that covers most weight, vertices that stay uncovered growing heavier. After [Gao15]: Gao, Yao,
/// Weise, Li, "An efficient local search heuristic with row weighting for the unicost set covering problem", EJOR 246,
/// 2015. proceed called now and then; false stops the search
VertexSet shrinkDominatingSet(const BitGraph& graph, VertexSet start, std::uint64_t steps,
                              const std::function<bool(std::uint64_t step)>& proceed);

struct ProvenSet {
  VertexSet best;
  std::uint32_t at_least = 0;  ///< no dominating set is smaller
  std::uint64_t nodes = 0;
};

/// Branch and bound: branches over the vertices that can cover the vertex with the fewest such; bounds by disjoint
/// neighbourhoods and by the largest cover.
ProvenSet proveDominatingSet(const BitGraph& graph, VertexSet start, std::uint64_t max_nodes,
                             const std::function<bool(std::uint64_t node)>& proceed);

}  // namespace sheaf::grouping
