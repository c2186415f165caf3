// grouping/update_groups: vertex groups after a few vertices have moved, without searching anew ([PG] 7, future work).
//   Method a vertex that is still within reach of its line or plane is projected again; one that is not goes to the
//          nearest line or plane within reach, or is set free. A line or plane stays where it was when a vertex that
//          defines it moves away: its base is kept, to be transformed like a vertex, and that vertex is treated as free
//   Cost   O(moved log groups) for planes, O(moved * groups) for lines, and one pass over the vertices and faces to
//          renew lists and figures; the quadric metric makes all ellipsoids anew
#pragma once

#include <cstdint>
#include <span>

#include "grouping/vertex_groups.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

struct UpdateReport {
  std::uint32_t projected = 0;   ///< stayed in their group
  std::uint32_t reinserted = 0;  ///< went from a group, or from being retained, to another group
  std::uint32_t ejected = 0;     ///< were grouped and are free now
  std::uint32_t released = 0;    ///< defined a group and do so no longer, whatever they are now
  /// Bases that no vertex stands for any more: retained positions beside stats.free + stats.defining.
  std::uint32_t kept_bases = 0;
};

/// mesh    as it was when grouped, but for the positions of `moved`
/// moved   vertices in any order, each once
/// Epsilon stays the length that it was: groups.extent does not change. Throws Error(kBadInput) if a moved vertex is
/// not finite or beyond 1e30, in which case `groups` is unchanged.
UpdateReport updateGroups(const mesh::Mesh& mesh, std::span<const std::uint32_t> moved, VertexGroups& groups);

}  // namespace sheaf::grouping
