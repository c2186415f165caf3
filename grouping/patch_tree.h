// grouping/patch_tree: boxes around patches and around runs of them, laid out for kernels that test a lane per box.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "grouping/patches.h"

namespace sheaf::grouping {

/// Boxes in a block; a box of one level stands for a block of the level below.
inline constexpr std::uint32_t kTreeFanOut = 16;

/// Unused lanes repeat the last box.
struct alignas(64) BoxBlock {
  float lo[3][kTreeFanOut];
  float hi[3][kTreeFanOut];
};

struct alignas(64) ConeBlock {
  float axis[3][kTreeFanOut];
  float sin_angle[kTreeFanOut];
};

/// Box i of level 0 is that of patch i; box i of level n + 1 holds the boxes of block i of level n. Neighbours in a
/// list of patches are neighbours in space, so that nothing has to be sorted.
struct PatchTree {
  /// The highest level's boxes stand for 256 patches, a block of them for 4096: as many as one worker takes at once.
  static constexpr std::size_t kLevels = 3;
  static constexpr std::uint32_t kPatchesPerPart = kTreeFanOut * kTreeFanOut * kTreeFanOut;

  std::uint32_t patch_count = 0;
  std::array<std::vector<BoxBlock>, kLevels> levels;
  std::vector<ConeBlock> cones;  ///< of the patches, as levels[0]

  /// Blocks of the highest level.
  std::uint32_t partCount() const { return static_cast<std::uint32_t>(levels.back().size()); }
  std::size_t bytes() const;
};

/// Bounds of the patches must be what they are drawn with (renewBounds()).
PatchTree buildPatchTree(std::span<const Patch> patches);

}  // namespace sheaf::grouping
