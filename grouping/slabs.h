// grouping/slabs: the one-dimensional view of planar grouping. Along each plane direction a vertex is an interval, its
// slab, around its projection: a parallel plane can take the vertex if and only if it cuts the slab. For the distance
// metric every slab has half-width epsilon; for the quadric metric it is how far the vertex's ellipsoid reaches.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "grouping/quadric.h"
#include "grouping/vertex_groups.h"

namespace sheaf::grouping {

/// Vertices sorted by their projection on one plane direction.
struct SlabOrder {
  std::vector<std::uint32_t> vertex;
  std::vector<float> x;     ///< beside vertex, ascending
  std::vector<float> half;  ///< beside vertex; empty if all are alike
};

/// Vertices are numbered as in the `in_use` that this was made from. Where the order of rounding matters it is this:
/// a plane at p cuts the slab iff |x - p| <= half, in float.
struct Slabs {
  std::uint32_t vertex_count = 0;
  std::uint32_t axis_count = 0;
  std::vector<float> x;         ///< axis_count values for each vertex
  std::vector<float> half;      ///< the same, or empty if all are `common_half`
  float common_half = 0.0F;     ///< half-width of every slab, if `half` is empty
  std::vector<SlabOrder> axes;  ///< one for each plane direction

  float xOf(std::uint32_t v, std::uint32_t axis) const { return x[std::size_t{v} * axis_count + axis]; }
  float halfOf(std::uint32_t v, std::uint32_t axis) const {
    return half.empty() ? common_half : half[std::size_t{v} * axis_count + axis];
  }
  bool isCut(std::uint32_t v, std::uint32_t axis, float p) const {
    return std::abs(xOf(v, axis) - p) <= halfOf(v, axis);
  }
};

/// ellipsoids  by mesh vertex, or empty: then every half-width is eps
Slabs makeSlabs(std::span<const Vec3> positions, std::span<const std::uint32_t> in_use,
                std::span<const PlaneFrame> planes, double eps, std::span<const Sym3> ellipsoids);

/// For each vertex, how many others the planes through it cut, a vertex that several planes cut counting each time.
/// O(n log n).
std::vector<std::uint32_t> sumKeys(const Slabs& slabs);
/// The same, every vertex counting once. O(n log n + hits), in runs over contiguous memory.
std::vector<std::uint32_t> unionKeys(const Slabs& slabs);

/// Vertex numbers by descending key, ties by ascending number. O(n).
std::vector<std::uint32_t> byDescendingKey(std::span<const std::uint32_t> keys);

}  // namespace sheaf::grouping
