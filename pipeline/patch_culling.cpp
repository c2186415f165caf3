#include "pipeline/patch_culling.h"

#include <algorithm>
#include <bit>

namespace sheaf::pipeline {
namespace {

using grouping::kTreeFanOut;
using grouping::PatchTree;

class PartCuller {
 public:
  PartCuller(std::uint32_t instance, const PatchTree& tree, const InstanceView& view, CulledPatches& out)
      : instance_(instance), tree_(tree), view_(view), out_(out) {}

  void drawAll(std::uint32_t part) {
    const std::uint32_t end = patchEnd(PatchTree::kLevels - 1, part);
    for (std::uint32_t p = part * PatchTree::kPatchesPerPart; p < end; ++p)
      out_.drawn.push_back({instance_, p, PatchVisibility::kStraddling});
  }

  void testAll(std::uint32_t part) {
    constexpr std::uint32_t kBlocks = PatchTree::kPatchesPerPart / kTreeFanOut;
    const auto end = std::min(static_cast<std::uint32_t>(tree_.levels[0].size()), (part + 1) * kBlocks);
    for (std::uint32_t b = part * kBlocks; b < end; ++b) testPatches(b, testBoxes(0, b));
  }

  // `block` of `level`, which is not known to be in view or out of it.
  void descend(std::size_t level, std::uint32_t block) {
    const BoxBits bits = testBoxes(level, block);
    if (level == 0) return testPatches(block, bits);
    const std::uint32_t count = boxCount(level, block);
    for (std::uint32_t lane = 0; lane < count; ++lane) {
      const std::uint32_t below = block * kTreeFanOut + lane;
      const std::uint32_t bit = 1U << lane;
      if ((bits.outside & bit) != 0)
        out_.outside += patchEnd(level - 1, below) - patchBegin(level - 1, below);
      else if (((bits.clips | bits.crosses) & bit) != 0)
        descend(level - 1, below);
      else
        takeInside(level - 1, below);
    }
  }

 private:
  static std::uint32_t patchBegin(std::size_t level, std::uint32_t block) {
    return block << 4U * (static_cast<std::uint32_t>(level) + 1);
  }
  std::uint32_t patchEnd(std::size_t level, std::uint32_t block) const {
    return std::min(tree_.patch_count, patchBegin(level, block + 1));
  }
  // In a block: only the last one of a level has fewer than 16.
  std::uint32_t boxCount(std::size_t level, std::uint32_t block) const {
    const std::size_t boxes = level == 0 ? tree_.patch_count : tree_.levels[level - 1].size();
    return static_cast<std::uint32_t>(std::min<std::size_t>(kTreeFanOut, boxes - std::size_t{block} * kTreeFanOut));
  }

  BoxBits testBoxes(std::size_t level, std::uint32_t block) {
    out_.boxes_tested += boxCount(level, block);
    return classifyBoxes(tree_.levels[level][block], view_);
  }

  // All patches below the block are in view; of these only some face away.
  void takeInside(std::size_t level, std::uint32_t block) {
    const std::uint32_t begin = patchBegin(level, block) / kTreeFanOut;
    const std::uint32_t end = (patchEnd(level, block) + kTreeFanOut - 1) / kTreeFanOut;
    for (std::uint32_t b = begin; b < end; ++b) testPatches(b, {});
  }

  // A block of patches, of whose boxes `bits` are known.
  void testPatches(std::uint32_t block, const BoxBits& bits) {
    const std::uint32_t valid = 0xFFFFU >> (kTreeFanOut - boxCount(0, block));
    const std::uint32_t outside = bits.outside & valid;
    std::uint32_t kept = valid & ~outside;
    out_.outside += static_cast<unsigned>(std::popcount(outside));
    if (view_.culls_back && kept != 0) {
      const std::uint32_t back_facing = kept & findBackFacing(tree_.levels[0][block], tree_.cones[block], view_);
      kept &= ~back_facing;
      out_.back_facing += static_cast<unsigned>(std::popcount(back_facing));
    }
    for (; kept != 0; kept &= kept - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(kept));
      out_.drawn.push_back({instance_, block * kTreeFanOut + lane, bits.visibilityOf(lane)});
    }
  }

  std::uint32_t instance_;
  const PatchTree& tree_;
  const InstanceView& view_;
  CulledPatches& out_;
};

}  // namespace

void cullPart(const CullJob& job, const PatchTree& tree, Culling culling, const InstanceView& view,
              CulledPatches& out) {
  PartCuller culler(job.instance, tree, view, out);
  switch (culling) {
    case Culling::kNone:
      return culler.drawAll(job.part);
    case Culling::kPatches:
      return culler.testAll(job.part);
    case Culling::kTree:
      return culler.descend(PatchTree::kLevels - 1, job.part);
  }
}

}  // namespace sheaf::pipeline
