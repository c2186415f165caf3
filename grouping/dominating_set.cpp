#include "grouping/dominating_set.h"

#include <algorithm>
#include <bit>
#include <cassert>

namespace sheaf::grouping {
namespace {

constexpr std::uint64_t kReportSteps = 1024;

template <class Body>
void forEachBit(const std::uint64_t* words, std::size_t count, const Body& body) {
  for (std::size_t w = 0; w < count; ++w)
    for (std::uint64_t bits = words[w]; bits != 0; bits &= bits - 1)
      body(static_cast<std::uint32_t>(64 * w + static_cast<std::size_t>(std::countr_zero(bits))));
}

std::uint32_t commonBits(const std::uint64_t* a, const std::uint64_t* b, std::size_t count) {
  int common = 0;
  for (std::size_t w = 0; w < count; ++w) common += std::popcount(a[w] & b[w]);
  return static_cast<std::uint32_t>(common);
}

// [Gao15], RWLS: the score of a vertex is the weight that changes between covered and uncovered when it is added
// (positive) or dropped (negative).
class LocalSearch {
 public:
  LocalSearch(const BitGraph& graph, const VertexSet& start)
      : graph_(graph),
        chosen_(graph.vertexCount(), false),
        can_add_(graph.vertexCount(), true),
        cover_(graph.vertexCount(), 0),
        weight_(graph.vertexCount(), 1),
        score_(graph.vertexCount(), 0),
        changed_at_(graph.vertexCount(), 0) {
    for (std::uint32_t v = 0; v < graph.vertexCount(); ++v) {
      forEachBit(graph.row(v), graph.wordCount(), [&](std::uint32_t) { ++score_[v]; });
      uncovered_.push_back(v);
    }
    for (const std::uint32_t v : start) add(v);
  }

  // One exchange. Call while the set covers all but a little.
  void step(std::uint64_t now) {
    if (!set_.empty()) drop(bestToDrop(last_added_), now);
    const std::uint32_t row = uncovered_[random(uncovered_.size())];
    const std::uint32_t v = bestToAdd(row);
    add(v);
    last_added_ = v;
    changed_at_[v] = now;
    for (const std::uint32_t u : uncovered_) {
      ++weight_[u];
      forEachBit(graph_.row(u), graph_.wordCount(), [&](std::uint32_t w) { ++score_[w]; });
    }
  }

  void dropLeastMissed(std::uint64_t now) { drop(bestToDrop(kNone), now); }
  bool coversAll() const { return uncovered_.empty(); }
  bool isEmpty() const { return set_.empty(); }
  VertexSet chosen() const {
    VertexSet sorted = set_;
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

  std::size_t random(std::size_t count) {  // xorshift, the same everywhere
    seed_ ^= seed_ << 13U, seed_ ^= seed_ >> 7U, seed_ ^= seed_ << 17U;
    return static_cast<std::size_t>(seed_ % count);
  }

  bool isBetter(std::uint32_t v, std::uint32_t best) const {
    if (best == kNone || score_[v] != score_[best]) return best == kNone || score_[v] > score_[best];
    return changed_at_[v] != changed_at_[best] ? changed_at_[v] < changed_at_[best] : v < best;
  }

  std::uint32_t bestToDrop(std::uint32_t forbidden) const {
    std::uint32_t best = kNone;
    for (const std::uint32_t v : set_)
      if ((v != forbidden || set_.size() == 1) && isBetter(v, best)) best = v;
    return best;
  }

  std::uint32_t bestToAdd(std::uint32_t row) const {
    std::uint32_t best = kNone, fallback = kNone;
    forEachBit(graph_.row(row), graph_.wordCount(), [&](std::uint32_t v) {
      if (can_add_[v] && isBetter(v, best)) best = v;
      if (isBetter(v, fallback)) fallback = v;
    });
    return best == kNone ? fallback : best;
  }

  void add(std::uint32_t v) {
    assert(!chosen_[v]);
    chosen_[v] = true;
    set_.push_back(v);
    score_[v] = -score_[v];
    forEachBit(graph_.row(v), graph_.wordCount(), [&](std::uint32_t u) {
      if (u != v) can_add_[u] = true;
      if (cover_[u]++ == 0) {  // no other vertex gains by covering u any more
        std::erase(uncovered_, u);
        changeScores(u, v, -weight_[u]);
      } else if (cover_[u] == 2) {  // the one that covered it alone loses nothing by leaving
        changeScoreOfCoverer(u, v, weight_[u]);
      }
    });
  }

  void drop(std::uint32_t v, std::uint64_t now) {
    chosen_[v] = false;
    can_add_[v] = false;
    changed_at_[v] = now;
    std::erase(set_, v);
    score_[v] = -score_[v];
    forEachBit(graph_.row(v), graph_.wordCount(), [&](std::uint32_t u) {
      if (u != v) can_add_[u] = true;
      if (--cover_[u] == 0) {
        uncovered_.push_back(u);
        changeScores(u, v, weight_[u]);
      } else if (cover_[u] == 1) {
        changeScoreOfCoverer(u, v, -weight_[u]);
      }
    });
  }

  void changeScores(std::uint32_t u, std::uint32_t except, std::int64_t change) {
    forEachBit(graph_.row(u), graph_.wordCount(), [&](std::uint32_t w) {
      if (w != except) score_[w] += change;
    });
  }

  void changeScoreOfCoverer(std::uint32_t u, std::uint32_t except, std::int64_t change) {
    for (const std::uint32_t w : set_)
      if (w != except && graph_.joins(u, w)) {
        score_[w] += change;
        return;
      }
  }

  const BitGraph& graph_;
  VertexSet set_;
  std::vector<std::uint32_t> uncovered_;
  std::vector<bool> chosen_;
  std::vector<bool> can_add_;  // not dropped since its neighbourhood last changed: no going in circles
  std::vector<std::uint32_t> cover_;
  std::vector<std::int64_t> weight_, score_;
  std::vector<std::uint64_t> changed_at_;
  std::uint32_t last_added_ = kNone;
  std::uint64_t seed_ = 0x9E3779B97F4A7C15ULL;
};

class BranchAndBound {
 public:
  BranchAndBound(const BitGraph& graph, VertexSet start, std::uint64_t max_nodes,
                 const std::function<bool(std::uint64_t)>& proceed)
      : graph_(graph), words_(graph.wordCount()), best_(std::move(start)), max_nodes_(max_nodes), proceed_(proceed) {}

  ProvenSet run() {
    Node root{std::vector<std::uint64_t>(words_, 0), std::vector<std::uint64_t>(words_, 0)};
    for (std::uint32_t v = 0; v < graph_.vertexCount(); ++v) {
      root.uncovered[v / 64] |= std::uint64_t{1} << (v % 64);
      root.allowed[v / 64] |= std::uint64_t{1} << (v % 64);
    }
    const std::uint32_t root_bound = bound(root);
    visit(root);
    std::sort(best_.begin(), best_.end());
    // Cut off by the limit, nothing is proven beyond the bound at the root.
    const auto size = static_cast<std::uint32_t>(best_.size());
    return {best_, stopped_ ? std::min(root_bound, size) : size, nodes_};
  }

 private:
  struct Node {
    std::vector<std::uint64_t> uncovered;
    std::vector<std::uint64_t> allowed;  // vertices that may still be chosen
  };

  std::uint32_t coverersOf(std::uint32_t v, const Node& node) const {
    return commonBits(graph_.row(v), node.allowed.data(), words_);
  }

  // How many more vertices are needed at least.
  std::uint32_t bound(const Node& node) {
    std::uint32_t uncovered = 0, largest = 0;
    for (const std::uint64_t w : node.uncovered) uncovered += static_cast<std::uint32_t>(std::popcount(w));
    if (uncovered == 0) return 0;
    forEachBit(node.allowed.data(), words_, [&](std::uint32_t v) {
      largest = std::max(largest, commonBits(graph_.row(v), node.uncovered.data(), words_));
    });
    if (largest == 0) return graph_.vertexCount() + 1;  // something cannot be covered any more
    return std::max((uncovered + largest - 1) / largest, packing(node));
  }

  // Uncovered vertices no two of which share a coverer, those with few coverers first.
  std::uint32_t packing(const Node& node) {
    order_.clear();
    forEachBit(node.uncovered.data(), words_, [&](std::uint32_t v) { order_.push_back({coverersOf(v, node), v}); });
    std::sort(order_.begin(), order_.end());
    taken_.assign(words_, 0);
    std::uint32_t count = 0;
    for (const auto& [coverers, v] : order_) {
      bool is_disjoint = true;
      for (std::size_t w = 0; w < words_ && is_disjoint; ++w)
        is_disjoint = (graph_.row(v)[w] & node.allowed[w] & taken_[w]) == 0;
      if (!is_disjoint) continue;
      for (std::size_t w = 0; w < words_; ++w) taken_[w] |= graph_.row(v)[w] & node.allowed[w];
      ++count;
    }
    return count;
  }

  void visit(const Node& node) {
    if (stopped_) return;
    if (++nodes_ > max_nodes_ || (nodes_ % kReportSteps == 0 && !proceed_(nodes_))) {
      stopped_ = true;
      return;
    }
    const std::uint32_t needed = bound(node);
    if (needed == 0 && chosen_.size() < best_.size()) best_ = chosen_;
    if (needed == 0 || chosen_.size() + needed >= best_.size()) return;

    std::uint32_t fewest = graph_.vertexCount() + 1, row = 0;
    forEachBit(node.uncovered.data(), words_, [&](std::uint32_t v) {
      if (const std::uint32_t coverers = coverersOf(v, node); coverers < fewest) fewest = coverers, row = v;
    });
    std::vector<std::pair<std::uint32_t, std::uint32_t>> branches;  // those that cover least, vertex
    for (std::uint32_t v = 0; v < graph_.vertexCount(); ++v)
      if (graph_.joins(row, v) && (node.allowed[v / 64] >> (v % 64) & 1U) != 0)
        branches.emplace_back(~commonBits(graph_.row(v), node.uncovered.data(), words_), v);
    std::sort(branches.begin(), branches.end());
    Node child = node;
    for (const auto& [key, v] : branches) {
      for (std::size_t w = 0; w < words_; ++w) child.uncovered[w] = node.uncovered[w] & ~graph_.row(v)[w];
      // What has been tried in one branch need not be chosen in the later ones.
      child.allowed[v / 64] &= ~(std::uint64_t{1} << (v % 64));
      chosen_.push_back(v);
      visit(child);
      chosen_.pop_back();
    }
  }

  const BitGraph& graph_;
  std::size_t words_;
  VertexSet best_, chosen_;
  std::uint64_t max_nodes_, nodes_ = 0;
  const std::function<bool(std::uint64_t)>& proceed_;
  bool stopped_ = false;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> order_;
  std::vector<std::uint64_t> taken_;
};

}  // namespace

VertexSet shrinkDominatingSet(const BitGraph& graph, VertexSet start, std::uint64_t steps,
                              const std::function<bool(std::uint64_t)>& proceed) {
  LocalSearch search(graph, start);
  VertexSet best = std::move(start);
  for (std::uint64_t step = 1; step <= steps; ++step) {
    if (step % kReportSteps == 0 && !proceed(step)) break;
    while (search.coversAll() && !search.isEmpty()) {
      best = search.chosen();
      search.dropLeastMissed(step);
    }
    if (best.size() <= 1) break;
    search.step(step);
  }
  return search.coversAll() && search.chosen().size() < best.size() ? search.chosen() : best;
}

ProvenSet proveDominatingSet(const BitGraph& graph, VertexSet start, std::uint64_t max_nodes,
                             const std::function<bool(std::uint64_t)>& proceed) {
  return BranchAndBound(graph, std::move(start), max_nodes, proceed).run();
}

}  // namespace sheaf::grouping
