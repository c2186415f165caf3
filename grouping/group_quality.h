// grouping/group_quality: what grouping has done to a mesh, in figures, and undoing it where a face was turned over.
#pragma once

#include "grouping/vertex_groups.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

/// Everything in GroupingStats but restored_vertices and search_ms, which are the search's own and stay as they are.
/// original  the mesh that was grouped, positions as they were
void measure(std::span<const Vec3> original, std::span<const mesh::Triangle> triangles, VertexGroups& groups);

/// Sets members free again until no face that had area is flipped or without area. Adds to stats.restored_vertices.
void restoreFlippedFaces(std::span<const Vec3> original, std::span<const mesh::Triangle> triangles,
                         VertexGroups& groups);

/// What every search does last: restores flipped faces (if asked to, and always for the safe limit of the quadric
/// metric, where it is only against round-off), sets search_ms from the start time (nowNs()), measures.
void finishGroups(const mesh::Mesh& mesh, bool restore_flipped, std::int64_t start_ns, VertexGroups& groups);

}  // namespace sheaf::grouping
