// grouping/patch_split: cuts any triangles of a mesh by position and orientation.
#pragma once

#include <cstdint>
#include <vector>

#include "grouping/patch_cut.h"

namespace sheaf::grouping {

/// As splitIntoPatches() cuts a whole mesh. Runs are in the order of the halves that they came from, so that neighbours
/// in the list are neighbours in space.
/// triangles  ascending, none uses a vertex twice; they need not be neighbours of each other
PatchCut splitByPlace(const mesh::Mesh& mesh, std::vector<std::uint32_t> triangles, const PatchLimits& limits,
                      TaskPool& pool);

}  // namespace sheaf::grouping
