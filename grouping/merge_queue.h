// grouping/merge_queue: the dual edges by cost, cheapest first.
//   Method edges up to a bound stand in a heap, the others wait in a list without order. When the heap is empty the
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
  /// cost_of(edge) is not NaN
  template <typename CostOf>
  MergeQueue(std::vector<DualEdge>& edges, const CostOf& cost_of) : edges_(edges), waiting_(edges.size()) {
    for (std::uint32_t id = 0; id < edges.size(); ++id) {
      edges[id].cost = rounded(cost_of(edges[id]));
      edges[id].is_waiting = true;
      waiting_[id] = id;
    }
  }

  /// Makes top() the cheapest edge; false if no edge is left.
  bool prepareTop() {
    while (true) {
      while (!heap_.empty() && !isCurrent(heap_.front())) pop();
      if (!heap_.empty()) return true;
      if (waiting_.empty()) return false;
      moveBound();
    }
  }
  std::uint32_t top() const { return edgeOf(heap_.front()); }

  /// The edge comes back when its cost is updated.
  void pop() {
    const std::uint64_t last = heap_.back();
    heap_.pop_back();
    const std::size_t size = heap_.size();
    if (size == 0) return;
    std::size_t at = 0;
    for (std::size_t first = 1; first < size; first = 4 * at + 1) {
      std::size_t least = first;
      for (std::size_t child = first + 1; child < std::min(first + 4, size); ++child)
        if (heap_[child] < heap_[least]) least = child;
      if (last < heap_[least]) break;
      heap_[at] = heap_[least];
      at = least;
    }
    heap_[at] = last;
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
    const std::uint64_t entry = entryOf(id, edges_[id].cost);
    std::size_t at = heap_.size();
    heap_.push_back(entry);
    for (; at > 0 && entry < heap_[(at - 1) / 4]; at = (at - 1) / 4) heap_[at] = heap_[(at - 1) / 4];
    heap_[at] = entry;
  }

  // The heap is empty. The bound goes to the eighth part of a sample; if all cost the same, to that.
  void moveBound() {
    constexpr std::size_t kSample = 512, kShare = 8;
    std::erase_if(waiting_, [this](std::uint32_t id) { return edges_[id].length == kContracted; });
    if (waiting_.empty()) return;
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
  std::vector<std::uint64_t> heap_;     // four children per node
  std::vector<std::uint32_t> waiting_;  // all edges that cost more than bound_, and some that do not any more
  float bound_ = -std::numeric_limits<float>::infinity();
};

}  // namespace sheaf::grouping
