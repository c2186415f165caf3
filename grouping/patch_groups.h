// grouping/patch_groups: planar groups of patches, each patch in the frame of its own plane. A patch that was made of
// face clusters is nearly flat, so that one plane, or a few parallel ones, take nearly all vertices inside it.
//   In     a mesh and its patches; the patches' order of vertices does not matter
//   Out    VertexGroups with planes[p] the frame of patch p: its normal is that of the plane through the corners of its
//          faces, fitted by least squares ([HFC] p. 17). A group's plane goes through a retained vertex of its patch
//   Method patch by patch and greedy: the plane through a retained vertex that takes most of the vertices still free,
//          of equal ones the one nearest to the fitted plane, until no plane takes enough
//   Keeps  vertices that are in more than one patch, or where another vertex lies, stay where they are, so that patches
//          fit together to the bit
#pragma once

#include <cstdint>

#include "core/task_pool.h"
#include "grouping/patches.h"
#include "grouping/vertex_groups.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

struct PatchGroupOptions {
  double epsilon = 0.005;  ///< fraction of the extent, in [0, kMaxEpsilon]
  Metric metric = Metric::kDistance;
  Limit limit = Limit::kSafe;     ///< of the quadric metric
  std::uint32_t min_members = 2;  ///< planes that would take fewer are left out, at least 1
  bool restore_flipped = false;   ///< as PlanarOptions::restore_flipped
};

/// Throws Error(kBadInput) if a vertex in use is not finite or beyond 1e30.
VertexGroups groupInPatches(const mesh::Mesh& mesh, const PatchSet& patches, const PatchGroupOptions& options,
                            TaskPool& pool);

}  // namespace sheaf::grouping
