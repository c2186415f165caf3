// grouping/carried_groups: groups that were found on one mesh, brought to the mesh that is drawn: one whose vertices
// are copies of the other's, and which is cut into patches of its own.
//   Keeps  every vertex lies where its group put it, to the bit
#pragma once

#include <cstdint>
#include <span>

#include "grouping/patches.h"
#include "grouping/vertex_groups.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

/// The groups of a mesh whose vertices are copies of some of those that were grouped. Of a defining vertex the first
/// copy defines, others are free; of one that has no copy only the group's base is left. Groups without members are
/// dropped. Of the figures only search_ms is kept (measure() makes the others); warnings are not.
/// mesh    the one with the copies
/// source  #V of `mesh`, which grouped vertex each is a copy of; kNoIndex: of none, it is in no group
VertexGroups carriedOver(const VertexGroups& groups, const mesh::Mesh& mesh, std::span<const std::uint32_t> source);

/// Groups on planes across any directions as placeInFrames() needs them, planes[p] being the frame of patch p: the
/// direction that has most vertices inside it, of equally many the first. The others are free where they lie, and so
/// are vertices that are in more than one patch, or lie where a vertex of another patch or group does. groups  of
/// planes
VertexGroups framedByPatch(const VertexGroups& groups, const PatchSet& patches);

}  // namespace sheaf::grouping
