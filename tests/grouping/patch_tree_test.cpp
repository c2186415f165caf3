#include "grouping/patch_tree.h"

#include <doctest/doctest.h>

#include "tests/mesh/meshes.h"

namespace sheaf::grouping {
namespace {

Box3 boxOf(const std::vector<BoxBlock>& level, std::size_t i) {
  const BoxBlock& block = level[i / kTreeFanOut];
  Box3 box;
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = block.lo[k][i % kTreeFanOut];
    box.hi[k] = block.hi[k][i % kTreeFanOut];
  }
  return box;
}

bool same(const Box3& a, const Box3& b) {
  return a.lo == b.lo && a.hi == b.hi;
}

}  // namespace

TEST_CASE("grouping/patch_tree: every box is exactly around those below it, unused lanes repeat the last one") {
  TaskPool pool(1);
  const mesh::Mesh m = mesh::makeSphere(60, 80);
  for (const std::uint32_t max_triangles : {512U, 60U, 2U}) {
    CAPTURE(max_triangles);
    const std::vector<Patch> patches = splitIntoPatches(m, {256, max_triangles}, pool).patches;
    const PatchTree tree = buildPatchTree(patches);
    CHECK(tree.patch_count == patches.size());
    std::vector<Box3> expected;
    for (const Patch& p : patches) expected.push_back(p.bounds);
    for (const std::vector<BoxBlock>& level : tree.levels) {
      REQUIRE(level.size() == (expected.size() + kTreeFanOut - 1) / kTreeFanOut);
      std::vector<Box3> above(level.size());
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < level.size() * kTreeFanOut; ++i) {
        const Box3& box = expected[std::min(i, expected.size() - 1)];
        wrong += same(boxOf(level, i), box) ? 0 : 1;
        above[i / kTreeFanOut].extend(box);
      }
      CHECK(wrong == 0);
      expected = above;
    }
    REQUIRE(tree.cones.size() == tree.levels[0].size());
    for (std::size_t i = 0; i < patches.size(); ++i) {
      const ConeBlock& block = tree.cones[i / kTreeFanOut];
      const std::size_t lane = i % kTreeFanOut;
      CHECK(patches[i].cone ==
            NormalCone{{block.axis[0][lane], block.axis[1][lane], block.axis[2][lane]}, block.sin_angle[lane]});
    }
  }
}

TEST_CASE("grouping/patch_tree: parts are the runs of 4096 patches; no patches, no parts") {
  CHECK(buildPatchTree({}).partCount() == 0);
  for (const std::uint32_t count : {1U, 4096U, 4097U, 10'000U}) {
    std::vector<Patch> patches(count);
    for (Patch& p : patches) p.bounds.extend(Vec3(0.0F));
    CHECK(buildPatchTree(patches).partCount() == (count + 4095) / 4096);
  }
}

}  // namespace sheaf::grouping
