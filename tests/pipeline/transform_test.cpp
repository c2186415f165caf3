#include "pipeline/transform.h"

#include <doctest/doctest.h>

#include <bit>
#include <random>
#include <vector>

#include "raster/screen.h"
#include "tests/simd_targets.h"

namespace sheaf::pipeline {
namespace {

std::uint32_t bits(float f) {
  return std::bit_cast<std::uint32_t>(f);
}

struct Positions {
  std::array<std::vector<float>, 3> axis;
  std::array<const float*, 3> pointers() const { return {axis[0].data(), axis[1].data(), axis[2].data()}; }
  Vec3 at(std::size_t v) const { return {axis[0][v], axis[1][v], axis[2][v]}; }
};

Positions randomPositions(std::mt19937& rng, std::size_t count) {
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  Positions p;
  for (auto& axis : p.axis)
    for (std::size_t v = 0; v < (count + 15) / 16 * 16; ++v) axis.push_back(v < count ? unit(rng) : axis[count - 1]);
  return p;
}

Mat4 randomMatrix(std::mt19937& rng) {
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  Mat4 m;
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) m[c][r] = unit(rng);
  return m;
}

}  // namespace

TEST_CASE("pipeline/transform: every SIMD target equals the references, bit for bit") {
  std::mt19937 rng(0x5eed);
  const Viewport viewport(131, 97);
  for (const std::uint32_t count : {1U, 3U, 15U, 16U, 17U, 100U, 256U}) {
    CAPTURE(count);
    const Positions positions = randomPositions(rng, count);
    const Mat4 clip_from_object = randomMatrix(rng);
    forEachTarget([&] {
      ClipVertices clip;
      ProjectedVertices projected;
      alignas(64) std::int32_t codes[kMaxPatchVertices];
      transformVertices(positions.pointers(), count, clip_from_object, clip);
      projectVertices(clip, count, viewport, projected);
      const OutcodeSummary summary = outcodeVertices(clip, count, viewport, codes);
      std::int32_t all = -1;
      std::int32_t any = 0;
      for (std::uint32_t v = 0; v < count; ++v) {
        CAPTURE(v);
        const Vec4 expected = transformVertex(positions.at(v), clip_from_object);
        CHECK(bits(clip.x[v]) == bits(expected.x));
        CHECK(bits(clip.y[v]) == bits(expected.y));
        CHECK(bits(clip.z[v]) == bits(expected.z));
        CHECK(bits(clip.w[v]) == bits(expected.w));
        CHECK(codes[v] == outcodeVertex(expected, viewport));
        all &= codes[v];
        any |= codes[v];
        if (expected.w < 0.01F) continue;  // meaningless, and outside the range of fixed point
        const ProjectedVertex p = projectVertex(expected, viewport);
        CHECK(projected.x_fx[v] == p.x_fx);
        CHECK(projected.y_fx[v] == p.y_fx);
        CHECK(bits(projected.depth[v]) == bits(p.depth));
        CHECK(bits(projected.inv_w[v]) == bits(p.inv_w));
      }
      CHECK(summary.all == all);
      CHECK(summary.any == any);
    });
  }
}

TEST_CASE("pipeline/transform: half a subpixel goes to the even one on every target") {
  // x_px * 256 = 0.5, 1.5, 2.5, -0.5: exact in float for a target of two pixels.
  const Viewport viewport(2, 2);
  ClipVertices clip{};
  const float subpixels[4] = {0.5F, 1.5F, 2.5F, -0.5F};
  for (int v = 0; v < 16; ++v) {
    clip.x[v] = subpixels[v % 4] / 256.0F - 1.0F;
    clip.w[v] = 1.0F;
  }
  forEachTarget([&] {
    ProjectedVertices out;
    projectVertices(clip, 4, viewport, out);
    CHECK(out.x_fx[0] == 0);
    CHECK(out.x_fx[1] == 2);
    CHECK(out.x_fx[2] == 2);
    CHECK(out.x_fx[3] == 0);
  });
}

TEST_CASE("pipeline/transform: corners of the view volume land on the corners of the picture") {
  const Viewport viewport(640, 480);
  const ProjectedVertex top_left = projectVertex({-2.0F, 2.0F, 1.0F, 2.0F}, viewport);
  CHECK(top_left.x_fx == 0);
  CHECK(top_left.y_fx == 0);
  CHECK(top_left.depth == 0.5F);
  const ProjectedVertex bottom_right = projectVertex({3.0F, -3.0F, 0.0F, 3.0F}, viewport);
  CHECK(bottom_right.x_fx == 640 * raster::kSubpixels);
  CHECK(bottom_right.y_fx == 480 * raster::kSubpixels);
}

TEST_CASE("pipeline/transform: outcodes are closed, and points behind the eye are beyond near") {
  const Viewport viewport(640, 480);
  CHECK(outcodeVertex({1.0F, 1.0F, 1.0F, 1.0F}, viewport) == 0);
  CHECK(outcodeVertex({-1.0F, -1.0F, 0.0F, 1.0F}, viewport) == 0);
  CHECK(outcodeVertex({1.5F, 0.0F, 0.5F, 1.0F}, viewport) == kOutRight);
  CHECK((outcodeVertex({0.0F, 0.0F, -2.0F, -1.0F}, viewport) & kOutNear) != 0);
  CHECK((outcodeVertex({0.0F, 0.0F, 0.0F, 0.0F}, viewport) & kOutNear) != 0);
  CHECK((outcodeVertex({1e6F, 0.0F, 0.5F, 1.0F}, viewport) & kGuardRight) != 0);
}

}  // namespace sheaf::pipeline
