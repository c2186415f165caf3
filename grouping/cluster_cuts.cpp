#include "grouping/cluster_cuts.h"

#include <algorithm>

#include "grouping/shape_tree.h"

namespace sheaf::grouping {

ClusterCut cutByCount(const FaceClusters& clusters, std::uint32_t count) {
  const std::uint32_t faces = clusters.faceCount();
  const std::uint32_t made = faces - std::min(faces, count);  // merges that would have happened
  return cutWhere(clusters, [&](std::uint32_t node) { return node < faces + made; });
}

ClusterCut cutByCost(const FaceClusters& clusters, double max_cost) {
  const std::uint32_t faces = clusters.faceCount();
  std::vector<float> worst = clusters.cost;  // of all merges within the node
  for (std::size_t i = 0; i < worst.size(); ++i)
    for (const std::uint32_t child : clusters.children[i])
      if (child >= faces) worst[i] = std::max(worst[i], worst[child - faces]);
  return cutWhere(clusters, [&](std::uint32_t node) { return double{worst[node - faces]} <= max_cost; });
}

ClusterCut cutByPlanarity(const mesh::Mesh& mesh, const FaceClusters& clusters, Planarity measure, double tolerance) {
  const double limit = tolerance * double{mesh::boundsOf(mesh).longestEdge()};
  return cutWhere(clusters, [&](std::uint32_t node) {
    if (clusters.storedShape(node) == nullptr && clusters.faceCountOf(node) > kPieceFaces) return false;
    const ClusterShape shape = shapeOf(mesh, clusters, node);
    return double{measure == Planarity::kMax ? shape.maxDistance() : shape.rms_distance} <= limit;
  });
}

ClusterCut cutBySize(const mesh::Mesh& mesh, const FaceClusters& clusters, const SizeLimits& limits) {
  VertexCounter vertices(mesh);
  return cutWhere(clusters, [&](std::uint32_t node) {
    const std::span<const std::uint32_t> faces = clusters.facesOf(node);
    return faces.size() <= limits.max_faces && vertices.count(faces, limits.max_vertices) <= limits.max_vertices;
  });
}

std::uint32_t VertexCounter::count(std::span<const std::uint32_t> faces, std::uint32_t most) {
  if (++set_ == 0) {
    std::fill(seen_in_.begin(), seen_in_.end(), 0);
    set_ = 1;
  }
  std::uint32_t found = 0;
  for (const std::uint32_t f : faces)
    for (const std::uint32_t v : mesh_.triangles[f]) {
      if (seen_in_[v] == set_) continue;
      seen_in_[v] = set_;
      if (++found > most) return found;
    }
  return found;
}

}  // namespace sheaf::grouping
