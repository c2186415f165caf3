// grouping/slab_queries: which vertices does this plane cut? Two answers with the same interface:
//   collect(axis, p, is_live, body)   calls body(vertex) for every live vertex whose slab along `axis` holds p, in an
//                                     order of its own; body may end a vertex's life. Dead vertices never live again.
// A header, because planar_groups.cpp runs the same search over either.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "grouping/slabs.h"

namespace sheaf::grouping {

/// For slabs of one width: a run of the sorted projections. Dead vertices in it are passed over one by one, which is
/// cheap for this search: after the planes of a vertex have been used, every other live vertex is more than a
/// half-width away from them, so the planes used along one axis lie more than a half-width apart and no run element is
/// seen by more than two of them.
class RunQuery {
 public:
  explicit RunQuery(const Slabs& slabs) : slabs_(slabs) {}

  template <class IsLive, class Body>
  void collect(std::uint32_t axis, float p, const IsLive& is_live, const Body& body) {
    const SlabOrder& order = slabs_.axes[axis];
    const float half = slabs_.common_half;
    const auto first =
        std::partition_point(order.x.begin(), order.x.end(), [&](float x) { return x < p && !(p - x <= half); });
    for (std::size_t i = static_cast<std::size_t>(first - order.x.begin()); i < order.x.size(); ++i) {
      if (order.x[i] > p && !(order.x[i] - p <= half)) break;
      const std::uint32_t v = order.vertex[i];
      if (is_live(v)) body(v);
    }
  }

 private:
  const Slabs& slabs_;
};

/// For slabs of any width: for each axis a tree of fan-out 16 over the sorted projections, whose nodes hold the hull of
/// the live slabs below. Hulls shrink when a query comes by and finds vertices dead; each vertex is found dead once.
class TreeQuery {
 public:
  explicit TreeQuery(const Slabs& slabs) : slabs_(slabs) {
    for (std::uint32_t axis = 0; axis < slabs.axis_count; ++axis) trees_.push_back(plant(slabs.axes[axis]));
  }

  template <class IsLive, class Body>
  void collect(std::uint32_t axis, float p, const IsLive& is_live, const Body& body) {
    Tree& tree = trees_[axis];
    if (!tree.empty()) visit(tree, slabs_.axes[axis], tree.size() - 1, 0, p, is_live, body);
  }

 private:
  static constexpr std::size_t kFanOut = 16;
  struct Hull {
    double lo = std::numeric_limits<double>::infinity();
    double hi = -std::numeric_limits<double>::infinity();
    void extend(const Hull& h) {
      lo = std::min(lo, h.lo);
      hi = std::max(hi, h.hi);
    }
    // |x - p| <= half is decided on the rounded difference, so the hull is a little wider than x -+ half.
    void extend(float x, float half) {
      const double reach = double(half) * (1.0 + 1e-6);
      extend({double(x) - reach, double(x) + reach});
    }
    bool holds(double p) const { return lo <= p && p <= hi; }
  };
  /// tree[level][node]; level 0 has a node for every kFanOut slabs, the last level one node.
  using Tree = std::vector<std::vector<Hull>>;

  static Tree plant(const SlabOrder& order) {
    Tree tree;
    if (order.x.empty()) return tree;
    tree.emplace_back((order.x.size() + kFanOut - 1) / kFanOut);
    for (std::size_t i = 0; i < order.x.size(); ++i) tree[0][i / kFanOut].extend(order.x[i], order.half[i]);
    while (tree.back().size() > 1) {
      std::vector<Hull> above((tree.back().size() + kFanOut - 1) / kFanOut);
      for (std::size_t i = 0; i < tree.back().size(); ++i) above[i / kFanOut].extend(tree.back()[i]);
      tree.push_back(std::move(above));
    }
    return tree;
  }

  template <class IsLive, class Body>
  static void visit(Tree& tree, const SlabOrder& order, std::size_t level, std::size_t node, float p,
                    const IsLive& is_live, const Body& body) {
    Hull& hull = tree[level][node];
    if (!hull.holds(p)) return;
    hull = {};
    const std::size_t below = level == 0 ? order.x.size() : tree[level - 1].size();
    const std::size_t end = std::min((node + 1) * kFanOut, below);
    for (std::size_t i = node * kFanOut; i < end; ++i) {
      if (level > 0) {
        visit(tree, order, level - 1, i, p, is_live, body);
        hull.extend(tree[level - 1][i]);
        continue;
      }
      const std::uint32_t v = order.vertex[i];
      if (is_live(v) && std::abs(order.x[i] - p) <= order.half[i]) body(v);
      if (is_live(v)) hull.extend(order.x[i], order.half[i]);
    }
  }

  const Slabs& slabs_;
  std::vector<Tree> trees_;
};

}  // namespace sheaf::grouping
