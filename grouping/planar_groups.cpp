#include "grouping/planar_groups.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <queue>

#include "core/stage_timer.h"
#include "grouping/group_assembly.h"
#include "grouping/group_quality.h"
#include "grouping/slab_queries.h"
#include "grouping/slabs.h"

namespace sheaf::grouping {
namespace {

// The greedy pass. Seeds are numbered origin by origin, axis_count to each, whether used or not.
template <class Query>
class Greedy {
 public:
  Greedy(const Slabs& slabs, std::span<const std::uint32_t> in_use, std::size_t mesh_vertex_count)
      : slabs_(slabs), in_use_(in_use), query_(slabs), live_(slabs.vertex_count, 1) {
    findings_.owner.assign(mesh_vertex_count, kNoIndex);
  }

  // A vertex is live while it is free: it can be taken, and its planes can be used.
  bool isLive(std::uint32_t v) const { return live_[v] != 0; }

  void use(std::uint32_t origin) {
    const std::uint32_t first_seed = static_cast<std::uint32_t>(findings_.seeds.size());
    bool taken = false;
    for (std::uint32_t axis = 0; axis < slabs_.axis_count; ++axis)
      query_.collect(
          axis, slabs_.xOf(origin, axis), [&](std::uint32_t v) { return isLive(v); },
          [&](std::uint32_t v) {
            if (v == origin) return;
            live_[v] = 0;
            findings_.owner[in_use_[v]] = first_seed + nearestAxis(v, origin);
            taken = true;
          });
    if (!taken) return;  // it takes nothing and stays free
    live_[origin] = 0;
    for (std::uint32_t axis = 0; axis < slabs_.axis_count; ++axis)
      findings_.seeds.push_back({in_use_[origin], kNoIndex, axis});
  }

  // Live vertices, beside itself, that the planes of a vertex cut.
  std::uint32_t countLive(std::uint32_t origin) {
    std::uint32_t count = 0;
    for (std::uint32_t axis = 0; axis < slabs_.axis_count; ++axis)
      query_.collect(
          axis, slabs_.xOf(origin, axis), [&](std::uint32_t v) { return isLive(v); },
          [&](std::uint32_t v) { count += v != origin && firstAxis(v, origin) == axis; });
    return count;
  }

  Findings finish() { return std::move(findings_); }

 private:
  // Relative to the slab's width, so that it is the plane of least error for either metric.
  std::uint32_t nearestAxis(std::uint32_t v, std::uint32_t origin) const {
    std::uint32_t best = 0;
    float least = std::numeric_limits<float>::infinity();
    for (std::uint32_t axis = 0; axis < slabs_.axis_count; ++axis) {
      const float d = std::abs(slabs_.xOf(v, axis) - slabs_.xOf(origin, axis));
      if (!(d <= slabs_.halfOf(v, axis))) continue;
      const float share = slabs_.half.empty() || d == 0.0F ? d : d / slabs_.halfOf(v, axis);
      if (share < least) least = share, best = axis;
    }
    return best;
  }

  std::uint32_t firstAxis(std::uint32_t v, std::uint32_t origin) const {
    std::uint32_t axis = 0;
    while (!slabs_.isCut(v, axis, slabs_.xOf(origin, axis))) ++axis;
    return axis;
  }

  const Slabs& slabs_;
  std::span<const std::uint32_t> in_use_;
  Query query_;
  std::vector<std::uint8_t> live_;
  Findings findings_;
};

// The entry with the most free vertices next, found with a heap of outdated keys: keys only fall, so an entry whose key
// proves up to date when it comes to the top is the best.
template <class Query>
void useDynamically(Greedy<Query>& greedy, std::span<const std::uint32_t> keys) {
  struct Entry {
    std::uint32_t key;
    std::uint32_t vertex;
    bool operator<(const Entry& other) const { return key != other.key ? key < other.key : vertex > other.vertex; }
  };
  std::vector<Entry> entries;
  for (std::uint32_t v = 0; v < keys.size(); ++v) entries.push_back({keys[v], v});
  std::priority_queue<Entry> queue(std::less<Entry>(), std::move(entries));
  while (!queue.empty()) {
    const Entry top = queue.top();
    queue.pop();
    if (!greedy.isLive(top.vertex)) continue;
    const std::uint32_t key = greedy.countLive(top.vertex);
    if (key == 0) continue;
    if (key == top.key)
      greedy.use(top.vertex);
    else
      queue.push({key, top.vertex});
  }
}

template <class Query>
Findings search(const Slabs& slabs, std::span<const std::uint32_t> in_use, std::size_t mesh_vertex_count,
                TableKey key) {
  if (key == TableKey::kAuto) key = slabs.vertex_count <= kAutoUnionVertices ? TableKey::kUnion : TableKey::kSum;
  const std::vector<std::uint32_t> keys = key == TableKey::kSum ? sumKeys(slabs) : unionKeys(slabs);
  if (key == TableKey::kDynamic) {
    Greedy<Query> greedy(slabs, in_use, mesh_vertex_count);
    useDynamically(greedy, keys);
    return greedy.finish();
  }
  // Sorting the table is where most memory is in use: the search is set up after it.
  const std::vector<std::uint32_t> table = byDescendingKey(keys);
  Greedy<Query> greedy(slabs, in_use, mesh_vertex_count);
  for (const std::uint32_t v : table) {
    if (keys[v] == 0) break;  // the rest takes nothing
    if (greedy.isLive(v)) greedy.use(v);
  }
  return greedy.finish();
}

}  // namespace

VertexGroups groupPlanar(const mesh::Mesh& mesh, const PlanarOptions& options) {
  assert(options.epsilon >= 0.0 && options.epsilon <= kMaxEpsilon);
  assert(!options.planes.empty());
  mesh::assertValid(mesh);
  const std::int64_t start_ns = nowNs();
  const std::vector<std::uint32_t> in_use = verticesInUse(mesh.positions, mesh.triangles);

  VertexGroups out;
  out.kind = GroupKind::kPlane;
  out.planes = options.planes;
  out.epsilon = options.epsilon;
  out.extent = options.extent > 0.0 ? options.extent : extentOf(mesh.positions, in_use);
  chooseMetric(mesh, options.metric, options.limit, out);
  const double eps = out.epsilon * out.extent;
  const bool quadric = out.metric == Metric::kQuadric;
  const std::vector<Sym3> ellipsoids = quadric ? vertexEllipsoids(mesh, eps, out.limit) : std::vector<Sym3>{};

  Findings findings;
  {
    const Slabs slabs = makeSlabs(mesh.positions, in_use, out.planes, eps, ellipsoids);
    findings = quadric ? search<TreeQuery>(slabs, in_use, mesh.vertexCount(), options.key)
                       : search<RunQuery>(slabs, in_use, mesh.vertexCount(), options.key);
  }
  assembleGroups(mesh.positions, in_use, std::move(findings), Placement(ellipsoids), out);
  finishGroups(mesh, options.restore_flipped, start_ns, out);
  return out;
}

}  // namespace sheaf::grouping
