#include "pipeline/patch_culling.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "tests/pipeline/random_view.h"
#include "tests/simd_targets.h"

namespace sheaf::pipeline {
namespace {

using grouping::Patch;
using grouping::PatchTree;

// Along a random walk, so that neighbours in the list are near each other; some have no cone.
std::vector<Patch> randomPatches(std::size_t count, std::mt19937& rng) {
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  std::vector<Patch> patches(count);
  Vec3 center(unit(rng), unit(rng), unit(rng));
  const float step = 3.0F / std::sqrt(static_cast<float>(count + 1));
  for (Patch& patch : patches) {
    center = glm::clamp(center + step * Vec3(unit(rng), unit(rng), unit(rng)), Vec3(-2.0F), Vec3(2.0F));
    for (int i = 0; i < 4; ++i) patch.bounds.extend(center + step * Vec3(unit(rng), unit(rng), unit(rng)));
    if (unit(rng) < 0.7F) patch.cone = {glm::normalize(Vec3(unit(rng), unit(rng), unit(rng))), 0.5F + 0.5F * unit(rng)};
  }
  return patches;
}

std::vector<PatchVisibility> seenOf(const PatchTree& tree, Culling culling, const InstanceView& view,
                                    CulledPatches& culled) {
  for (std::uint32_t part = 0; part < tree.partCount(); ++part) cullPart({7, part}, tree, culling, view, culled);
  const std::vector<DrawnPatch>& drawn = culled.drawn;
  std::vector<PatchVisibility> seen(tree.patch_count, PatchVisibility::kOutside);  // or back-facing: not drawn
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    REQUIRE(drawn[i].patch < tree.patch_count);
    CHECK(drawn[i].instance == 7);
    if (i > 0) CHECK(drawn[i].patch > drawn[i - 1].patch);
    seen[drawn[i].patch] = drawn[i].seen;
  }
  return seen;
}

}  // namespace

TEST_CASE("pipeline/patch_culling: kernels say of every patch what the reference does, with and without the tree") {
  std::mt19937 rng(91);
  std::uint64_t saved = 0, back_facing = 0, inside = 0, across = 0, straddling = 0;
  for (const std::size_t count : {1U, 2U, 15U, 16U, 17U, 255U, 256U, 300U, 4096U, 5000U})
    for (int i = 0; i < 30; ++i) {
      CAPTURE(count);
      CAPTURE(i);
      const std::vector<Patch> patches = randomPatches(count, rng);
      const PatchTree tree = grouping::buildPatchTree(patches);
      const RandomView random = randomView(rng);
      InstanceView view = viewInstance(random.instance, Box3(), random.view, false);
      view.culls_back = i % 3 != 0;
      CulledPatches expected_counts;
      std::vector<PatchVisibility> expected;
      for (const Patch& patch : patches) {
        PatchVisibility seen = classifyPatch(patch, view);
        if (seen == PatchVisibility::kOutside) ++expected_counts.outside;
        if (seen == PatchVisibility::kBackFacing) {
          ++expected_counts.back_facing;
          seen = PatchVisibility::kOutside;
        }
        inside += seen == PatchVisibility::kInside;
        across += seen == PatchVisibility::kAcrossSides;
        straddling += seen == PatchVisibility::kStraddling;
        expected.push_back(seen);
      }
      back_facing += expected_counts.back_facing;
      forEachTarget([&] {
        for (const Culling culling : {Culling::kPatches, Culling::kTree}) {
          CulledPatches culled;
          CHECK(seenOf(tree, culling, view, culled) == expected);
          CHECK(culled.outside == expected_counts.outside);
          CHECK(culled.back_facing == expected_counts.back_facing);
          if (culling == Culling::kPatches) CHECK(culled.boxes_tested == count);
          if (culling == Culling::kTree && count == 5000) saved += culled.boxes_tested < 5000 ? 1 : 0;
        }
      });
    }
  CHECK(saved > 20);
  CHECK(back_facing > 1000);
  CHECK(inside > 1000);
  CHECK(across > 1000);
  CHECK(straddling > 1000);
}

TEST_CASE("pipeline/patch_culling: one box is enough where all patches are out of view or in view") {
  std::mt19937 rng(92);
  const PatchTree tree = grouping::buildPatchTree(randomPatches(4096, rng));
  // Clip space is object space: x and y within -1 and 1, z within 0 and 1.
  const View view{DMat4(1.0), DVec4(0.0, 0.0, 1.0, 0.0), Viewport(64, 64)};
  scenes::Instance instance;
  instance.world_from_object[0][0] = instance.world_from_object[1][1] = instance.world_from_object[2][2] = 0.01;
  for (const double z : {0.5, 5.0}) {
    CAPTURE(z);
    instance.world_from_object[3] = DVec4(0.0, 0.0, z, 1.0);
    InstanceView instance_view = viewInstance(instance, Box3(), view, false);
    instance_view.culls_back = false;
    CulledPatches culled;
    const auto seen = seenOf(tree, Culling::kTree, instance_view, culled);
    const auto expected = z < 1.0 ? PatchVisibility::kInside : PatchVisibility::kOutside;
    CHECK(std::ranges::count(seen, expected) == 4096);
    CHECK(culled.boxes_tested == 16);  // those of the highest level
  }
}

TEST_CASE("pipeline/patch_culling: without culling every patch is drawn and none is tested") {
  std::mt19937 rng(93);
  const PatchTree tree = grouping::buildPatchTree(randomPatches(5000, rng));
  const RandomView random = randomView(rng);
  CulledPatches culled;
  const auto seen = seenOf(tree, Culling::kNone, viewInstance(random.instance, Box3(), random.view, false), culled);
  CHECK(std::ranges::count(seen, PatchVisibility::kStraddling) == 5000);
  CHECK(culled.boxes_tested == 0);
}

}  // namespace sheaf::pipeline
