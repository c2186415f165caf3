// grouping/cluster_patches: patches made of face clusters [HFC] in place of a split by position.
#pragma once

#include "grouping/face_clusters.h"
#include "grouping/patches.h"

namespace sheaf::grouping {

/// Cuts the hierarchy into clusters of a fraction of a patch, and grows patches of neighbouring ones until they are
/// full: the largest clusters within the limits would fill them by half. clusters  of this mesh, or of one with the
/// same triangles whose vertices have been welded Every patch is connected across edges of the (clustered) mesh, with
/// one exception: pieces of the mesh that are less than a quarter of a patch as a whole are put together by place, as
/// splitIntoPatches() does it. Neighbours in the list of patches are mostly neighbours in space. Triangles that use a
/// vertex twice are left out.
PatchSet clusterPatches(const mesh::Mesh& mesh, const FaceClusters& clusters, const PatchLimits& limits,
                        TaskPool& pool);

/// The same with a hierarchy of its own.
PatchSet clusterPatches(const mesh::Mesh& mesh, const PatchLimits& limits, TaskPool& pool);

}  // namespace sheaf::grouping
