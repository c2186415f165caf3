// grouping/cluster_cuts: a hierarchy of face clusters cut across, into clusters that partition the faces.
//   Out    nodes in the order of their faces (FaceClusters::first_face); together they hold every face once
//   Method each cut takes, on every way down from a root, the first cluster that satisfies; a single face always does
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "grouping/face_clusters.h"

namespace sheaf::grouping {

using ClusterCut = std::vector<std::uint32_t>;

/// satisfies(node) is asked of nodes that are no faces, each at most once and never below one that satisfies.
template <typename Satisfies>
ClusterCut cutWhere(const FaceClusters& clusters, const Satisfies& satisfies) {
  ClusterCut cut;
  walkDown(clusters, [&](std::uint32_t node) {
    const bool is_taken = clusters.isFace(node) || satisfies(node);
    if (is_taken) cut.push_back(node);
    return !is_taken;
  });
  return cut;
}

/// As if joining had stopped at so many clusters: `count`, but no more than there are faces and no fewer than roots.
ClusterCut cutByCount(const FaceClusters& clusters, std::uint32_t count);

/// The largest clusters in which no merge costs more than this.
ClusterCut cutByCost(const FaceClusters& clusters, double max_cost);

enum class Planarity { kMax, kRms };

/// The largest clusters whose corners are this near to the plane of the cluster: all of them, or their root mean
/// square. tolerance  as a fraction of the longest edge of the mesh's box Clusters of more than 512 faces that have no
/// stored shape (one nearly as large, just below, has) are never taken.
ClusterCut cutByPlanarity(const mesh::Mesh& mesh, const FaceClusters& clusters, Planarity measure, double tolerance);

struct SizeLimits {
  std::uint32_t max_faces = std::numeric_limits<std::uint32_t>::max();     ///< at least 1
  std::uint32_t max_vertices = std::numeric_limits<std::uint32_t>::max();  ///< at least 3
};

/// The largest clusters within the limits.
ClusterCut cutBySize(const mesh::Mesh& mesh, const FaceClusters& clusters, const SizeLimits& limits);

/// #F, the place in the cut of the cluster that has the face.
std::vector<std::uint32_t> clusterOfFace(const FaceClusters& clusters, std::span<const std::uint32_t> cut);

/// What a cut is like. All 0 for a mesh without faces.
struct CutFigures {
  std::uint32_t clusters = 0;
  std::uint32_t least_faces = 0;   ///< of a cluster
  std::uint32_t median_faces = 0;  ///< of as many as there are below as above, the larger one
  std::uint32_t most_faces = 0;
  double max_cost = 0.0;      ///< of any merge within the clusters, 0 if there is none
  double max_distance = 0.0;  ///< of a corner to the plane of its cluster, object space
  double rms_distance = 0.0;  ///< of all corners of all faces
};
CutFigures figuresOf(const mesh::Mesh& mesh, const FaceClusters& clusters, std::span<const std::uint32_t> cut);

/// Counts the different vertices of sets of faces of one mesh. Not to be shared between threads.
class VertexCounter {
 public:
  explicit VertexCounter(const mesh::Mesh& mesh) : mesh_(mesh), seen_in_(mesh.vertexCount(), 0) {}

  /// Stops counting beyond `most`; the result is then most + 1.
  std::uint32_t count(std::span<const std::uint32_t> faces, std::uint32_t most);

 private:
  const mesh::Mesh& mesh_;
  std::vector<std::uint32_t> seen_in_;  // #V, the set that has had the vertex last
  std::uint32_t set_ = 0;
};

}  // namespace sheaf::grouping
