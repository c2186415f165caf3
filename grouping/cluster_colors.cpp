#include "grouping/cluster_colors.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <queue>
#include <tuple>
#include <utility>

#include "grouping/dual_graph.h"

namespace sheaf::grouping {
namespace {

/// For each part the parts that share an edge with it, ascending.
struct Neighbors {
  std::vector<std::uint32_t> first;  ///< #P + 1, into others
  std::vector<std::uint32_t> others;

  std::span<const std::uint32_t> of(std::uint32_t part) const {
    return std::span(others).subspan(first[part], first[part + 1] - first[part]);
  }
};

Neighbors findNeighbors(const mesh::Mesh& mesh, std::span<const std::uint32_t> part_of_face, std::size_t part_count) {
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (const DualEdge& edge : buildDualGraph(mesh, modelFrameOf(mesh)).edges) {
    const std::uint32_t a = part_of_face[edge.face[0]], b = part_of_face[edge.face[1]];
    if (a == b || a == kNoIndex || b == kNoIndex) continue;
    pairs.push_back({a, b});
    pairs.push_back({b, a});
  }
  std::ranges::sort(pairs);
  pairs.erase(std::ranges::unique(pairs).begin(), pairs.end());
  Neighbors neighbors;
  neighbors.first.assign(part_count + 1, 0);
  for (const auto& [part, other] : pairs) {
    ++neighbors.first[part + 1];
    neighbors.others.push_back(other);
  }
  for (std::size_t p = 0; p < part_count; ++p) neighbors.first[p + 1] += neighbors.first[p];
  return neighbors;
}

/// Takes away, again and again, the part with the fewest neighbours left; the last to go comes first.
std::vector<std::uint32_t> smallestLast(const Neighbors& neighbors) {
  const auto count = static_cast<std::uint32_t>(neighbors.first.size() - 1);
  std::vector<std::uint32_t> degree(count), order;
  std::vector<bool> is_gone(count, false);
  using Entry = std::pair<std::uint32_t, std::uint32_t>;  // degree, part; stale where the degree has sunk since
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
  for (std::uint32_t p = 0; p < count; ++p) {
    degree[p] = static_cast<std::uint32_t>(neighbors.of(p).size());
    waiting.emplace(degree[p], p);
  }
  while (!waiting.empty()) {
    const std::uint32_t part = waiting.top().second;
    waiting.pop();
    if (is_gone[part]) continue;
    is_gone[part] = true;
    order.push_back(part);
    for (const std::uint32_t other : neighbors.of(part))
      if (!is_gone[other]) waiting.emplace(--degree[other], other);
  }
  std::ranges::reverse(order);
  return order;
}

}  // namespace

std::vector<std::uint32_t> colorParts(const mesh::Mesh& mesh, std::span<const std::uint32_t> part_of_face,
                                      std::uint32_t part_count, std::uint32_t color_count) {
  assert(color_count > 0 && part_of_face.size() == mesh.triangleCount());
  const Neighbors neighbors = findNeighbors(mesh, part_of_face, part_count);
  std::vector<std::uint32_t> color(part_count, kNoIndex);
  std::vector<std::uint32_t> used(color_count, 0);
  std::vector<std::uint32_t> near(color_count);
  for (const std::uint32_t part : smallestLast(neighbors)) {
    std::ranges::fill(near, 0);
    for (const std::uint32_t other : neighbors.of(part))
      if (color[other] != kNoIndex) ++near[color[other]];
    std::uint32_t best = 0;
    for (std::uint32_t c = 1; c < color_count; ++c)
      if (std::tie(near[c], used[c]) < std::tie(near[best], used[best])) best = c;
    color[part] = best;
    ++used[best];
  }
  return color;
}

std::vector<std::uint32_t> colorClusters(const mesh::Mesh& mesh, const FaceClusters& clusters,
                                         std::span<const std::uint32_t> cut, std::uint32_t color_count) {
  return colorParts(mesh, clusterOfFace(clusters, cut), static_cast<std::uint32_t>(cut.size()), color_count);
}

}  // namespace sheaf::grouping
