#include "pipeline/transform.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>
#include <vector>

#include "raster/screen.h"
#include "tests/simd_targets.h"

namespace sheaf::pipeline {
namespace {

std::uint32_t bits(float f) {
  return std::bit_cast<std::uint32_t>(f);
}

// One patch of `count` vertices in a single run.
struct OneRun {
  grouping::VertexRuns vertices;

  explicit OneRun(std::uint32_t count) {
    vertices.patches.resize(1);
    vertices.patches[0].run_count = 1;
    vertices.runs.resize(1);
    vertices.runs[0].vertex_count = static_cast<std::uint16_t>(count);
    vertices.full_stride = count;
  }
  grouping::PatchRuns& patch() { return vertices.patches[0]; }
  grouping::VertexRun& run() { return vertices.runs[0]; }
};

std::vector<float> randomFloats(std::mt19937& rng, std::size_t count) {
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  std::vector<float> values;
  for (std::size_t v = 0; v < count + grouping::kRunAlignment; ++v) values.push_back(v < count ? unit(rng) : 0.0F);
  return values;
}

OneRun fullRun(std::mt19937& rng, std::uint32_t count) {
  OneRun one(count);
  const std::vector<float> floats = randomFloats(rng, std::size_t{3} * count);
  one.vertices.full.assign(floats.begin(), floats.end());
  return one;
}

Mat4 randomMatrix(std::mt19937& rng) {
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  Mat4 m;
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) m[c][r] = unit(rng);
  return m;
}

void transformWhole(OneRun& one, std::uint32_t count, const Mat4& clip_from_object, ClipVertices& clip) {
  transformRun(one.vertices, one.patch(), {one.run(), RunStart(one.patch()), 0, count}, clip_from_object, clip);
}

void checkBits(const ClipVertices& clip, std::uint32_t v, const Vec4& expected) {
  CHECK(bits(clip.x[v]) == bits(expected.x));
  CHECK(bits(clip.y[v]) == bits(expected.y));
  CHECK(bits(clip.z[v]) == bits(expected.z));
  CHECK(bits(clip.w[v]) == bits(expected.w));
}

}  // namespace

TEST_CASE("pipeline/transform: every SIMD target equals the references, bit for bit") {
  std::mt19937 rng(0x5eed);
  const Viewport viewport(131, 97);
  for (const std::uint32_t count : {1U, 3U, 15U, 16U, 17U, 100U, 256U}) {
    CAPTURE(count);
    OneRun one = fullRun(rng, count);
    const Mat4 clip_from_object = randomMatrix(rng);
    forEachTarget([&] {
      ClipVertices clip;
      ProjectedVertices projected;
      alignas(64) std::int32_t codes[kVertexSlots];
      transformWhole(one, count, clip_from_object, clip);
      projectVertices(clip, 0, count, viewport, projected);
      ProjectedVertices at_once;
      transformPatch(one.vertices, one.patch(), clip_from_object, viewport, at_once);
      const OutcodeSummary summary = outcodeVertices(clip, 0, count, viewport, codes);
      std::int32_t all = -1;
      std::int32_t any = 0;
      for (std::uint32_t v = 0; v < count; ++v) {
        CAPTURE(v);
        const AlignedVector<float>& full = one.vertices.full;
        const Vec3 position(full[v], full[v + count], full[v + 2 * count]);
        const Vec4 expected = transformVertex(position, clip_from_object);
        checkBits(clip, v, expected);
        CHECK(codes[v] == outcodeVertex(expected, viewport));
        all &= codes[v];
        any |= codes[v];
        if (expected.w < 0.01F) continue;  // meaningless, and outside the range of fixed point
        const raster::ScreenVertex p = projectVertex(expected, viewport);
        for (const raster::ScreenVertex& drawn : {projected[v], at_once[v]}) {
          CHECK(drawn.x_fx == p.x_fx);
          CHECK(drawn.y_fx == p.y_fx);
          CHECK(bits(drawn.depth) == bits(p.depth));
          CHECK(bits(drawn.inv_w) == bits(p.inv_w));
        }
      }
      CHECK(summary.all == all);
      CHECK(summary.any == any);
    });
  }
}

TEST_CASE("pipeline/transform: planes and lines equal the reference on every SIMD target, in both forms") {
  std::mt19937 rng(77);
  std::uniform_int_distribution<int> word(0, 65535);
  for (const grouping::ParameterForm form : {grouping::ParameterForm::k16Bit, grouping::ParameterForm::kFloat})
    for (const grouping::RunKind kind : {grouping::RunKind::kPlane, grouping::RunKind::kLine})
      for (const std::uint32_t count : {1U, 7U, 16U, 33U, 256U, 29U, 200U}) {  // each axis, the last in a frame
        CAPTURE(count);
        OneRun one(count);
        grouping::VertexRuns& runs = one.vertices;
        runs.form = form;
        runs.step = 1.0F / 4096.0F;
        one.patch().corner = {-70000, 123456, 3};
        one.run().kind = kind;
        one.run().axis = static_cast<std::uint8_t>(count % 3);
        one.run().plane = 0.7F;
        if (kind == grouping::RunKind::kPlane && count == 200) {
          one.patch().frame = 0;
          runs.frames = {{{0.4F, -2.0F, 7.0F}, {{0.6F, 0.0F, 0.8F}, {0.8F, 0.0F, -0.6F}, {0.0F, 1.0F, 0.0F}}}};
        }
        if (kind == grouping::RunKind::kLine) {
          one.run().line = 0;
          runs.lines = {{Vec3(0.1F, 0.2F, 0.3F), Vec3(0.9F, -0.4F, 0.2F), -0.3F, 1e-5F}};
        }
        const std::vector<float> floats = randomFloats(rng, std::size_t{2} * count + grouping::kRunAlignment);
        for (std::uint32_t v = 0; v < count + grouping::kRunAlignment; ++v) {
          runs.parameters.emplace_back(floats[2 * v], floats[2 * v + 1]);
          runs.quantised.push_back(static_cast<std::uint32_t>(word(rng)) | static_cast<std::uint32_t>(word(rng)) << 16);
        }
        const Mat4 clip_from_object = randomMatrix(rng);
        const auto stored = [&](std::uint32_t v) {
          return form == grouping::ParameterForm::k16Bit
                     ? StoredParameters{static_cast<float>(runs.quantised[v] & 0xFFFFU),
                                        static_cast<float>(runs.quantised[v] >> 16)}
                     : StoredParameters{runs.parameters[v].x, runs.parameters[v].y};
        };
        forEachTarget([&] {
          ClipVertices clip;
          transformWhole(one, count, clip_from_object, clip);
          for (std::uint32_t v = 0; v < count; ++v) {
            CAPTURE(v);
            checkBits(clip, v, transformGrouped(runs, one.patch(), one.run(), stored(v), clip_from_object));
          }
        });
      }
}

TEST_CASE("pipeline/transform: a vertex on a plane comes out as if it had been transformed in full, bit for bit") {
  std::mt19937 rng(78);
  std::uniform_int_distribution<int> word(0, 65535);
  for (int i = 0; i < 2000; ++i) {
    grouping::VertexRuns runs;
    runs.step = std::exp2(static_cast<float>(i % 40) - 30.0F);
    grouping::PatchRuns patch;
    for (auto& corner : patch.corner) corner = word(rng) * 128 - 4000000;
    grouping::VertexRun run{.kind = grouping::RunKind::kPlane, .axis = static_cast<std::uint8_t>(i % 3), .plane = 0.3F};
    const auto [a, b] = grouping::axesBeside(run.axis);
    const int s = word(rng), t = word(rng);
    Vec3 position;
    position[run.axis] = run.plane;
    position[static_cast<int>(a)] = static_cast<float>(patch.corner[a] + s) * runs.step;
    position[static_cast<int>(b)] = static_cast<float>(patch.corner[b] + t) * runs.step;
    // Decoded by hand above, scaled into the matrix by the kernel.
    CHECK(double{position[static_cast<int>(a)]} == static_cast<double>(patch.corner[a] + s) * runs.step);
    runs.patches = {patch};
    runs.patches[0].run_count = 1;
    run.vertex_count = 1;
    runs.runs = {run};
    runs.quantised.assign(17, static_cast<std::uint32_t>(s) | static_cast<std::uint32_t>(t) << 16);
    const Mat4 clip_from_object = randomMatrix(rng);
    ClipVertices clip;
    transformRun(runs, runs.patches[0], {run, RunStart(patch), 0, 1}, clip_from_object, clip);
    checkBits(clip, 0, transformVertex(position, clip_from_object));
  }
}

TEST_CASE("pipeline/transform: a vertex on a line comes out within eight roundings of its full transform") {
  std::mt19937 rng(80);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  const auto vec3 = [&] {
    const float x = unit(rng), y = unit(rng), z = unit(rng);
    return Vec3(x, y, z);
  };
  for (int i = 0; i < 2000; ++i) {
    CAPTURE(i);
    OneRun one(1);
    one.run().kind = grouping::RunKind::kLine;
    one.run().line = 0;
    one.vertices.lines = {{100.0F * vec3(), vec3(), 4.0F * unit(rng), 1e-4F * std::abs(unit(rng))}};
    const grouping::RunLine& line = one.vertices.lines[0];
    const std::uint32_t step = rng() & 0xFFFFU;
    one.vertices.quantised.assign(1 + grouping::kRunAlignment, step);
    const Mat4 clip_from_object = randomMatrix(rng);
    ClipVertices clip;
    transformWhole(one, 1, clip_from_object, clip);
    const double s = double{line.s0} + step * double{line.ds};
    for (int row = 0; row < 4; ++row) {
      double exact = clip_from_object[3][row], magnitude = std::abs(exact);
      for (int k = 0; k < 3; ++k) {
        const double m = clip_from_object[k][row];
        exact += m * (line.base[k] + s * line.direction[k]);
        magnitude += std::abs(m) * (std::abs(line.base[k]) +
                                    (std::abs(line.s0) + step * double{line.ds}) * std::abs(double{line.direction[k]}));
      }
      const float found[] = {clip.x[0], clip.y[0], clip.z[0], clip.w[0]};
      CHECK(std::abs(found[row] - exact) <= 8.0 * std::exp2(-24.0) * magnitude);
    }
  }
}

TEST_CASE("pipeline/transform: part of a run is written and nothing beside it") {
  std::mt19937 rng(79);
  OneRun one = fullRun(rng, 100);
  const Mat4 clip_from_object = randomMatrix(rng);
  forEachTarget([&] {
    ClipVertices whole;
    transformWhole(one, 100, clip_from_object, whole);
    ClipVertices part;
    std::fill(std::begin(part.x), std::end(part.x), 7.0F);
    transformRun(one.vertices, one.patch(), {one.run(), RunStart(one.patch()), 16, 37}, clip_from_object, part);
    for (std::uint32_t v = 0; v < 100; ++v) CHECK(part.x[v] == (v >= 16 && v < 37 ? whole.x[v] : 7.0F));
  });
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
    projectVertices(clip, 0, 4, viewport, out);
    CHECK(out[0].x_fx == 0);
    CHECK(out[1].x_fx == 2);
    CHECK(out[2].x_fx == 2);
    CHECK(out[3].x_fx == 0);
  });
}

TEST_CASE("pipeline/transform: corners of the view volume land on the corners of the picture") {
  const Viewport viewport(640, 480);
  const raster::ScreenVertex top_left = projectVertex({-2.0F, 2.0F, 1.0F, 2.0F}, viewport);
  CHECK(top_left.x_fx == 0);
  CHECK(top_left.y_fx == 0);
  CHECK(top_left.depth == 0.5F);
  const raster::ScreenVertex bottom_right = projectVertex({3.0F, -3.0F, 0.0F, 3.0F}, viewport);
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
