// grouping/face_clusters: hierarchical face clustering [HFC]: neighbouring faces are joined, cheapest first, into ever
// larger clusters that are flat, face one way and are round.
//   In     mesh::Mesh, manifold or not, object space. Faces without area or with corners that are not finite do no harm
//   Out    a forest: nodes [0, #F) are the faces, node #F + i is what merge i made of two older nodes. One root per
//          connected piece of the mesh; a face with a corner that is not finite is a root of its own
//   Keeps  deterministic, the same for any number of threads; moving, turning and scaling the mesh changes it only
//   where
//          costs tie to the last bits of a float
//   Cost   O(F log F); at most 250 bytes per face beside the mesh while it runs
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/task_pool.h"
#include "grouping/cluster_cost.h"
#include "grouping/cluster_shapes.h"
#include "grouping/dual_graph.h"
#include "grouping/patches.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

struct ClusterOptions {
  CostWeights weights;
  /// Clusters with at least so many faces get a shape; at least 2. Smaller ones are many and can be had from shapeOf().
  /// So can those above 512 faces that have hardly grown since the last one below them that has a shape.
  std::uint32_t min_shape_faces = 8;
};

/// #F faces, #R roots, #F - #R merges; #N = 2 #F - #R nodes.
struct FaceClusters {
  std::vector<std::uint32_t> faces;                    ///< #F, a permutation: every cluster is a run of it
  std::vector<std::uint32_t> first_face;               ///< #N, where the node's run begins
  std::vector<std::uint32_t> parent;                   ///< #N, kNoIndex of a root
  std::vector<std::array<std::uint32_t, 2>> children;  ///< #F - #R, of node #F + i; both lower than that
  std::vector<std::uint32_t> face_count;               ///< #F - #R, of node #F + i
  std::vector<float> cost;                             ///< #F - #R, of the merge; not always ascending
  std::vector<std::uint32_t> roots;                    ///< #R, ascending
  std::vector<std::uint32_t> shape_index;              ///< #F - #R, into shapes, or kNoIndex
  std::vector<ClusterShape> shapes;                    ///< depth first: a cluster's own, then those of its two parts

  std::uint32_t faceCount() const { return static_cast<std::uint32_t>(faces.size()); }
  std::uint32_t nodeCount() const { return static_cast<std::uint32_t>(parent.size()); }
  bool isFace(std::uint32_t node) const { return node < faces.size(); }
  /// Of a node that is no face.
  const std::array<std::uint32_t, 2>& childrenOf(std::uint32_t node) const { return children[node - faces.size()]; }
  std::uint32_t faceCountOf(std::uint32_t node) const { return isFace(node) ? 1U : face_count[node - faces.size()]; }
  std::span<const std::uint32_t> facesOf(std::uint32_t node) const {
    return std::span(faces).subspan(first_face[node], faceCountOf(node));
  }
  /// nullptr for a face and for a cluster that has no shape stored (ClusterOptions::min_shape_faces).
  const ClusterShape* storedShape(std::uint32_t node) const {
    if (isFace(node)) return nullptr;
    const std::uint32_t index = shape_index[node - faces.size()];
    return index == kNoIndex ? nullptr : &shapes[index];
  }

  bool operator==(const FaceClusters&) const = default;
};

/// Depth first from the roots. visit(node) says whether to go on to the two parts of the node; of a face it has none.
template <typename Visit>
void walkDown(const FaceClusters& clusters, const Visit& visit) {
  std::vector<std::uint32_t> open(clusters.roots.rbegin(), clusters.roots.rend());
  while (!open.empty()) {
    const std::uint32_t node = open.back();
    open.pop_back();
    if (!visit(node) || clusters.isFace(node)) continue;
    const auto [left, right] = clusters.childrenOf(node);
    open.push_back(right);
    open.push_back(left);
  }
}

/// Asserts that indices are in range, weights finite and faces fewer than 2^30.
FaceClusters clusterFaces(const mesh::Mesh& mesh, const ClusterOptions& options, TaskPool& pool);
/// The same where these are known.
/// frame  modelFrameOf(mesh)
/// graph  buildDualGraph(mesh, frame)
FaceClusters clusterFaces(const mesh::Mesh& mesh, const ModelFrame& frame, DualGraph graph,
                          const ClusterOptions& options, TaskPool& pool);

/// The tree that follows from its merges, without shapes. `children` must have passed findBrokenMerge().
FaceClusters hierarchyOf(std::uint32_t face_count, std::vector<std::array<std::uint32_t, 2>> children,
                         std::vector<float> cost);

/// A merge must join two nodes that are lower than the one it makes and have no other parent. Says which does not, or
/// returns an empty string.
std::string findBrokenMerge(std::uint32_t face_count, std::span<const std::array<std::uint32_t, 2>> children);

/// The stored shape of any node, or the same made of its faces.
ClusterShape shapeOf(const mesh::Mesh& mesh, const FaceClusters& clusters, std::uint32_t node);

/// Checks every promise above that needs no mesh. Returns the first broken one in words, or an empty string.
std::string findInconsistency(const FaceClusters& clusters);

}  // namespace sheaf::grouping
