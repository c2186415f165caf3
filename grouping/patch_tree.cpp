#include "grouping/patch_tree.h"

#include <algorithm>

namespace sheaf::grouping {
namespace {

std::vector<BoxBlock> packBoxes(std::span<const Box3> boxes) {
  std::vector<BoxBlock> blocks((boxes.size() + kTreeFanOut - 1) / kTreeFanOut);
  for (std::size_t i = 0; i < blocks.size() * kTreeFanOut; ++i) {
    const Box3& box = boxes[std::min(i, boxes.size() - 1)];
    for (int k = 0; k < 3; ++k) {
      blocks[i / kTreeFanOut].lo[k][i % kTreeFanOut] = box.lo[k];
      blocks[i / kTreeFanOut].hi[k][i % kTreeFanOut] = box.hi[k];
    }
  }
  return blocks;
}

// One for each run of a block.
std::vector<Box3> joinRuns(std::span<const Box3> boxes) {
  std::vector<Box3> joined((boxes.size() + kTreeFanOut - 1) / kTreeFanOut);
  for (std::size_t i = 0; i < boxes.size(); ++i) joined[i / kTreeFanOut].extend(boxes[i]);
  return joined;
}

std::vector<ConeBlock> packCones(std::span<const Patch> patches) {
  std::vector<ConeBlock> blocks((patches.size() + kTreeFanOut - 1) / kTreeFanOut);
  for (std::size_t i = 0; i < blocks.size() * kTreeFanOut; ++i) {
    const NormalCone& cone = patches[std::min(i, patches.size() - 1)].cone;
    for (int k = 0; k < 3; ++k) blocks[i / kTreeFanOut].axis[k][i % kTreeFanOut] = cone.axis[k];
    blocks[i / kTreeFanOut].sin_angle[i % kTreeFanOut] = cone.sin_angle;
  }
  return blocks;
}

}  // namespace

std::size_t PatchTree::bytes() const {
  std::size_t sum = cones.capacity() * sizeof(ConeBlock);
  for (const std::vector<BoxBlock>& level : levels) sum += level.capacity() * sizeof(BoxBlock);
  return sum;
}

PatchTree buildPatchTree(std::span<const Patch> patches) {
  PatchTree tree;
  tree.patch_count = static_cast<std::uint32_t>(patches.size());
  tree.cones = packCones(patches);
  std::vector<Box3> boxes;
  boxes.reserve(patches.size());
  for (const Patch& patch : patches) boxes.push_back(patch.bounds);
  for (std::vector<BoxBlock>& level : tree.levels) {
    level = packBoxes(boxes);
    boxes = joinRuns(boxes);
  }
  return tree;
}

}  // namespace sheaf::grouping
