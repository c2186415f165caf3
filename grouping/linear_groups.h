// grouping/linear_groups: vertices reduced to t on lines through two retained vertices.
//   Method [PG] 2.2, best first and greedy: a table of all vertex pairs by how many vertices their line would take
//          (ties: lower first vertex, then lower second); pairs with a vertex that has been taken are passed over.
//   Keeps  states only go from free to defining or grouped; the same result as naiveGroupLinear() within a cell
//   Cost   near O(m^2) for the m vertices of a cell, and 6 m^2 bytes; larger sets are cut into cells first
#pragma once

#include "grouping/vertex_groups.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

struct LinearOptions {
  double epsilon = 0.005;  ///< fraction of the extent, in [0, kMaxEpsilon]
  Metric metric = Metric::kDistance;
  Limit limit = Limit::kSafe;  ///< of the quadric metric
  /// Takes only vertices between V1 and V2, so that the two alone bound the group. Otherwise the range of s does.
  bool segment_only = false;
  std::uint8_t dimensions = 3;             ///< 2: z of every vertex is 0
  std::uint32_t max_cell_vertices = 3000;  ///< [3, 65535]; larger sets are cut in halves along their longest edge
  bool restore_flipped = false;            ///< as in PlanarOptions
  Progress progress;                       ///< may be empty
};

/// Groups the vertices that faces use; without faces all of them, by distance whatever the metric asked for.
/// Throws Error(kBadInput) if a vertex in use is not finite or beyond 1e30.
VertexGroups groupLinear(const mesh::Mesh& mesh, const LinearOptions& options);

/// The texture coordinates of a mesh as a flat mesh, (u, v, 0), to be grouped with LinearOptions::dimensions = 2.
mesh::Mesh texcoordMesh(const mesh::Mesh& mesh);

}  // namespace sheaf::grouping
