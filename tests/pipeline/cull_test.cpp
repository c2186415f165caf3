#include "pipeline/cull.h"

#include <doctest/doctest.h>

#include <random>

#include "grouping/patch_groups.h"
#include "tests/grouping/shapes.h"
#include "tests/pipeline/random_view.h"
#include "tests/simd_targets.h"

namespace sheaf::pipeline {

TEST_CASE("pipeline/cull: a rejected patch has no point in view, an inner one none that must be clipped") {
  std::mt19937 rng(42);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  int outside = 0;
  int inside = 0;
  int across = 0;
  for (int i = 0; i < 4000; ++i) {
    const RandomView random = randomView(rng);
    grouping::Patch patch;
    const Vec3 center(2.0F * unit(rng), 2.0F * unit(rng), 2.0F * unit(rng));
    std::array<Vec3, 30> points;
    for (Vec3& p : points) {
      p = center + 0.4F * Vec3(unit(rng), unit(rng), unit(rng));
      patch.bounds.extend(p);
    }
    const InstanceView view = viewInstance(random.instance, patch.bounds, random.view, true);
    const PatchVisibility seen = classifyPatch(patch, view);
    CHECK(view.visible == (seen != PatchVisibility::kOutside));
    outside += seen == PatchVisibility::kOutside;
    inside += seen == PatchVisibility::kInside;
    across += seen == PatchVisibility::kAcrossSides;
    std::int32_t any = 0;
    std::int32_t all = -1;
    for (const Vec3& p : points) {
      const std::int32_t code = outcodeVertex(transformVertex(p, view.clip_from_object), random.view.viewport);
      any |= code;
      all &= code;
    }
    if (seen == PatchVisibility::kOutside) CHECK((all & kOutsideBits) != 0);
    if (seen == PatchVisibility::kInside) CHECK(any == 0);
    if (seen == PatchVisibility::kAcrossSides) CHECK((any & kClipBits) == 0);
  }
  CHECK(outside > 200);
  CHECK(inside > 100);
  CHECK(across > 200);
}

TEST_CASE("pipeline/cull: a patch rejected by its cone shows no front face") {
  std::mt19937 rng(43);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  int rejected = 0;
  for (int i = 0; i < 4000; ++i) {
    const RandomView random = randomView(rng);
    const Vec3 axis = glm::normalize(Vec3(unit(rng), unit(rng), unit(rng)));
    grouping::Patch patch;
    patch.cone.axis = axis;
    std::vector<std::array<Vec3, 3>> triangles;
    float min_cos = 1.0F;
    for (int t = 0; t < 20; ++t) {
      const Vec3 p = 0.3F * Vec3(unit(rng), unit(rng), unit(rng));
      const Vec3 n = glm::normalize(axis + 0.4F * Vec3(unit(rng), unit(rng), unit(rng)));
      const Vec3 a = glm::normalize(glm::cross(n, Vec3(0.3F, 0.5F, 0.7F)));
      const Vec3 b = glm::cross(n, a);
      triangles.push_back({p, p + 0.1F * a, p + 0.1F * b});
      for (const Vec3& corner : triangles.back()) patch.bounds.extend(corner);
      min_cos = std::min(min_cos, glm::dot(n, axis));
    }
    patch.cone.sin_angle = std::sqrt(1.0F - min_cos * min_cos) + 1e-4F;
    InstanceView view = viewInstance(random.instance, patch.bounds, random.view, true);
    if (classifyPatch(patch, view) != PatchVisibility::kBackFacing) continue;
    ++rejected;
    view.culls_back = false;
    CHECK(classifyPatch(patch, view) != PatchVisibility::kBackFacing);
    for (const auto& t : triangles) {
      // Seen from the eye in world space; a mirroring transform turns the winding, not the side.
      std::array<DVec3, 3> w;
      for (std::size_t k = 0; k < 3; ++k) w[k] = DVec3(random.instance.world_from_object * DVec4(t[k], 1.0));
      DVec3 normal = glm::cross(w[1] - w[0], w[2] - w[0]);
      if (view.mirrored) normal = -normal;
      const DVec4 eye = random.view.eye_world;
      const DVec3 to_eye = eye.w == 0.0 ? DVec3(eye) : DVec3(eye) - w[0];
      CHECK(glm::dot(normal, to_eye) <= 1e-6);
    }
  }
  CHECK(rejected > 100);
}

TEST_CASE("pipeline/cull: without culling everything is visible") {
  std::mt19937 rng(44);
  for (int i = 0; i < 50; ++i) {
    const RandomView random = randomView(rng);
    Box3 far_away;
    far_away.extend(Vec3(1e4F));
    CHECK(viewInstance(random.instance, far_away, random.view, false).visible);
  }
}

TEST_CASE("pipeline/cull: the codes of a run hold for every member, on every SIMD target") {
  std::mt19937 rng(45);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  int rejected = 0, accepted = 0, behind = 0;
  for (int i = 0; i < 3000; ++i) {
    CAPTURE(i);
    const RandomView random = randomView(rng);
    const InstanceView view = viewInstance(random.instance, Box3(), random.view, false);
    const Vec3 center(2.0F * unit(rng), 2.0F * unit(rng), 2.0F * unit(rng));
    grouping::VertexRun run;
    const int axis = i % 3;
    run.kind = i % 4 == 3 ? grouping::RunKind::kLine : grouping::RunKind::kPlane;
    run.corner_lo = center - 0.5F * Vec3(unit(rng) + 1.0F, unit(rng) + 1.0F, unit(rng) + 1.0F);
    run.corner_hi = center + 0.5F * Vec3(unit(rng) + 1.0F, unit(rng) + 1.0F, unit(rng) + 1.0F);
    if (run.kind == grouping::RunKind::kPlane) run.corner_hi[axis] = run.corner_lo[axis];
    const RunCodes codes = codeRun(run, view.run_planes);
    forEachTarget([&] {
      RunCodes fast;
      codeRuns({&run, 1}, view.run_planes, &fast);
      CHECK(fast.must == codes.must);
      CHECK(fast.may == codes.may);
    });
    rejected += (codes.must & kOutsideBits) != 0;
    accepted += (codes.may & kClipBits) == 0;
    for (int k = 0; k < 40; ++k) {
      // The ends and corners first, where members really lie.
      const auto share = [&](int bit) { return k < 8 ? static_cast<float>(k >> bit & 1) : 0.5F + 0.5F * unit(rng); };
      Vec3 t(share(0), share(1), share(2));
      if (run.kind == grouping::RunKind::kLine) t = Vec3(t.x);
      const Vec3 p = run.corner_lo + t * (run.corner_hi - run.corner_lo);
      const Vec4 clip = transformVertex(p, view.clip_from_object);
      const std::int32_t code = outcodeVertex(clip, random.view.viewport);
      CHECK((codes.must & ~code) == 0);
      CHECK((code & ~codes.may) == 0);
      behind += clip.w < 0.0F;
    }
  }
  CHECK(rejected > 300);
  CHECK(accepted > 100);
  CHECK(behind > 10000);
}

TEST_CASE("pipeline/cull: the codes of a run in its patch's own frame hold for every member") {
  TaskPool pool(1);
  const mesh::Mesh mesh = grouping::tiltedHills(40, 0.2);
  grouping::PatchSet set = grouping::splitIntoPatches(mesh, {}, pool);
  const grouping::VertexGroups groups = grouping::groupInPatches(mesh, set, {.epsilon = 0.01}, pool);
  const grouping::PlacedVertices placed = grouping::placeInFrames(mesh, groups, set, grouping::ParameterForm::kFloat);
  const grouping::VertexRuns runs = grouping::buildVertexRuns(placed, 16, set, pool);
  std::mt19937 rng(46);
  int rejected = 0, accepted = 0;
  for (int i = 0; i < 200; ++i) {
    const RandomView random = randomView(rng);
    const InstanceView view = viewInstance(random.instance, Box3(), random.view, false);
    for (const grouping::PatchRuns& patch : runs.patches) {
      const RunPlanes planes = runPlanes(clipFromPlanes(runs, patch, view.clip_from_object), random.view.viewport);
      std::uint32_t parameter = patch.first_parameter;
      for (std::uint32_t r = patch.first_run; r < patch.first_run + patch.run_count; ++r) {
        const grouping::VertexRun& run = runs.runs[r];
        if (run.kind != grouping::RunKind::kPlane) continue;
        REQUIRE(patch.frame != grouping::kNoIndex);
        const RunCodes codes = codeRun(run, planes);
        rejected += (codes.must & kOutsideBits) != 0;
        accepted += (codes.may & kClipBits) == 0;
        for (std::uint32_t v = 0; v < run.vertex_count; ++v, ++parameter) {
          const Vec2 st = runs.parameters[parameter];
          const Vec4 clip = transformGrouped(runs, patch, run, {st.x, st.y}, view.clip_from_object);
          const std::int32_t code = outcodeVertex(clip, random.view.viewport);
          CHECK((codes.must & ~code) == 0);
          CHECK((code & ~codes.may) == 0);
        }
      }
    }
  }
  CHECK(rejected > 300);
  CHECK(accepted > 100);
}

TEST_CASE("pipeline/cull: a run that lies in a plane of the view volume is neither accepted nor rejected") {
  View view{DMat4(1.0), DVec4(0.0, 0.0, 1.0, 0.0), Viewport(64, 64)};  // clip space is object space
  const InstanceView instance = viewInstance({}, Box3(), view, false);
  grouping::VertexRun run{.kind = grouping::RunKind::kPlane, .corner_lo = {1, -0.5, 0.25}, .corner_hi = {1, 0.5, 0.75}};
  const RunCodes codes = codeRun(run, instance.run_planes);
  CHECK(codes.must == 0);
  CHECK(codes.may == kOutRight);
}

}  // namespace sheaf::pipeline
