// pipeline/patch_culling: which patches of an instance are drawn.
#pragma once

#include <cstdint>
#include <vector>

#include "grouping/patch_tree.h"
#include "pipeline/counters.h"
#include "pipeline/cull.h"

namespace sheaf::pipeline {

enum class Culling : std::uint8_t {
  kNone,     ///< every patch is drawn, as if some of it had to be clipped: the classic pipeline
  kPatches,  ///< every patch is tested
  kTree,     ///< runs of patches are tested, and those that are wholly out of view or in view not further
};

/// A patch of an instance that survived culling.
struct DrawnPatch {
  std::uint32_t instance;
  std::uint32_t patch;
  PatchVisibility seen;  ///< not outside, not back-facing
};

/// The patches below one block of the tree's highest level.
struct CullJob {
  std::uint32_t instance;
  std::uint32_t part;  ///< below PatchTree::partCount()
};

/// Adds what is drawn of a part to `drawn`, in ascending order of patches, and counts. kTree and kPatches say the same
/// of every patch.
void cullPart(const CullJob& job, const grouping::PatchTree& tree, Culling culling, const InstanceView& view,
              bool back_faces_culled, std::vector<DrawnPatch>& drawn, Counters& counters);

}  // namespace sheaf::pipeline
