// grouping/planar_groups: vertices reduced to (s, t) on planes of a few given directions through retained vertices.
//   Method [PG] 3.2, best first and greedy: the planes through a vertex are one entry of a table that is sorted by how
//          many vertices they would take; entries whose vertex has been taken, or that take nothing, are passed over.
//          A taken vertex goes to the plane that is nearest to it ([PG] does not say), ties to the earlier direction.
//   Keeps  no two retained vertices that were processed lie within epsilon of each other along any direction (distance
//          metric); the same result as naiveGroupPlanar()
//   Cost   O(n log n) beside the table's keys; about 60 bytes per vertex for the axis planes and the distance metric
#pragma once

#include <vector>

#include "grouping/plane_sets.h"
#include "grouping/vertex_groups.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

/// What an entry of the table is worth.
enum class TableKey : std::uint8_t {
  kAuto,     ///< kUnion for up to kAutoUnionVertices vertices, otherwise kSum
  kUnion,    ///< vertices that at least one of its planes would take: the literal reading
  kSum,      ///< the same, counted once for each plane: O(log n) a vertex
  kDynamic,  ///< kUnion, of the vertices that are still free when its turn comes. O(hits) each time it is asked
};
inline constexpr std::uint32_t kAutoUnionVertices = 20000;

struct PlanarOptions {
  double epsilon = 0.005;  ///< fraction of the extent, in [0, kMaxEpsilon]
  Metric metric = Metric::kDistance;
  Limit limit = Limit::kSafe;  ///< of the quadric metric
  TableKey key = TableKey::kAuto;
  std::vector<PlaneFrame> planes = axisPlanes();  ///< at least one
  /// Sets vertices free again until no face is flipped or collapsed. The quadric metric with the safe limit always
  /// does, against round-off.
  bool restore_flipped = false;
  double extent = 0.0;  ///< what epsilon is a fraction of, if not the longest edge of the box; 0: that edge
};

/// Groups the vertices that faces use; without faces all of them, by distance whatever the metric asked for.
/// Throws Error(kBadInput) if a vertex in use is not finite or beyond 1e30.
VertexGroups groupPlanar(const mesh::Mesh& mesh, const PlanarOptions& options);

}  // namespace sheaf::grouping
