// grouping/cluster_patches: patches made of face clusters [HFC] in place of a split by position.
#pragma once

#include "grouping/face_clusters.h"
#include "grouping/patches.h"

namespace sheaf::grouping {

/// Cuts the hierarchy into clusters of a fraction of a patch, and grows patches of neighbouring ones until they are
/// full: the largest clusters within the limits would fill them by half. Every patch is connected across edges of
/// `surface`, with one exception: pieces of it that are less than a quarter of a patch as a whole are put together by
/// place, as splitIntoPatches() does it. Neighbours in the list of patches are mostly neighbours in space. Triangles
/// that use a vertex twice are left out.
///
/// surface   that was clustered: the mesh itself, or mesh::surfaceOf() it, so that patches reach over creases and seams
/// clusters  of `surface`
PatchSet clusterPatches(const mesh::Mesh& mesh, const mesh::Mesh& surface, const FaceClusters& clusters,
                        const PatchLimits& limits, TaskPool& pool);

/// The same with the mesh's surface and a hierarchy of its own.
PatchSet clusterPatches(const mesh::Mesh& mesh, const PatchLimits& limits, TaskPool& pool);

}  // namespace sheaf::grouping
