// grouping/merge_queue: the dual edges by cost, cheapest first.
//   Method edges up to a bound stand in heaps, the others wait in a list without order. When the heaps are empty the
//          bound moves up, so that a share of those that wait come in. Both hold numbers of edges that may have changed
//          since; what an edge costs now stands in the edge alone. So a change of cost, of which there are five per
//          contraction, touches no memory but the edge and the end of an array, where a heap of all edges would move
//          others about all over it
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstdint>
#include <limits>
#include <vector>

#include "grouping/dual_graph.h"

namespace sheaf::grouping {

/// Equal costs go to the lower edge. The queue writes DualEdge::cost and is_waiting. Edges are taken out by setting
/// their length to kContracted.
class MergeQueue {
 public:
  /// edges         outlives the queue
  /// region_edges  at least 1. Runs of so many edges have a heap of their own: up to the bound, the queue empties them
  ///               one after the other. Once no more edges than that are left, all go into one heap, in exact order
  /// cost_of(edge) is not NaN
  template <typename CostOf>
  MergeQueue(std::vector<DualEdge>& edges, std::size_t region_edges, const CostOf& cost_of)
      : edges_(edges), region_edges_(region_edges), heaps_(edges.size() / region_edges + 1), waiting_(edges.size()) {
    for (std::uint32_t id = 0; id < edges.size(); ++id) {
      edges[id].cost = rounded(cost_of(edges[id]));
      edges[id].is_waiting = true;
      waiting_[id] = id;
    }
  }

  /// Makes top() the cheapest edge of the present region; false if no edge is left at all.
  bool prepareTop() {
    while (true) {
      for (std::size_t i = 0; i < heaps_.size(); ++i, region_ = (region_ + 1) % heaps_.size()) {
        while (!heaps_[region_].empty() && !isCurrent(heaps_[region_].front())) pop();
        if (!heaps_[region_].empty()) return true;
      }
      if (waiting_.empty()) return false;
      moveBound();
    }
  }
  std::uint32_t top() const { return edgeOf(heaps_[region_].front()); }

  void pop() {
    std::vector<std::uint64_t>& heap = heaps_[region_];
    const std::uint64_t last = heap.back();
    heap.pop_back();
    const std::size_t size = heap.size();
    if (size == 0) return;
    std::size_t at = 0;
    for (std::size_t first = 1; first < size; first = 4 * at + 1) {
      std::size_t least = first;
      for (std::size_t child = first + 1; child < std::min(first + 4, size); ++child)
        if (heap[child] < heap[least]) least = child;
      if (last < heap[least]) break;
      heap[at] = heap[least];
      at = least;
    }
    heap[at] = last;
  }

  void update(std::uint32_t id, double cost) {
    DualEdge& edge = edges_[id];
    edge.cost = rounded(cost);
    if (edge.cost <= bound_) {
      push(id);
    } else if (!edge.is_waiting) {
      edge.is_waiting = true;
      waiting_.push_back(id);
    }
  }

 private:
  static float rounded(double cost) {
    assert(!(cost != cost));
    return static_cast<float>(cost) + 0.0F;  // -0 becomes 0
  }

  // Above: the float's bits, turned so that they compare like the number. Below: the edge.
  static std::uint64_t entryOf(std::uint32_t id, float cost) {
    const auto bits = std::bit_cast<std::uint32_t>(cost);
    return std::uint64_t{bits ^ (bits >> 31U != 0 ? 0xFFFFFFFFU : 0x80000000U)} << 32U | id;
  }
  static std::uint32_t edgeOf(std::uint64_t entry) { return static_cast<std::uint32_t>(entry); }

  bool isCurrent(std::uint64_t entry) const {
    const DualEdge& edge = edges_[edgeOf(entry)];
    return edge.length != kContracted && entry == entryOf(edgeOf(entry), edge.cost);
  }

  void push(std::uint32_t id) {
    std::vector<std::uint64_t>& heap = heaps_[id / region_edges_];
    const std::uint64_t entry = entryOf(id, edges_[id].cost);
    std::size_t at = heap.size();
    heap.push_back(entry);
    for (; at > 0 && entry < heap[(at - 1) / 4]; at = (at - 1) / 4) heap[at] = heap[(at - 1) / 4];
    heap[at] = entry;
  }

  // All heaps are empty. The bound goes to the eighth part of a sample; if all cost the same, to that.
  void moveBound() {
    constexpr std::size_t kSample = 512, kShare = 8;
    std::erase_if(waiting_, [this](std::uint32_t id) { return edges_[id].length == kContracted; });
    if (waiting_.empty()) return;
    if (waiting_.size() <= region_edges_) {
      region_edges_ = std::max(region_edges_, edges_.size());
      heaps_.resize(1);
      region_ = 0;
    }
    std::array<float, kSample> sample{};
    const std::size_t count = std::min(kSample, waiting_.size());
    for (std::size_t i = 0; i < count; ++i) sample[i] = edges_[waiting_[i * waiting_.size() / count]].cost;
    const auto nth = sample.begin() + static_cast<std::ptrdiff_t>(count / kShare);
    std::nth_element(sample.begin(), nth, sample.begin() + static_cast<std::ptrdiff_t>(count));
    bound_ = std::max(bound_, *nth);
    std::erase_if(waiting_, [this](std::uint32_t id) {
      if (edges_[id].cost > bound_) return false;
      edges_[id].is_waiting = false;
      push(id);
      return true;
    });
  }

  std::vector<DualEdge>& edges_;
  std::size_t region_edges_;
  std::vector<std::vector<std::uint64_t>> heaps_;  // one per region, four children per node
  std::size_t region_ = 0;
  std::vector<std::uint32_t> waiting_;  // all edges that cost more than bound_, and some that do not any more
  float bound_ = -std::numeric_limits<float>::infinity();
};

}  // namespace sheaf::grouping
