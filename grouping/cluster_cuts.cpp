#include "grouping/cluster_cuts.h"

#include <algorithm>
#include <cmath>

#include "grouping/shape_tree.h"

namespace sheaf::grouping {
namespace {

/// Of all merges within each node that is no face.
std::vector<float> worstCosts(const FaceClusters& clusters) {
  const std::uint32_t faces = clusters.faceCount();
  std::vector<float> worst = clusters.cost;
  for (std::size_t i = 0; i < worst.size(); ++i)
    for (const std::uint32_t child : clusters.children[i])
      if (child >= faces) worst[i] = std::max(worst[i], worst[child - faces]);
  return worst;
}

}  // namespace

ClusterCut cutByCount(const FaceClusters& clusters, std::uint32_t count) {
  const std::uint32_t faces = clusters.faceCount();
  const std::uint32_t made = faces - std::min(faces, count);  // merges that would have happened
  return cutWhere(clusters, [&](std::uint32_t node) { return node < faces + made; });
}

ClusterCut cutByCost(const FaceClusters& clusters, double max_cost) {
  const std::uint32_t faces = clusters.faceCount();
  const std::vector<float> worst = worstCosts(clusters);
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

std::vector<std::uint32_t> clusterOfFace(const FaceClusters& clusters, std::span<const std::uint32_t> cut) {
  std::vector<std::uint32_t> cluster_of_face(clusters.faceCount(), kNoIndex);
  for (std::uint32_t c = 0; c < cut.size(); ++c)
    for (const std::uint32_t f : clusters.facesOf(cut[c])) cluster_of_face[f] = c;
  return cluster_of_face;
}

CutFigures figuresOf(const mesh::Mesh& mesh, const FaceClusters& clusters, std::span<const std::uint32_t> cut) {
  CutFigures figures;
  if (cut.empty()) return figures;
  const std::uint32_t faces = clusters.faceCount();
  const std::vector<float> worst = worstCosts(clusters);
  std::vector<std::uint32_t> sizes;
  double squares = 0.0;
  double max_cost = -std::numeric_limits<double>::infinity();
  for (const std::uint32_t node : cut) {
    sizes.push_back(clusters.faceCountOf(node));
    if (clusters.isFace(node)) continue;  // flat, and not joined
    max_cost = std::max(max_cost, double{worst[node - faces]});
    const ClusterShape shape = shapeOf(mesh, clusters, node);
    figures.max_distance = std::max(figures.max_distance, double{shape.maxDistance()});
    squares += double{shape.rms_distance} * double{shape.rms_distance} * sizes.back();
  }
  std::ranges::sort(sizes);
  figures.clusters = static_cast<std::uint32_t>(sizes.size());
  figures.least_faces = sizes.front();
  figures.median_faces = sizes[sizes.size() / 2];
  figures.most_faces = sizes.back();
  if (cut.size() < faces) figures.max_cost = max_cost;
  figures.rms_distance = std::sqrt(squares / faces);
  return figures;
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
