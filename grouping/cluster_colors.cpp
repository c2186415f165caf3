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

/// For each cluster the clusters that share an edge with it, ascending.
struct Neighbors {
  std::vector<std::uint32_t> first;  ///< #C + 1, into others
  std::vector<std::uint32_t> others;

  std::span<const std::uint32_t> of(std::uint32_t cluster) const {
    return std::span(others).subspan(first[cluster], first[cluster + 1] - first[cluster]);
  }
};

Neighbors findNeighbors(const mesh::Mesh& mesh, const std::vector<std::uint32_t>& cluster_of_face,
                        std::size_t cluster_count) {
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (const DualEdge& edge : buildDualGraph(mesh, modelFrameOf(mesh)).edges) {
    const std::uint32_t a = cluster_of_face[edge.face[0]], b = cluster_of_face[edge.face[1]];
    if (a == b) continue;
    pairs.push_back({a, b});
    pairs.push_back({b, a});
  }
  std::ranges::sort(pairs);
  pairs.erase(std::ranges::unique(pairs).begin(), pairs.end());
  Neighbors neighbors;
  neighbors.first.assign(cluster_count + 1, 0);
  for (const auto& [cluster, other] : pairs) {
    ++neighbors.first[cluster + 1];
    neighbors.others.push_back(other);
  }
  for (std::size_t c = 0; c < cluster_count; ++c) neighbors.first[c + 1] += neighbors.first[c];
  return neighbors;
}

/// Takes away, again and again, the cluster with the fewest neighbours left; the last to go comes first.
std::vector<std::uint32_t> smallestLast(const Neighbors& neighbors) {
  const auto count = static_cast<std::uint32_t>(neighbors.first.size() - 1);
  std::vector<std::uint32_t> degree(count), order;
  std::vector<bool> is_gone(count, false);
  using Entry = std::pair<std::uint32_t, std::uint32_t>;  // degree, cluster; stale where the degree has sunk since
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
  for (std::uint32_t c = 0; c < count; ++c) {
    degree[c] = static_cast<std::uint32_t>(neighbors.of(c).size());
    waiting.emplace(degree[c], c);
  }
  while (!waiting.empty()) {
    const std::uint32_t cluster = waiting.top().second;
    waiting.pop();
    if (is_gone[cluster]) continue;
    is_gone[cluster] = true;
    order.push_back(cluster);
    for (const std::uint32_t other : neighbors.of(cluster))
      if (!is_gone[other]) waiting.emplace(--degree[other], other);
  }
  std::ranges::reverse(order);
  return order;
}

}  // namespace

std::vector<std::uint32_t> colorClusters(const mesh::Mesh& mesh, const FaceClusters& clusters,
                                         std::span<const std::uint32_t> cut, std::uint32_t color_count) {
  assert(color_count > 0);
  const Neighbors neighbors = findNeighbors(mesh, clusterOfFace(clusters, cut), cut.size());
  std::vector<std::uint32_t> color(cut.size(), kNoIndex);
  std::vector<std::uint32_t> used(color_count, 0);
  std::vector<std::uint32_t> near(color_count);
  for (const std::uint32_t cluster : smallestLast(neighbors)) {
    std::ranges::fill(near, 0);
    for (const std::uint32_t other : neighbors.of(cluster))
      if (color[other] != kNoIndex) ++near[color[other]];
    std::uint32_t best = 0;
    for (std::uint32_t c = 1; c < color_count; ++c)
      if (std::tie(near[c], used[c]) < std::tie(near[best], used[best])) best = c;
    color[cluster] = best;
    ++used[best];
  }
  return color;
}

}  // namespace sheaf::grouping
