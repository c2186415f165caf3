// grouping/shape_tree: the shapes of a whole hierarchy of face clusters.
#pragma once

#include <span>

#include "grouping/cluster_cost.h"
#include "grouping/face_clusters.h"

namespace sheaf::grouping {

/// Clusters of up to so many faces all have a shape, if they have the faces that it takes. Larger ones have one if they
/// have grown by a 256th since the last below them that has one: a chain of #F clusters, each a face larger than the
/// one before, would take #F^2 time otherwise.
inline constexpr std::uint32_t kPieceFaces = 512;

/// In object space, without perimeter; the mesh's own winding. Empty if a corner is not finite.
ClusterMoments objectMoments(const mesh::Mesh& mesh, std::uint32_t face);

/// points  every corner of the faces that `moments` are of, in any order, at least once
ClusterShape shapeFrom(const ClusterMoments& moments, std::span<const Vec3> points, const NormalCone& cone);

/// Fills in shape_index and shapes of a hierarchy that is complete but for them.
void addShapes(const mesh::Mesh& mesh, std::uint32_t min_shape_faces, TaskPool& pool, FaceClusters& clusters);

}  // namespace sheaf::grouping
