// grouping/merge_queue: the dual edges by cost: a heap of four children per node in which every edge knows its place.
#pragma once

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstdint>
#include <limits>
#include <vector>

namespace sheaf::grouping {

/// Edges [0, n) by cost rounded to float, equal ones by number. Once built it allocates nothing.
class MergeQueue {
 public:
  MergeQueue() = default;
  /// cost_of  the cost of edge 0, 1, 2 ..., not NaN
  template <typename CostOf>
  MergeQueue(std::uint32_t count, const CostOf& cost_of) : heap_(count), place_(count) {
    for (std::uint32_t e = 0; e < count; ++e) heap_[e] = entryOf(e, cost_of(e)), place_[e] = e;
    for (std::uint32_t at = count / 4 + 1; at-- > 0;)
      if (at < count) sink(at, heap_[at]);
  }

  bool empty() const { return heap_.empty(); }
  std::uint32_t top() const { return edgeOf(heap_.front()); }
  float topCost() const { return costOf(heap_.front()); }

  void update(std::uint32_t edge, double cost) {
    const std::uint32_t at = place_[edge];
    const std::uint64_t entry = entryOf(edge, cost);
    if (entry < heap_[at])
      rise(at, entry);
    else
      sink(at, entry);
  }

  void remove(std::uint32_t edge) {
    const std::uint32_t at = place_[edge];
    const std::uint64_t last = heap_.back();
    heap_.pop_back();
    if (at == heap_.size()) return;
    if (last < heap_[at])
      rise(at, last);
    else
      sink(at, last);
  }

 private:
  // Above: the float's bits, turned so that they compare like the number. Below: the edge.
  static std::uint64_t entryOf(std::uint32_t edge, double cost) {
    assert(!(cost != cost));
    const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(cost) + 0.0F);  // -0 becomes 0
    return std::uint64_t{bits ^ (bits >> 31U != 0 ? 0xFFFFFFFFU : 0x80000000U)} << 32U | edge;
  }
  static std::uint32_t edgeOf(std::uint64_t entry) { return static_cast<std::uint32_t>(entry); }
  static float costOf(std::uint64_t entry) {
    const auto bits = static_cast<std::uint32_t>(entry >> 32U);
    return std::bit_cast<float>(bits ^ (bits >> 31U != 0 ? 0x80000000U : 0xFFFFFFFFU));
  }

  void put(std::uint32_t at, std::uint64_t entry) {
    heap_[at] = entry;
    place_[edgeOf(entry)] = at;
  }
  void rise(std::uint32_t at, std::uint64_t entry) {
    while (at > 0) {
      const std::uint32_t parent = (at - 1) / 4;
      if (heap_[parent] < entry) break;
      put(at, heap_[parent]);
      at = parent;
    }
    put(at, entry);
  }
  void sink(std::uint32_t at, std::uint64_t entry) {
    const auto size = static_cast<std::uint32_t>(heap_.size());
    for (std::uint64_t first = 4 * std::uint64_t{at} + 1; first < size; first = 4 * std::uint64_t{at} + 1) {
      auto least = static_cast<std::uint32_t>(first);
      const auto end = static_cast<std::uint32_t>(std::min<std::uint64_t>(first + 4, size));
      for (std::uint32_t child = least + 1; child < end; ++child)
        if (heap_[child] < heap_[least]) least = child;
      if (entry < heap_[least]) break;
      put(at, heap_[least]);
      at = least;
    }
    put(at, entry);
  }

  std::vector<std::uint64_t> heap_;
  std::vector<std::uint32_t> place_;
};

}  // namespace sheaf::grouping
