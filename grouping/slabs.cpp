#include "grouping/slabs.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

namespace sheaf::grouping {
namespace {

struct SortItem {
  std::uint32_t key;
  std::uint32_t value;
};

// Stable, ascending by key: three passes of 11 bits. About ten times as fast as std::sort on a million items, and
// sorting is most of the work of planar grouping.
void radixSort(std::vector<SortItem>& items) {
  constexpr std::uint32_t kBits = 11, kBuckets = 1U << kBits, kMask = kBuckets - 1;
  std::array<std::array<std::uint32_t, kBuckets>, 3> count{};
  for (const SortItem& item : items)
    for (std::uint32_t pass = 0; pass < 3; ++pass) ++count[pass][(item.key >> (kBits * pass)) & kMask];
  std::vector<SortItem> other(items.size());
  for (std::uint32_t pass = 0; pass < 3; ++pass) {
    auto& next = count[pass];
    if (std::find(next.begin(), next.end(), items.size()) != next.end()) continue;  // all have the same digit
    std::uint32_t sum = 0;
    for (std::uint32_t& c : next) c = std::exchange(sum, sum + c);
    for (const SortItem& item : items) other[next[(item.key >> (kBits * pass)) & kMask]++] = item;
    items.swap(other);
  }
}

// Order of the keys is the order of the numbers.
std::uint32_t sortableBits(float f) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(f);
  return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}

float numberOfBits(std::uint32_t sortable) {
  return std::bit_cast<float>((sortable & 0x80000000U) != 0 ? sortable & 0x7FFFFFFFU : ~sortable);
}

SlabOrder orderAlong(const Slabs& slabs, std::uint32_t axis) {
  std::vector<SortItem> items(slabs.vertex_count);
  for (std::uint32_t v = 0; v < slabs.vertex_count; ++v) items[v] = {sortableBits(slabs.xOf(v, axis)), v};
  radixSort(items);
  SlabOrder order;
  order.vertex.resize(items.size());
  order.x.resize(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    order.vertex[i] = items[i].value;
    order.x[i] = numberOfBits(items[i].key);
  }
  if (slabs.half.empty()) return order;
  order.half.resize(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) order.half[i] = slabs.halfOf(items[i].value, axis);
  return order;
}

// First i in [0, n] from which `holds` is true; it is false before. Looks around `hint` first, in growing steps.
template <class Predicate>
std::uint32_t gallop(std::uint32_t n, std::uint32_t hint, const Predicate& holds) {
  std::uint32_t lo = 0, hi = n;  // false before lo, true from hi on
  std::uint32_t step = 1;
  if (hint < n && !holds(hint)) {
    lo = hint + 1;
    while (n - lo > step && !holds(lo + step)) lo += step + 1, step *= 2;
    hi = n - lo > step ? lo + step : n;
  } else {
    hi = hint;
    while (hi > step && holds(hi - step)) hi -= step, step *= 2;
    lo = hi > step ? hi - step + 1 : 0;
  }
  while (lo < hi) {
    const std::uint32_t middle = lo + (hi - lo) / 2;
    if (holds(middle))
      hi = middle;
    else
      lo = middle + 1;
  }
  return lo;
}

// Where in sorted numbers to start looking for one: as many equal bins as numbers. Right to a few places unless the
// numbers are bunched together.
class Bins {
 public:
  explicit Bins(std::span<const float> x) : first_(x.size() + 1) {
    if (x.empty()) return;
    least_ = x.front();
    const double range = double(x.back()) - double(x.front());
    per_unit_ = range > 0.0 ? double(x.size()) / range : 0.0;
    for (const float f : x) ++first_[std::min(x.size() - 1, binOf(f)) + 1];
    for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
  }
  std::uint32_t placeOf(float x) const { return first_[binOf(x)]; }

 private:
  std::size_t binOf(float x) const {
    const double bin = (double(x) - least_) * per_unit_;
    return static_cast<std::size_t>(std::clamp(bin, 0.0, double(first_.size() - 1)));
  }

  std::vector<std::uint32_t> first_;
  double least_ = 0.0, per_unit_ = 0.0;
};

// body(i, begin, end) for the slab of each i-th vertex of the order: the vertices in [begin, end) lie in it, among them
// its own.
template <class Body>
void forEachSlab(const SlabOrder& order, float common_half, const Body& body) {
  const std::uint32_t n = static_cast<std::uint32_t>(order.x.size());
  const bool alike = order.half.empty();
  const Bins bins(alike ? std::span<const float>() : order.x);
  const float* x = order.x.data();
  std::uint32_t begin = 0, end = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    const float p = x[i], half = alike ? common_half : order.half[i];
    // Slabs of one width move on with their vertices, so that the last range is a near guess.
    if (!alike) begin = bins.placeOf(p - half), end = bins.placeOf(p + half);
    begin = gallop(n, begin, [&](std::uint32_t j) { return x[j] >= p || p - x[j] <= half; });
    end = gallop(n, end, [&](std::uint32_t j) { return x[j] > p && x[j] - p > half; });
    body(i, begin, end);
  }
}

// For each vertex of the order, how many slabs it lies in.
std::vector<std::uint32_t> countCovering(const SlabOrder& order, float common_half) {
  std::vector<std::uint32_t> count(order.x.size() + 1, 0);  // first the changes of the count, from place to place
  forEachSlab(order, common_half, [&](std::uint32_t, std::uint32_t begin, std::uint32_t end) {
    ++count[begin];
    --count[end];
  });
  for (std::size_t i = 1; i < count.size(); ++i) count[i] += count[i - 1];
  return count;
}

// For the vertices of an order: their projections on the axes before this one.
std::vector<std::vector<float>> earlierProjections(const Slabs& slabs, std::uint32_t axis) {
  std::vector<std::vector<float>> earlier(axis, std::vector<float>(slabs.vertex_count));
  const SlabOrder& order = slabs.axes[axis];
  for (std::uint32_t a = 0; a < axis; ++a)
    for (std::uint32_t i = 0; i < slabs.vertex_count; ++i) earlier[a][i] = slabs.xOf(order.vertex[i], a);
  return earlier;
}

// For each vertex of the order of `axis` > 0, how many slabs it lies in that it does not lie in along an earlier axis.
// Plain runs over floats, which compilers turn into vector code.
std::vector<std::uint32_t> countNewlyCovering(const Slabs& slabs, std::uint32_t axis) {
  const SlabOrder& order = slabs.axes[axis];
  const std::vector<std::vector<float>> earlier = earlierProjections(slabs, axis);
  std::vector<std::uint32_t> counts(slabs.vertex_count, 0), known_before(slabs.vertex_count, 0);
  std::uint32_t* const count = counts.data();
  std::uint32_t* const known = known_before.data();
  forEachSlab(order, slabs.common_half, [&](std::uint32_t i, std::uint32_t begin, std::uint32_t end) {
    const std::uint32_t v = order.vertex[i];
    for (std::uint32_t a = 0; a < axis; ++a) {
      const float x = slabs.xOf(v, a), half = slabs.halfOf(v, a);
      const float* other = earlier[a].data();
      const std::uint32_t keep = a == 0 ? 0U : ~0U;  // the first overwrites what the last slab has left
      if (a + 1 < axis)
        for (std::uint32_t j = begin; j < end; ++j)
          known[j] = (known[j] & keep) | (std::abs(x - other[j]) <= half ? 1U : 0U);
      else
        for (std::uint32_t j = begin; j < end; ++j)
          count[j] += 1U - ((known[j] & keep) | (std::abs(x - other[j]) <= half ? 1U : 0U));
    }
  });
  return counts;
}

}  // namespace

Slabs makeSlabs(std::span<const Vec3> positions, std::span<const std::uint32_t> in_use,
                std::span<const PlaneFrame> planes, double eps, std::span<const Sym3> ellipsoids) {
  Slabs slabs;
  slabs.vertex_count = static_cast<std::uint32_t>(in_use.size());
  slabs.axis_count = static_cast<std::uint32_t>(planes.size());
  slabs.common_half = static_cast<float>(eps);
  slabs.x.reserve(in_use.size() * planes.size());
  if (!ellipsoids.empty()) slabs.half.reserve(in_use.size() * planes.size());
  for (const std::uint32_t v : in_use)
    for (const PlaneFrame& plane : planes) {
      const DVec3 n(plane.normal);
      slabs.x.push_back(static_cast<float>(glm::dot(n, DVec3(positions[v]))));
      if (!ellipsoids.empty())
        slabs.half.push_back(static_cast<float>(std::sqrt(std::max(0.0, glm::dot(n, ellipsoids[v].times(n))))));
    }
  for (std::uint32_t axis = 0; axis < slabs.axis_count; ++axis) slabs.axes.push_back(orderAlong(slabs, axis));
  return slabs;
}

std::vector<std::uint32_t> sumKeys(const Slabs& slabs) {
  std::vector<std::uint32_t> keys(slabs.vertex_count, 0);
  for (const SlabOrder& order : slabs.axes) {
    const std::vector<std::uint32_t> count = countCovering(order, slabs.common_half);
    for (std::uint32_t i = 0; i < slabs.vertex_count; ++i) keys[order.vertex[i]] += count[i] - 1;  // not its own
  }
  return keys;
}

std::vector<std::uint32_t> unionKeys(const Slabs& slabs) {
  std::vector<std::uint32_t> keys(slabs.vertex_count, 0);
  for (std::uint32_t axis = 0; axis < slabs.axis_count; ++axis) {
    const SlabOrder& order = slabs.axes[axis];
    const std::vector<std::uint32_t> count =
        axis == 0 ? countCovering(order, slabs.common_half) : countNewlyCovering(slabs, axis);
    for (std::uint32_t i = 0; i < slabs.vertex_count; ++i) keys[order.vertex[i]] += count[i];
  }
  for (std::uint32_t& key : keys) --key;  // each vertex lies in its own slab
  return keys;
}

std::vector<std::uint32_t> byDescendingKey(std::span<const std::uint32_t> keys) {
  std::vector<SortItem> items(keys.size());
  for (std::uint32_t v = 0; v < keys.size(); ++v) items[v] = {~keys[v], v};
  radixSort(items);
  std::vector<std::uint32_t> order(keys.size());
  for (std::size_t i = 0; i < items.size(); ++i) order[i] = items[i].value;
  return order;
}

}  // namespace sheaf::grouping
