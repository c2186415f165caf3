#include "grouping/face_clusters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "grouping/face_contraction.h"
#include "grouping/shape_tree.h"

namespace sheaf::grouping {

FaceClusters hierarchyOf(std::uint32_t face_count, std::vector<std::array<std::uint32_t, 2>> children,
                         std::vector<float> cost) {
  FaceClusters out;
  out.children = std::move(children);
  out.cost = std::move(cost);
  const auto merges = static_cast<std::uint32_t>(out.children.size());
  out.faces.resize(face_count);
  out.parent.assign(face_count + merges, kNoIndex);
  out.face_count.resize(merges);
  for (std::uint32_t i = 0; i < merges; ++i) {
    const auto [left, right] = out.children[i];
    out.parent[left] = out.parent[right] = face_count + i;
    out.face_count[i] = out.faceCountOf(left) + out.faceCountOf(right);
  }
  out.first_face.resize(out.parent.size());
  std::uint32_t first = 0;
  for (std::uint32_t node = 0; node < out.nodeCount(); ++node) {
    if (out.parent[node] != kNoIndex) continue;
    out.roots.push_back(node);
    out.first_face[node] = first;
    first += out.faceCountOf(node);
  }
  for (std::uint32_t i = merges; i-- > 0;) {  // parents are higher than their parts
    const auto [left, right] = out.children[i];
    out.first_face[left] = out.first_face[face_count + i];
    out.first_face[right] = out.first_face[left] + out.faceCountOf(left);
  }
  for (std::uint32_t f = 0; f < face_count; ++f) out.faces[out.first_face[f]] = f;
  return out;
}

FaceClusters clusterFaces(const mesh::Mesh& mesh, const ClusterOptions& options, TaskPool& pool) {
  const ModelFrame frame = modelFrameOf(mesh);
  return clusterFaces(mesh, frame, buildDualGraph(mesh, frame), options, pool);
}

FaceClusters clusterFaces(const mesh::Mesh& mesh, const ModelFrame& frame, DualGraph graph,
                          const ClusterOptions& options, TaskPool& pool) {
  assert(std::isfinite(options.weights.fit) && std::isfinite(options.weights.direction) &&
         std::isfinite(options.weights.shape) && std::isfinite(options.weights.balance));
  const std::vector<bool> turned = findTurnedFaces(graph);
  MergeTree tree = contractFaces(mesh, frame, std::move(graph), turned, options.weights, pool);
  FaceClusters clusters =
      hierarchyOf(static_cast<std::uint32_t>(mesh.triangleCount()), std::move(tree.children), std::move(tree.cost));
  addShapes(mesh, options.min_shape_faces, pool, clusters);
  return clusters;
}

std::string findBrokenMerge(std::uint32_t face_count, std::span<const std::array<std::uint32_t, 2>> children) {
  std::vector<bool> has_parent(face_count + children.size(), false);
  for (std::size_t i = 0; i < children.size(); ++i)
    for (const std::uint32_t child : children[i]) {
      if (child >= face_count + i) return fmt::format("merge {} takes node {} of {}", i, child, face_count + i);
      if (has_parent[child]) return fmt::format("node {} is merged twice", child);
      has_parent[child] = true;
    }
  return "";
}

ClusterShape shapeOf(const mesh::Mesh& mesh, const FaceClusters& clusters, std::uint32_t node) {
  if (const ClusterShape* shape = clusters.storedShape(node)) return *shape;
  return shapeOfFaces(mesh, clusters.facesOf(node));
}

std::string findInconsistency(const FaceClusters& clusters) {
  const std::uint32_t faces = clusters.faceCount();
  if (const std::string reason = findBrokenMerge(faces, clusters.children); !reason.empty()) return reason;
  if (clusters.cost.size() != clusters.children.size()) return "not one cost per merge";
  FaceClusters expected = hierarchyOf(faces, clusters.children, clusters.cost);
  if (clusters.shape_index.size() != clusters.children.size()) return "not one shape number per merge";
  expected.shape_index = clusters.shape_index;
  expected.shapes = clusters.shapes;
  if (clusters != expected) return "the tree is not the one that follows from its merges";
  std::uint32_t shapes = 0;
  std::string reason;
  walkDown(clusters, [&](std::uint32_t node) {
    const ClusterShape* shape = clusters.storedShape(node);
    if (shape == nullptr || !reason.empty()) return reason.empty();
    if (clusters.shape_index[node - faces] != shapes++)
      reason = fmt::format("node {}: its shape is out of order", node);
    else if (!isSound(*shape))
      reason = fmt::format("node {}: its shape is not possible", node);
    return true;
  });
  if (!reason.empty()) return reason;
  return shapes == clusters.shapes.size() ? "" : "more shapes than clusters that have one";
}

}  // namespace sheaf::grouping
