#include "grouping/naive_groups.h"

#include <algorithm>
#include <numeric>

#include "core/stage_timer.h"
#include "grouping/group_assembly.h"
#include "grouping/group_quality.h"
#include "grouping/line_test.h"
#include "grouping/slabs.h"

namespace sheaf::grouping {
namespace {

VertexGroups startGroups(const mesh::Mesh& mesh, std::span<const std::uint32_t> in_use, GroupKind kind,
                         double epsilon) {
  VertexGroups out;
  out.kind = kind;
  out.epsilon = epsilon;
  out.extent = extentOf(mesh.positions, in_use);
  return out;
}

class NaivePlanar {
 public:
  NaivePlanar(const Slabs& slabs, std::span<const std::uint32_t> in_use, std::size_t mesh_vertex_count)
      : slabs_(slabs), in_use_(in_use), live_(in_use.size(), true) {
    findings_.owner.assign(mesh_vertex_count, kNoIndex);
  }

  std::uint32_t key(std::uint32_t origin, bool sum, bool live_only) const {
    std::uint32_t key = 0;
    for (std::uint32_t v = 0; v < slabs_.vertex_count; ++v) {
      if (v == origin || (live_only && !live_[v])) continue;
      std::uint32_t cuts = 0;
      for (std::uint32_t a = 0; a < slabs_.axis_count; ++a) cuts += slabs_.isCut(v, a, slabs_.xOf(origin, a));
      key += sum ? cuts : std::min(cuts, 1U);
    }
    return key;
  }

  void use(std::uint32_t origin) {
    const auto first_seed = static_cast<std::uint32_t>(findings_.seeds.size());
    bool taken = false;
    for (std::uint32_t v = 0; v < slabs_.vertex_count; ++v) {
      if (v == origin || !live_[v]) continue;
      const std::uint32_t axis = nearestAxis(v, origin);
      if (axis == kNoIndex) continue;
      live_[v] = false;
      findings_.owner[in_use_[v]] = first_seed + axis;
      taken = true;
    }
    if (!taken) return;
    live_[origin] = false;
    for (std::uint32_t a = 0; a < slabs_.axis_count; ++a) findings_.seeds.push_back({in_use_[origin], kNoIndex, a});
  }

  bool isLive(std::uint32_t v) const { return live_[v]; }
  Findings finish() { return std::move(findings_); }

 private:
  std::uint32_t nearestAxis(std::uint32_t v, std::uint32_t origin) const {
    std::uint32_t best = kNoIndex;
    float least = 0.0F;
    for (std::uint32_t a = 0; a < slabs_.axis_count; ++a) {
      const float p = slabs_.xOf(origin, a);
      if (!slabs_.isCut(v, a, p)) continue;
      float share = std::abs(slabs_.xOf(v, a) - p);
      if (!slabs_.half.empty() && share > 0.0F) share /= slabs_.halfOf(v, a);
      if (best == kNoIndex || share < least) best = a, least = share;
    }
    return best;
  }

  const Slabs& slabs_;
  std::span<const std::uint32_t> in_use_;
  std::vector<bool> live_;
  Findings findings_;
};

void useInTableOrder(NaivePlanar& naive, std::uint32_t n, bool sum) {
  std::vector<std::uint32_t> keys(n), table(n);
  for (std::uint32_t v = 0; v < n; ++v) keys[v] = naive.key(v, sum, false);
  std::iota(table.begin(), table.end(), 0U);
  std::stable_sort(table.begin(), table.end(), [&](std::uint32_t a, std::uint32_t b) { return keys[a] > keys[b]; });
  for (const std::uint32_t v : table)
    if (naive.isLive(v)) naive.use(v);
}

void useBestLeft(NaivePlanar& naive, std::uint32_t n) {
  for (;;) {
    std::uint32_t best = kNoIndex, most = 0;
    for (std::uint32_t v = 0; v < n; ++v) {
      const std::uint32_t key = naive.isLive(v) ? naive.key(v, false, true) : 0;
      if (key > most) most = key, best = v;
    }
    if (best == kNoIndex) return;
    naive.use(best);
  }
}

Findings searchLines(const LineTest& test, std::span<const std::uint32_t> in_use, std::size_t mesh_vertex_count) {
  const auto n = static_cast<std::uint32_t>(in_use.size());
  struct Entry {
    std::uint32_t i, j, count;
  };
  std::vector<Entry> table;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = i + 1; j < n; ++j) {
      if (!test.isLine(i, j)) continue;
      std::uint32_t count = 0;
      for (std::uint32_t p = 0; p < n; ++p) count += p != i && p != j && test.takes(i, j, p);
      if (count > 0) table.push_back({i, j, count});
    }
  std::stable_sort(table.begin(), table.end(), [](const Entry& a, const Entry& b) { return a.count > b.count; });

  Findings findings;
  findings.owner.assign(mesh_vertex_count, kNoIndex);
  std::vector<VertexState> state(n, VertexState::kFree);
  for (const auto& [i, j, count] : table) {
    if (state[i] == VertexState::kGrouped || state[j] == VertexState::kGrouped) continue;
    const auto seed = static_cast<std::uint32_t>(findings.seeds.size());
    bool taken = false;
    for (std::uint32_t p = 0; p < n; ++p) {
      if (p == i || p == j || state[p] != VertexState::kFree || !test.takes(i, j, p)) continue;
      state[p] = VertexState::kGrouped;
      findings.owner[in_use[p]] = seed;
      taken = true;
    }
    if (!taken) continue;
    state[i] = state[j] = VertexState::kDefining;
    findings.seeds.push_back({in_use[i], in_use[j], kNoIndex});
  }
  return findings;
}

}  // namespace

VertexGroups naiveGroupPlanar(const mesh::Mesh& mesh, const PlanarOptions& options) {
  const std::int64_t start_ns = nowNs();
  const std::vector<std::uint32_t> in_use = verticesInUse(mesh.positions, mesh.triangles);
  VertexGroups out = startGroups(mesh, in_use, GroupKind::kPlane, options.epsilon);
  out.planes = options.planes;
  chooseMetric(mesh, options.metric, options.limit, out);
  const double eps = out.epsilon * out.extent;
  std::vector<Sym3> ellipsoids;
  if (out.metric == Metric::kQuadric) ellipsoids = vertexEllipsoids(mesh, eps, out.limit);
  const Slabs slabs = makeSlabs(mesh.positions, in_use, out.planes, eps, ellipsoids);

  NaivePlanar naive(slabs, in_use, mesh.vertexCount());
  const bool sum =
      options.key == TableKey::kSum || (options.key == TableKey::kAuto && slabs.vertex_count > kAutoUnionVertices);
  if (options.key == TableKey::kDynamic)
    useBestLeft(naive, slabs.vertex_count);
  else
    useInTableOrder(naive, slabs.vertex_count, sum);
  assembleGroups(mesh.positions, in_use, naive.finish(), Placement(ellipsoids), out);
  finishGroups(mesh, options.restore_flipped, start_ns, out);
  return out;
}

VertexGroups naiveGroupLinear(const mesh::Mesh& mesh, const LinearOptions& options) {
  const std::int64_t start_ns = nowNs();
  const std::vector<std::uint32_t> in_use = verticesInUse(mesh.positions, mesh.triangles);
  VertexGroups out = startGroups(mesh, in_use, GroupKind::kLine, options.epsilon);
  out.segment_only = options.segment_only;
  out.dimensions = options.dimensions;
  chooseMetric(mesh, options.metric, options.limit, out);
  const double eps = out.epsilon * out.extent;
  std::vector<Sym3> ellipsoids;
  if (out.metric == Metric::kQuadric) ellipsoids = vertexEllipsoids(mesh, eps, out.limit);
  const LineTest test(mesh.positions, in_use, eps, ellipsoids, options.segment_only);
  assembleGroups(mesh.positions, in_use, searchLines(test, in_use, mesh.vertexCount()),
                 Placement(ellipsoids, options.segment_only), out);
  finishGroups(mesh, options.restore_flipped, start_ns, out);
  return out;
}

}  // namespace sheaf::grouping
