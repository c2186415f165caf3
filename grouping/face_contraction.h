// grouping/face_contraction: the greedy contraction of a mesh's dual graph [HFC], part by part where the mesh is large.
//   Method the dual graph is cut into compact parts that fit into a core's cache. Each is contracted by itself to a
//          quarter of its clusters, but for edges that lead to other parts. What is left is a dual graph again and is
//          cut along other lines. The last one is contracted as a whole
//   Why    two merges that have no neighbour in common do not depend on each other: which comes first changes nothing.
//          So parts need not take turns, and jumping about in memory is what takes most of the time of a large mesh
#pragma once

#include "core/task_pool.h"
#include "grouping/contraction.h"
#include "grouping/dual_graph.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

struct ContractionPlan {
  /// Up to so many clusters are contracted as a whole: every merge is then the cheapest of all.
  std::size_t most_at_once = std::size_t{1} << 14U;
  /// Clusters per part, its halo not counted; at least 1. Merges that are not made in their turn lie along the borders
  /// of parts.
  std::uint32_t part_size = std::uint32_t{1} << 13U;
};

/// In parts, merges are numbered in the order of their costs, but none before those that make its parts; as a whole, as
/// they were made. The result does not depend on the number of threads.
///
/// frame   modelFrameOf(mesh)
/// graph   buildDualGraph(mesh, frame)
/// turned  #F or empty: faces whose normal counts the other way round
///
/// O(F log F) time. At most 250 bytes per face, in parts of a large mesh about 150.
MergeTree contractFaces(const mesh::Mesh& mesh, const ModelFrame& frame, DualGraph graph,
                        const std::vector<bool>& turned, const CostWeights& weights, TaskPool& pool,
                        const ContractionPlan& plan = {});

}  // namespace sheaf::grouping
