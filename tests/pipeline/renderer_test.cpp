#include "pipeline/renderer.h"

#include <doctest/doctest.h>

#include <cmath>

#include "raster/image_compare.h"
#include "tests/pipeline/scene_fixture.h"
#include "tests/simd_targets.h"

namespace sheaf::pipeline {
namespace {

constexpr int kWidth = 131;
constexpr int kHeight = 97;

// A square of side 2 about the origin that looks towards +Z, two triangles.
scenes::Scene squareScene() {
  scenes::Scene scene;
  mesh::Mesh square;
  square.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.meshes.push_back(square);
  scene.materials.emplace_back();
  scene.materials[0].shading = scenes::Shading::kUnlit;
  scene.instances.emplace_back();
  return scene;
}

scenes::Camera cameraAt(const DVec3& eye, double near = 0.1, double far = 100.0) {
  scenes::Camera camera;
  camera.eye = eye;
  camera.near = near;
  camera.far = far;
  return camera;
}

std::size_t seenPixels(const Frame& frame) {
  std::size_t seen = 0;
  for (const std::uint32_t id : frame.instance_id.pixels()) seen += id != raster::kNoTriangle;
  return seen;
}

Frame draw(const PreparedScene& scene, const scenes::Camera& camera, TaskPool& pool,
           const RenderSettings& settings = allChannels(kWidth, kHeight)) {
  Frame frame;
  Renderer(pool).render(scene, camera, settings, frame);
  return frame;
}

}  // namespace

TEST_CASE("pipeline/renderer: every SIMD target and thread count draws the same bytes") {
  for (const char* spec : kSmallScenes) {
    CAPTURE(spec);
    TaskPool one(1);
    const ReadyScene ready = makeReady(spec, kWidth, kHeight, one);
    const Frame expected = draw(ready.prepared, ready.camera, one);
    CHECK(seenPixels(expected) > 1000);
    forEachTarget([&] {
      for (const int threads : {1, 2, 7}) {
        CAPTURE(threads);
        TaskPool pool(threads);
        CHECK(samePicture(draw(ready.prepared, ready.camera, pool), expected));
      }
    });
  }
}

TEST_CASE("pipeline/renderer: preparing with any number of threads gives the same picture") {
  for (const char* spec : {"gallery", "terrain?n=65"}) {
    TaskPool one(1);
    const ReadyScene expected = makeReady(spec, kWidth, kHeight, one);
    const Frame frame = draw(expected.prepared, expected.camera, one);
    for (const int threads : {2, 7}) {
      TaskPool pool(threads);
      const ReadyScene ready = makeReady(spec, kWidth, kHeight, pool);
      CHECK(samePicture(draw(ready.prepared, ready.camera, pool), frame));
    }
  }
}

TEST_CASE("pipeline/renderer: culling patches changes the work and not the picture, from outside and from within") {
  TaskPool pool(2);
  for (const char* spec : kSmallScenes) {
    CAPTURE(spec);
    scenes::Scene scene = scenes::buildBuiltin(spec);
    const scenes::Camera outside = usualCamera(scene, static_cast<double>(kWidth) / kHeight);
    const scenes::Camera inside = insideCamera(scene);
    const ReadyScene ready = makeReady(std::move(scene), outside, pool);
    for (const scenes::Camera& camera : {outside, inside}) {
      RenderSettings settings = allChannels(kWidth, kHeight);
      settings.culling = Culling::kNone;
      const Frame classic = draw(ready.prepared, camera, pool, settings);
      CHECK(classic.counters.patches_outside + classic.counters.patches_back_facing == 0);
      CHECK(classic.counters.boxes_tested == 0);
      for (const Culling culling : {Culling::kPatches, Culling::kTree}) {
        settings.culling = culling;
        const Frame culled = draw(ready.prepared, camera, pool, settings);
        CHECK(samePicture(culled, classic));
        CHECK(culled.counters.vertices_transformed <= classic.counters.vertices_transformed);
        CHECK(culled.counters.boxes_tested > 0);
      }
    }
  }
}

TEST_CASE("pipeline/renderer: every triangle and every pixel is accounted for") {
  TaskPool pool(2);
  for (const char* spec : kSmallScenes) {
    CAPTURE(spec);
    scenes::Scene scene = scenes::buildBuiltin(spec);
    const scenes::Camera inside = insideCamera(scene);
    const ReadyScene ready = makeReady(std::move(scene), inside, pool);
    for (const Culling culling : {Culling::kTree, Culling::kPatches, Culling::kNone}) {
      RenderSettings settings = allChannels(kWidth, kHeight);
      settings.culling = culling;
      const Frame frame = draw(ready.prepared, inside, pool, settings);
      const Counters& c = frame.counters;
      CHECK(c.pixels_shaded == seenPixels(frame));
      CHECK(c.pixels_shaded + c.pixels_background == kWidth * kHeight);
      CHECK(c.triangles_assembled <= c.triangles_in);
      // A clipped triangle leaves any number of pieces; all others end in exactly one way.
      const std::uint64_t ended =
          c.triangles_outside + c.triangles_back_facing + c.triangles_no_sample + c.triangles_binned;
      CHECK(ended + c.triangles_clipped >= c.triangles_assembled);
      if (c.triangles_clipped == 0) CHECK(ended == c.triangles_assembled);
      CHECK(c.tiles == 6);
    }
  }
}

TEST_CASE("pipeline/renderer: stage times add up") {
  TaskPool pool(2);
  const ReadyScene ready = makeReady("gallery", kWidth, kHeight, pool);
  RenderSettings settings = allChannels(kWidth, kHeight);
  settings.record_spans = true;
  const Frame frame = draw(ready.prepared, ready.camera, pool, settings);
  std::int64_t cpu = 0;
  std::int64_t wall = 0;
  for (std::size_t s = 0; s < kStageCount; ++s) {
    cpu += frame.cpu.ns[s];
    wall += frame.wall.ns[s];
  }
  CHECK(wall > 0);
  CHECK(wall <= frame.wall_ns);
  std::int64_t spans = 0;
  for (const StageSpan& span : frame.spans) {
    CHECK(span.worker >= 0);
    CHECK(span.worker < 2);
    spans += span.end_ns - span.begin_ns;
  }
  CHECK(spans == cpu);
}

TEST_CASE("pipeline/renderer: a square is where projection says, at the depth that it should have") {
  TaskPool pool(1);
  const PreparedScene scene = prepareScene(squareScene(), pool);
  scenes::Camera camera = cameraAt({0, 0, 4}, 2.0, 6.0);
  camera.vertical_fov_rad = 2.0 * std::atan(0.5);  // at distance 4 the picture is 4 high
  const Frame frame = draw(scene, camera, pool, allChannels(80, 80));
  // The square covers the middle half: pixels 20 to 59.
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < 80; ++x) {
      const bool expected = x >= 20 && x < 60 && y >= 20 && y < 60;
      CHECK((frame.instance_id.at(x, y) == 0) == expected);
      // Reversed depth: n (f - d) / (d (f - n)) = 2 * 2 / (4 * 4).
      CHECK(frame.depth.at(x, y) == doctest::Approx(expected ? 0.25 : 0.0));
    }
}

TEST_CASE("pipeline/renderer: back faces are culled, drawn when double-sided, and follow a mirroring transform") {
  TaskPool pool(1);
  const auto seenFrom = [&](double z, bool mirrored, bool double_sided) {
    scenes::Scene scene = squareScene();
    if (mirrored) scene.instances[0].world_from_object[0][0] = -1.0;
    scene.materials[0].double_sided = double_sided;
    return seenPixels(draw(prepareScene(std::move(scene), pool), cameraAt({0, 0, z}), pool));
  };
  const std::size_t full = seenFrom(4, false, false);
  CHECK(full > 1000);
  CHECK(seenFrom(-4, false, false) == 0);
  CHECK(seenFrom(-4, false, true) == full);
  // Mirroring along x leaves the side that is the front where it is: towards +Z.
  CHECK(seenFrom(4, true, false) == full);
  CHECK(seenFrom(-4, true, false) == 0);
  CHECK(seenFrom(-4, true, true) == full);
}

TEST_CASE("pipeline/renderer: a floor that passes under and behind the eye fills the picture below the horizon") {
  TaskPool pool(1);
  scenes::Scene scene = squareScene();
  // 2000 by 2000, lying flat, one below the eye.
  scene.instances[0].world_from_object =
      DMat4(DVec4(1000, 0, 0, 0), DVec4(0, 0, -1000, 0), DVec4(0, 1000, 0, 0), DVec4(0, -1, 0, 1));
  const PreparedScene prepared = prepareScene(std::move(scene), pool);
  scenes::Camera camera = cameraAt({0, 0, 0}, 0.01, 5000.0);
  camera.target = {0, 0, -1};
  for (const Culling culling : {Culling::kTree, Culling::kPatches, Culling::kNone}) {
    RenderSettings settings = allChannels(kWidth, kHeight);
    settings.culling = culling;
    const Frame frame = draw(prepared, camera, pool, settings);
    CHECK(frame.counters.triangles_clipped == 2);
    for (int y = 0; y < kHeight; ++y) {
      CAPTURE(y);
      // The far edge is 1 / 1000 below the horizon, much less than a pixel.
      for (int x = 0; x < kWidth; x += 13)
        CHECK((frame.instance_id.at(x, y) == 0) ==
              (y >= kHeight / 2 + 1 || (y == kHeight / 2 && frame.instance_id.at(x, y) == 0)));
    }
  }
}

TEST_CASE(
    "pipeline/renderer: a flat surface is lit like a smooth one with the same normals, clipped and mirrored too") {
  TaskPool pool(1);
  const auto colorOf = [&](scenes::Shading shading, bool mirrored, double z, double near) {
    scenes::Scene scene = squareScene();
    scene.meshes[0].normals.assign(4, Vec3(0.0F, 0.0F, 1.0F));
    scene.materials[0].shading = shading;
    scene.materials[0].double_sided = true;
    // Tilted, so that a near plane may cut it.
    scene.instances[0].world_from_object =
        DMat4(DVec4(mirrored ? -1.0 : 1.0, 0, 0, 0), DVec4(0, 0.8, 0.6, 0), DVec4(0, -0.6, 0.8, 0), DVec4(0, 0, 0, 1));
    scene.lights.push_back({glm::normalize(Vec3(0.2F, 0.3F, 1.0F)), Vec3(0.9F)});
    scene.ambient = {Vec3(0.05F), Vec3(0.02F)};
    return draw(prepareScene(std::move(scene), pool), cameraAt({0, 0, z}, near), pool);
  };
  for (const bool mirrored : {false, true})
    for (const double z : {4.0, -4.0})
      for (const double near : {0.1, 4.0}) {
        CAPTURE(mirrored);
        CAPTURE(z);
        CAPTURE(near);
        const Frame smooth = colorOf(scenes::Shading::kSmooth, mirrored, z, near);
        const Frame flat = colorOf(scenes::Shading::kFlat, mirrored, z, near);
        CHECK(seenPixels(flat) > 500);
        CHECK((smooth.counters.triangles_clipped > 0) == (near == 4.0));
        CHECK(raster::compareImages(smooth.color, flat.color).max_error <= 1);
        // Towards the light it is brighter than a side that only the hemisphere lights.
        const Rgba8 middle = flat.color.at(kWidth / 2, kHeight / 2);
        if (near == 0.1) CHECK((middle.r > 150) == (z > 0));
      }
}

TEST_CASE("pipeline/renderer: a scene without triangles is background") {
  TaskPool pool(2);
  scenes::Scene scene;
  scene.materials.emplace_back();
  scene.meshes.emplace_back();
  scene.instances.emplace_back();
  const PreparedScene prepared = prepareScene(std::move(scene), pool);
  for (const Culling culling : {Culling::kTree, Culling::kPatches, Culling::kNone}) {
    RenderSettings settings = allChannels(kWidth, kHeight);
    settings.culling = culling;
    const Frame frame = draw(prepared, cameraAt({0, 0, 1}), pool, settings);
    CHECK(frame.counters.pixels_background == kWidth * kHeight);
    CHECK(seenPixels(frame) == 0);
  }
}

TEST_CASE("pipeline/renderer: one renderer draws frames of changing size, scene and channels") {
  TaskPool pool(2);
  Renderer renderer(pool);
  Frame frame;
  const ReadyScene big = makeReady("gallery", 200, 150, pool);
  const ReadyScene small = makeReady("sphere?n=4", 33, 21, pool);
  for (int round = 0; round < 2; ++round) {
    renderer.render(big.prepared, big.camera, allChannels(200, 150), frame);
    CHECK(samePicture(frame, draw(big.prepared, big.camera, pool, allChannels(200, 150))));
    RenderSettings color_only;
    color_only.width = 33;
    color_only.height = 21;
    renderer.render(small.prepared, small.camera, color_only, frame);
    CHECK(frame.color.width() == 33);
    CHECK(frame.depth.empty());
    CHECK(frame.instance_id.empty());
    CHECK(frame.linear.empty());
  }
}

TEST_CASE("pipeline/renderer: a picture of one pixel, and one of a single row") {
  TaskPool pool(2);
  const ReadyScene ready = makeReady("sphere?n=8", 1, 1, pool);
  CHECK(draw(ready.prepared, ready.camera, pool, allChannels(1, 1)).counters.pixels_shaded == 1);
  const Frame row = draw(ready.prepared, ready.camera, pool, allChannels(300, 1));
  CHECK(row.counters.pixels_shaded + row.counters.pixels_background == 300);
}

}  // namespace sheaf::pipeline
