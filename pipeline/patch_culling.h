// pipeline/patch_culling: which patches of an instance are drawn.
#pragma once

#include <cstdint>
#include <vector>

#include "grouping/patch_tree.h"
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

/// What is left of some jobs, and what it took.
struct CulledPatches {
  std::vector<DrawnPatch> drawn;
  std::uint64_t boxes_tested = 0;  ///< as Counters::boxes_tested, and so on
  std::uint64_t outside = 0;
  std::uint64_t back_facing = 0;
};

/// Adds a part to `out`, its patches in ascending order. kTree and kPatches say the same of every patch.
void cullPart(const CullJob& job, const grouping::PatchTree& tree, Culling culling, const InstanceView& view,
              CulledPatches& out);

}  // namespace sheaf::pipeline
