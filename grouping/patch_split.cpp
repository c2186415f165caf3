#include "grouping/patch_split.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <span>

namespace sheaf::grouping {
namespace {

using mesh::Mesh;
using mesh::Triangle;

// How much a spread of normals counts against a spread of places. Just below 1 the sheets of a thin part separate as
// soon as a piece holds little else, while the whole of a rounded body is still split by place.
constexpr double kNormalWeight = 0.95;
// A patch of T triangles has about r T + 1.4 sqrt(T) vertices, where r is the whole mesh's ratio: the second term is
// half the border of a roundish patch. Aiming at this share of the limit leaves few patches that must be halved again.
constexpr double kVertexFill = 0.89;
constexpr std::size_t kSpreadSamples = 256, kRankSamples = 1024;
constexpr std::size_t kTrianglesPerPiece = 1 << 16;

// One triangle while the mesh is split. Items are moved, not indices: every pass then reads memory in order.
struct Item {
  std::array<float, 3> centroid;
  std::array<std::int8_t, 3> normal;  // unit length is 127
  std::uint32_t triangle;
};
static_assert(sizeof(Item) == 20);

Item itemOf(const Mesh& mesh, std::uint32_t triangle) {
  const Triangle& t = mesh.triangles[triangle];
  // Thirds first: the sum of three huge coordinates could overflow.
  const Vec3 third(1.0F / 3.0F);
  const Vec3 c = mesh.positions[t[0]] * third + mesh.positions[t[1]] * third + mesh.positions[t[2]] * third;
  const DVec3 n = unitNormalOf(mesh, t) * 127.0;
  Item item{.centroid = {}, .normal = {}, .triangle = triangle};
  if (isFinite(c)) item.centroid = {c.x, c.y, c.z};
  if (std::abs(n.x) < 128.0 && std::abs(n.y) < 128.0 && std::abs(n.z) < 128.0)  // false for NaN
    item.normal = {static_cast<std::int8_t>(n.x), static_cast<std::int8_t>(n.y), static_cast<std::int8_t>(n.z)};
  return item;
}

template <typename Body>
void forEachTriangle(std::size_t count, TaskPool& pool, const Body& body) {
  const std::size_t pieces = (count + kTrianglesPerPiece - 1) / kTrianglesPerPiece;
  pool.parallelFor(static_cast<int>(pieces), [&](int piece, int) {
    const std::size_t begin = static_cast<std::size_t>(piece) * kTrianglesPerPiece;
    for (std::size_t i = begin; i < std::min(count, begin + kTrianglesPerPiece); ++i) body(i);
  });
}

// Order within a split: by coordinate, ties by triangle, so that every rank is well defined. The upper half holds the
// float with its bits turned so that they compare like the number.
std::uint64_t keyOf(float value, std::uint32_t triangle) {
  const auto bits = std::bit_cast<std::uint32_t>(value + 0.0F);  // -0 becomes 0
  const std::uint32_t ordered = bits ^ (bits >> 31 != 0 ? 0xFFFFFFFFU : 0x80000000U);
  return std::uint64_t{ordered} << 32 | triangle;
}

std::uint64_t keyOf(const Item& item, std::size_t axis) {
  return keyOf(item.centroid[axis], item.triangle);
}

// 0-2: coordinates of the centroid, 3-5: of the normal.
struct Spread {
  std::array<double, 6> mean{};
  std::array<double, 6> variance{};
};

// Of an evenly spaced sample.
Spread spreadOf(std::span<const Item> items) {
  const std::size_t step = (items.size() + kSpreadSamples - 1) / kSpreadSamples;
  const std::array<float, 3> origin = items[0].centroid;
  std::array<double, 6> sum{}, squares{};
  double count = 0.0;
  for (std::size_t i = 0; i < items.size(); i += step, count += 1.0) {
    for (std::size_t d = 0; d < 6; ++d) {
      const double x =
          d < 3 ? double{items[i].centroid[d]} - double{origin[d]} : static_cast<double>(items[i].normal[d - 3]);
      sum[d] += x;
      squares[d] += x * x;
    }
  }
  Spread s;
  for (std::size_t d = 0; d < 6; ++d) {
    s.mean[d] = sum[d] / count;  // of the centroid, relative to the first: only the normal's is used
    s.variance[d] = std::max(0.0, squares[d] / count - s.mean[d] * s.mean[d]);
  }
  return s;
}

using Range = PatchRun;  // its vertices are counted when it proves to be within the limits

// Halves ranges of items. The items of a range always stand in the order of their triangles.
class Splitter {
 public:
  Splitter(const Mesh& mesh, const PatchLimits& limits, std::span<Item> items)
      : mesh_(mesh), limits_(limits), items_(items), target_(targetSize(mesh, limits)) {}

  // True if the range is within the limits; then its vertices have been counted.
  bool isPatch(Range& r) {
    const std::span<const Item> part = itemsOf(r);
    if (part.size() > limits_.max_triangles) return false;
    vertices_.clear();
    for (const Item& item : part) {
      for (const std::uint32_t v : mesh_.triangles[item.triangle]) vertices_.numberOf(v);
      if (vertices_.count() > limits_.max_vertices) return false;
    }
    r.vertex_count = vertices_.count();
    return true;
  }

  // Reorders a range of at least two items and returns where its second half begins.
  std::size_t split(const Range& r) {
    const std::span<Item> part = itemsOf(r);
    const Spread spread = spreadOf(part);
    const auto widest = [&](std::size_t from) {
      const auto first = spread.variance.begin() + static_cast<std::ptrdiff_t>(from);
      return static_cast<std::size_t>(std::max_element(first, first + 3) - spread.variance.begin());
    };
    const std::size_t place = widest(0), turn = widest(3);
    const double extent2 = spread.variance[0] + spread.variance[1] + spread.variance[2];
    const double turn2 = spread.variance[turn] * (kNormalWeight * kNormalWeight / (127.0 * 127.0)) * extent2;
    if (turn2 > spread.variance[place]) {
      // Between two sheets there is a gap: a rank would cut beside it.
      const auto is_below = [axis = turn - 3, mean = static_cast<float>(spread.mean[turn])](const Item& item) {
        return static_cast<float>(item.normal[axis]) < mean;
      };
      const auto below = static_cast<std::size_t>(std::count_if(part.begin(), part.end(), is_below));
      const std::size_t least = std::max<std::size_t>(1, part.size() / 8);
      if (below >= least && part.size() - below >= least) return r.begin + partition(part, below, is_below);
    }
    const std::size_t patches = std::max<std::size_t>(2, (part.size() + target_ - 1) / target_);
    const std::size_t rank = part.size() * (patches / 2) / patches;
    const std::uint64_t middle = keyOfRank(part, place, rank);
    return r.begin + partition(part, rank, [=](const Item& item) { return keyOf(item, place) < middle; });
  }

 private:
  static std::size_t targetSize(const Mesh& mesh, const PatchLimits& limits) {
    const double ratio = std::min(3.0, static_cast<double>(mesh.vertexCount()) /
                                           static_cast<double>(std::max<std::size_t>(1, mesh.triangleCount())));
    const double root =
        (std::sqrt(1.96 + 4.0 * ratio * kVertexFill * limits.max_vertices) - 1.4) / std::max(0.1, 2.0 * ratio);
    return std::clamp<std::size_t>(static_cast<std::size_t>(root * root), 1, limits.max_triangles);
  }

  std::span<Item> itemsOf(const Range& r) const { return items_.subspan(r.begin, r.size()); }

  // The key with exactly `rank` keys below it.
  std::uint64_t keyOfRank(std::span<const Item> part, std::size_t axis, std::size_t rank) {
    std::uint64_t low = 0, high = ~std::uint64_t{0};
    if (part.size() > 2 * kRankSamples) bracketRank(part, axis, rank, low, high);
    Gathered keys = gather(part, axis, low, high);
    if (rank < keys.below || rank >= keys.below + keys.count) keys = gather(part, axis, 0, ~std::uint64_t{0});
    std::uint64_t* const nth = keys_.data() + (rank - keys.below);
    std::nth_element(keys_.data(), nth, keys_.data() + keys.count);
    return *nth;
  }

  // Keys that very likely have the rank between them: about one eighth of all, found from a sample.
  void bracketRank(std::span<const Item> part, std::size_t axis, std::size_t rank, std::uint64_t& low,
                   std::uint64_t& high) {
    const std::size_t step = part.size() / kRankSamples;
    std::array<std::uint64_t, kRankSamples> sample;
    for (std::size_t i = 0; i < kRankSamples; ++i) sample[i] = keyOf(part[i * step], axis);
    std::sort(sample.begin(), sample.end());
    const std::size_t at = rank * kRankSamples / part.size(), margin = kRankSamples / 16;
    if (at >= margin) low = sample[at - margin];
    if (at + margin < kRankSamples) high = sample[at + margin];
  }

  struct Gathered {
    std::size_t below = 0;  // keys below the least one collected
    std::size_t count = 0;  // in keys_
  };

  // Collects the keys in [low, high].
  Gathered gather(std::span<const Item> part, std::size_t axis, std::uint64_t low, std::uint64_t high) {
    if (keys_.size() < part.size()) keys_.resize(part.size());
    std::uint64_t* const keys = keys_.data();
    Gathered g;
    for (const Item& item : part) {
      const std::uint64_t key = keyOf(item, axis);
      g.below += key < low ? 1 : 0;
      keys[g.count] = key;
      g.count += key >= low && key <= high ? 1 : 0;
    }
    return g;
  }

  // Stable, without branches: which side comes next cannot be predicted. `count` items are below; returns it.
  template <typename IsBelow>
  std::size_t partition(std::span<Item> part, std::size_t count, const IsBelow& is_below) {
    // One more, because an item is written to both sides before one of them is chosen.
    if (above_.size() < part.size() - count + 1) above_.resize(part.size() - count + 1);
    Item* const low = part.data();
    Item* const high = above_.data();
    std::size_t below = 0;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const Item item = low[i];
      low[below] = item;
      high[i - below] = item;
      below += is_below(item) ? 1 : 0;
    }
    assert(below == count);
    std::copy_n(high, part.size() - count, low + count);
    return count;
  }

  const Mesh& mesh_;
  PatchLimits limits_;
  std::span<Item> items_;
  std::size_t target_;
  LocalVertices vertices_;
  std::vector<std::uint64_t> keys_;
  std::vector<Item> above_;
};

// Subtrees are shared out; what happens to a range does not depend on who does it.
std::vector<PatchRun> splitAll(const Mesh& mesh, const PatchLimits& limits, std::span<Item> items, TaskPool& pool) {
  if (items.empty()) return {};
  std::vector<Splitter> splitters(static_cast<std::size_t>(pool.threadCount()), Splitter(mesh, limits, items));
  struct Subtree {
    Range range;
    bool done = false;
  };
  constexpr std::size_t kSubtrees = 64, kLeastSize = 1 << 14;
  std::vector<Subtree> subtrees{{{0, items.size()}}};
  for (bool grows = true; grows && subtrees.size() < kSubtrees;) {
    std::vector<std::size_t> middle(subtrees.size(), 0);
    pool.parallelFor(static_cast<int>(subtrees.size()), [&](int i, int worker) {
      const Range& r = subtrees[static_cast<std::size_t>(i)].range;
      if (r.size() >= kLeastSize)
        middle[static_cast<std::size_t>(i)] = splitters[static_cast<std::size_t>(worker)].split(r);
    });
    std::vector<Subtree> next;
    for (std::size_t i = 0; i < subtrees.size(); ++i) {
      const Range r = subtrees[i].range;
      if (middle[i] == 0) {
        next.push_back({r});
      } else {
        next.push_back({{r.begin, middle[i]}});
        next.push_back({{middle[i], r.end}});
      }
    }
    grows = next.size() > subtrees.size();
    subtrees = std::move(next);
  }
  std::vector<std::vector<Range>> leaves(subtrees.size());
  pool.parallelFor(static_cast<int>(subtrees.size()), [&](int i, int worker) {
    Splitter& splitter = splitters[static_cast<std::size_t>(worker)];
    std::vector<Range> open{subtrees[static_cast<std::size_t>(i)].range};
    while (!open.empty()) {
      Range r = open.back();
      open.pop_back();
      if (splitter.isPatch(r)) {
        leaves[static_cast<std::size_t>(i)].push_back(r);
      } else {
        const std::size_t middle = splitter.split(r);
        open.push_back({middle, r.end});
        open.push_back({r.begin, middle});
      }
    }
  });
  std::vector<PatchRun> all;
  for (const std::vector<Range>& part : leaves) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace

PatchCut splitByPlace(const Mesh& mesh, std::vector<std::uint32_t> triangles, const PatchLimits& limits,
                      TaskPool& pool) {
  assert(limits.max_vertices >= 3 && limits.max_vertices <= 256);
  assert(limits.max_triangles >= 1 && limits.max_triangles <= 512);
  std::vector<Item> items(triangles.size());
  forEachTriangle(items.size(), pool, [&](std::size_t i) { items[i] = itemOf(mesh, triangles[i]); });
  PatchCut cut;
  cut.runs = splitAll(mesh, limits, items, pool);
  cut.triangles = std::move(triangles);
  forEachTriangle(items.size(), pool, [&](std::size_t i) { cut.triangles[i] = items[i].triangle; });
  return cut;
}

}  // namespace sheaf::grouping
