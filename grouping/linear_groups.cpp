#include "grouping/linear_groups.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/stage_timer.h"
#include "grouping/group_assembly.h"
#include "grouping/group_quality.h"
#include "grouping/line_counts.h"
#include "grouping/line_test.h"

namespace sheaf::grouping {
namespace {

using Cell = std::vector<std::uint32_t>;

// Halves along the longest edge until no cell has more than `max` vertices. Vertices in a cell ascend.
void cutIntoCells(const LineTest& test, Cell vertices, std::size_t max, std::vector<Cell>& cells) {
  if (vertices.size() <= max) {
    std::sort(vertices.begin(), vertices.end());
    cells.push_back(std::move(vertices));
    return;
  }
  DVec3 lo(std::numeric_limits<double>::infinity()), hi(-lo);
  for (const std::uint32_t v : vertices) lo = glm::min(lo, test.position(v)), hi = glm::max(hi, test.position(v));
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (hi[k] - lo[k] > hi[axis] - lo[axis]) axis = k;
  const auto middle = vertices.begin() + static_cast<std::ptrdiff_t>(vertices.size() / 2);
  std::nth_element(vertices.begin(), middle, vertices.end(), [&](std::uint32_t a, std::uint32_t b) {
    const double x = test.position(a)[axis], y = test.position(b)[axis];
    return x != y ? x < y : a < b;
  });
  Cell upper(middle, vertices.end());
  vertices.erase(middle, vertices.end());
  cutIntoCells(test, std::move(vertices), max, cells);
  cutIntoCells(test, std::move(upper), max, cells);
}

struct Pair {
  std::uint16_t i, j;  // into the cell, i < j
};

// Pairs with a count above 0, best first; a counting sort, so that ties stay in the order of the pairs.
std::vector<Pair> tableOf(std::span<const std::uint16_t> counts, std::uint32_t m) {
  std::vector<std::uint32_t> next(std::size_t{m} + 1, 0);
  for (const std::uint16_t c : counts) ++next[c];
  next[0] = 0;
  std::uint32_t total = 0;
  for (std::size_t c = m; c > 0; --c) next[c] = std::exchange(total, total + next[c]);
  std::vector<Pair> table(total);
  std::size_t pair = 0;
  for (std::uint32_t i = 0; i < m; ++i)
    for (std::uint32_t j = i + 1; j < m; ++j, ++pair)
      if (counts[pair] > 0)
        table[next[counts[pair]]++] = {static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j)};
  return table;
}

// Work is counted in pairs of vertices of a cell: half for counting, half for the greedy pass.
class LineSearch {
 public:
  LineSearch(const LineTest& test, std::span<const std::uint32_t> in_use, const LinearOptions& options,
             std::size_t mesh_vertex_count)
      : test_(test), in_use_(in_use), options_(options) {
    findings_.owner.assign(mesh_vertex_count, kNoIndex);
  }

  // Returns false if it was interrupted.
  bool run() {
    Cell all(in_use_.size());
    std::iota(all.begin(), all.end(), 0U);
    std::vector<Cell> cells;
    cutIntoCells(test_, std::move(all), options_.max_cell_vertices, cells);
    double total = 0.0, before = 0.0;
    for (const Cell& cell : cells) total += pairsOf(cell);
    for (const Cell& cell : cells) {
      const double begin = before / total, share = pairsOf(cell) / total;
      if (!searchCell(cell, begin, share)) return false;
      before += pairsOf(cell);
    }
    return report(1.0);
  }

  Findings finish() { return std::move(findings_); }

 private:
  static double pairsOf(const Cell& cell) { return std::max(1.0, 0.5 * double(cell.size()) * double(cell.size())); }
  bool report(double done) const { return !options_.progress || options_.progress(done); }

  bool searchCell(const Cell& cell, double begin, double share) {
    const auto m = static_cast<std::uint32_t>(cell.size());
    const auto counting = [&](std::uint32_t first) {
      if (first % 64 != 0) return true;
      const double left = 1.0 - double(first) / m;
      return report(begin + 0.5 * share * (1.0 - left * left));
    };
    const std::vector<std::uint16_t> counts = countTakenByLines(test_, cell, options_.dimensions == 2, counting);
    if (m < 2) return true;
    if (counts.empty()) return false;
    return takeBestFirst(cell, tableOf(counts, m), begin + 0.5 * share, 0.5 * share);
  }

  bool takeBestFirst(const Cell& cell, const std::vector<Pair>& table, double begin, double share) {
    std::vector<VertexState> state(cell.size(), VertexState::kFree);
    std::vector<std::uint16_t> free(cell.size());
    std::iota(free.begin(), free.end(), std::uint16_t{0});
    for (std::size_t e = 0; e < table.size(); ++e) {
      if (e % 65536 == 65535 && !report(begin + share * double(e) / double(table.size()))) return false;
      const auto [i, j] = table[e];
      if (state[i] == VertexState::kGrouped || state[j] == VertexState::kGrouped) continue;
      if (!takeAlong(cell, i, j, free, state)) continue;
      state[i] = state[j] = VertexState::kDefining;
      std::erase_if(free, [&](std::uint16_t p) { return state[p] != VertexState::kFree; });
    }
    return true;
  }

  bool takeAlong(const Cell& cell, std::uint16_t i, std::uint16_t j, std::span<const std::uint16_t> free,
                 std::vector<VertexState>& state) {
    const DVec3 origin = test_.position(cell[i]), along = test_.position(cell[j]) - origin;
    const auto seed = static_cast<std::uint32_t>(findings_.seeds.size());
    bool taken = false;
    for (const std::uint16_t p : free) {
      if (p == i || p == j || !test_.takes(cell[p], test_.position(cell[p]) - origin, along)) continue;
      state[p] = VertexState::kGrouped;
      findings_.owner[in_use_[cell[p]]] = seed;
      taken = true;
    }
    if (taken) findings_.seeds.push_back({in_use_[cell[i]], in_use_[cell[j]], kNoIndex});
    return taken;
  }

  const LineTest& test_;
  std::span<const std::uint32_t> in_use_;
  const LinearOptions& options_;
  Findings findings_;
};

}  // namespace

VertexGroups groupLinear(const mesh::Mesh& mesh, const LinearOptions& options) {
  assert(options.epsilon >= 0.0 && options.epsilon <= kMaxEpsilon);
  assert(options.max_cell_vertices >= 3 && options.max_cell_vertices <= 65535);
  assert(options.dimensions == 2 || options.dimensions == 3);
  mesh::assertValid(mesh);
  const std::int64_t start_ns = nowNs();
  const std::vector<std::uint32_t> in_use = verticesInUse(mesh.positions, mesh.triangles);

  VertexGroups out;
  out.kind = GroupKind::kLine;
  out.dimensions = options.dimensions;
  out.segment_only = options.segment_only;
  out.epsilon = options.epsilon;
  out.extent = extentOf(mesh.positions, in_use);
  chooseMetric(mesh, options.metric, options.limit, out);
  const double eps = out.epsilon * out.extent;
  const bool quadric = out.metric == Metric::kQuadric;
  const std::vector<Sym3> ellipsoids = quadric ? vertexEllipsoids(mesh, eps, out.limit) : std::vector<Sym3>{};

  const LineTest test(mesh.positions, in_use, eps, ellipsoids, options.segment_only);
  LineSearch search(test, in_use, options, mesh.vertexCount());
  out.interrupted = !search.run();
  assembleGroups(mesh.positions, in_use, search.finish(), Placement(ellipsoids, options.segment_only), out);
  finishGroups(mesh, options.restore_flipped, start_ns, out);
  return out;
}

mesh::Mesh texcoordMesh(const mesh::Mesh& mesh) {
  mesh::Mesh flat;
  for (const Vec2& uv : mesh.texcoords) flat.positions.emplace_back(uv, 0.0F);
  flat.triangles = mesh.triangles;
  return flat;
}

}  // namespace sheaf::grouping
