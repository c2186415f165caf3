// grouping/carried_groups: groups that were found on one mesh, brought to the mesh that is drawn: one whose vertices
// are copies of the other's, and which is cut into patches of its own.
//   Keeps  every vertex lies where its group put it, to the bit
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "grouping/patches.h"
#include "grouping/vertex_groups.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

/// Brings groups to one mesh after another. What is as long as `groups` is made once, so that many small meshes, such
/// as the instances of a scene that was grouped as one, cost no more than they have vertices.
class GroupCarrier {
 public:
  /// groups  to outlive the carrier
  explicit GroupCarrier(const VertexGroups& groups);

  /// The groups of a mesh whose vertices are copies of some of those that were grouped. Of a defining vertex the first
  /// copy defines, others are free; of one that has no copy only the group's base is left. Groups without members are
  /// dropped. Of the figures only search_ms is kept (measure() makes the others); warnings are not.
  /// mesh    the one with the copies
  /// source  #V of `mesh`, which grouped vertex each is a copy of; kNoIndex: of none, it is in no group
  VertexGroups carry(const mesh::Mesh& mesh, std::span<const std::uint32_t> source);

 private:
  const VertexGroups& groups_;
  std::vector<std::uint32_t> member_;  // #V of groups_, where a grouped vertex stands among the members
  std::vector<std::uint32_t> copy_;    // #V of groups_, its first copy; kNoIndex between calls
};

/// Groups on planes across any directions as placeInFrames() needs them, planes[p] being the frame of patch p: the
/// direction that has most vertices inside it, of equally many the first. The others are free where they lie, and so
/// are vertices that are in more than one patch, or lie where a vertex of another patch or group does.
/// groups  of planes
VertexGroups framedByPatch(const VertexGroups& groups, const PatchSet& patches);

}  // namespace sheaf::grouping
