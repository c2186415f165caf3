#include "pipeline/comparison.h"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/pipeline/scene_fixture.h"

namespace sheaf::pipeline {
namespace {

constexpr int kSize = 200;

scenes::Scene sceneOf(mesh::Mesh mesh) {
  scenes::Scene scene;
  scene.meshes.push_back(std::move(mesh));
  scene.materials.emplace_back();
  scene.materials.front().shading = scenes::Shading::kFlat;
  scene.materials.front().double_sided = true;
  scene.instances.emplace_back();
  return scene;
}

/// Two triangles of which a pair of corners has almost the same x, 0.03 apart, and no pair is as near in y or z: at
/// epsilon 4 % of the extent, 1.03, one corner of the pair moves to the other's x, and nothing else moves.
scenes::Scene leaningQuad() {
  mesh::Mesh quad;
  quad.positions = {{0.0F, 0.0F, 0.0F}, {1.0F, 0.1F, 0.3F}, {1.03F, 1.0F, 0.6F}, {0.2F, 0.9F, 0.9F}};
  quad.triangles = {{0, 1, 2}, {0, 2, 3}};
  return sceneOf(std::move(quad));
}

/// Looks along -Z or, from behind, along +Z, 100 pixels for each unit.
scenes::Camera straightCamera(const scenes::Scene& scene, double eye_z = 5.0) {
  scenes::Camera camera;
  camera.eye = {0.5, 0.5, eye_z};
  camera.target = {0.5, 0.5, 0.0};
  camera.orthographic_height = 2.0;
  return scenes::fitClipPlanes(camera, scenes::boundsOf(scene));
}

RenderSettings squarePicture() {
  RenderSettings settings;
  settings.width = settings.height = kSize;
  return settings;
}

GroupingOptions planarGroups(double epsilon) {
  GroupingOptions options;
  options.method = Grouping::kPlanar;
  options.epsilon = epsilon;
  options.form = ParameterForm::kFloat;
  options.prefer = Prefer::kMemory;
  return options;
}

}  // namespace

TEST_CASE("pipeline/comparison: a corner that moves by 3 pixels shifts the outline by 3 pixels") {
  TaskPool pool(2);
  const scenes::Scene scene = leaningQuad();
  const std::vector cameras = {straightCamera(scene)};
  const Comparison result = compareGrouping(scene, cameras, planarGroups(0.04), squarePicture(), pool);
  REQUIRE(result.views.size() == 1);
  const PictureDifference& quality = result.views.front().quality;
  CHECK(quality.pixels.differing_pixels > 0);
  CHECK(quality.silhouette.max_px >= 2.0);
  CHECK(quality.silhouette.max_px <= 4.0);
  CHECK(quality.silhouette.mean_px < 3.0);
  CHECK(result.geometry.vertices == 4);
  CHECK(result.geometry.grouped == 1);
  CHECK(result.geometry.eliminated() == 0.25);
  CHECK(result.geometry.displacement_max == doctest::Approx(0.03 / 1.03));
  CHECK(result.geometry.displacement_mean == doctest::Approx(0.03 / 1.03 / 4));
  CHECK(result.geometry.displacement_rms == doctest::Approx(0.03 / 1.03 / 2));
}

TEST_CASE("pipeline/comparison: drawing and quality are two questions: what moves a vertex is not a drawing error") {
  TaskPool pool(2);
  const scenes::Scene scene = leaningQuad();
  const std::vector cameras = {straightCamera(scene)};
  const Comparison result = compareGrouping(scene, cameras, planarGroups(0.04), squarePicture(), pool);
  CHECK(result.views.front().drawing.pixels.differing_pixels == 0);
  CHECK(result.drawsRight());
  CHECK(result.grouped == result.snapped);
  CHECK(result.grouped != result.original);
}

TEST_CASE("pipeline/comparison: one pixel off in one view is not right by planes, more than a hundredth not by lines") {
  Comparison result;
  result.views.resize(3);
  raster::ImageDifference& pixels = result.views[1].drawing.pixels;
  pixels.width = pixels.height = 100;
  result.grouping.method = Grouping::kPlanar;
  CHECK(result.drawsRight());
  pixels.differing_pixels = 1;
  CHECK(!result.drawsRight());
  result.grouping.method = Grouping::kLinear;
  CHECK(result.drawsRight());
  pixels.differing_pixels = 100;
  CHECK(result.drawsRight());
  pixels.differing_pixels = 101;
  CHECK(!result.drawsRight());
}

TEST_CASE(
    "pipeline/comparison: drawing by lines and by planes of patches differs in 0.02 % of the pixels, not in 1 %") {
  TaskPool pool(2);
  RenderSettings settings;
  settings.width = 640;
  settings.height = 360;
  for (const char* spec : {"teapot?n=8", "torusknot?u=90&v=16", "cornell?n=8"}) {
    CAPTURE(spec);
    const scenes::Scene scene = scenes::buildBuiltin(spec);
    const std::vector cameras = {usualCamera(scene, 640.0 / 360.0), insideCamera(scene)};
    for (const Grouping method : {Grouping::kLinear, Grouping::kCluster}) {
      GroupingOptions options = planarGroups(0.005);
      options.method = method;
      const Comparison result = compareGrouping(scene, cameras, options, settings, pool);
      CHECK(result.drawn_by_groups > 0.0);
      for (const ViewComparison& view : result.views) CHECK(view.drawing.pixels.differingFraction() <= 2e-4);
    }
  }
}

TEST_CASE("pipeline/comparison: where epsilon moves nothing, all pictures are equal") {
  TaskPool pool(2);
  const scenes::Scene scene = leaningQuad();
  const std::vector cameras = {straightCamera(scene)};
  const Comparison result = compareGrouping(scene, cameras, planarGroups(0.01), squarePicture(), pool);
  CHECK(result.geometry.grouped == 0);
  CHECK(result.views.front().quality.pixels.differing_pixels == 0);
  CHECK(std::isinf(result.views.front().quality.pixels.psnr_db));
  CHECK(result.views.front().quality.silhouette.max_px == 0.0);
  CHECK(result.original == result.grouped);
}

TEST_CASE("pipeline/comparison: the pictures kept are those of the worst view, of equal views the first") {
  TaskPool pool(2);
  const scenes::Scene scene = leaningQuad();
  scenes::Camera aside = straightCamera(scene);
  aside.eye.x += 100.0;
  aside.target.x += 100.0;
  const scenes::Camera front = straightCamera(scene);
  const std::vector cameras = {aside, front, front, aside};
  const Comparison result = compareGrouping(scene, cameras, planarGroups(0.04), squarePicture(), pool);
  REQUIRE(result.views.size() == 4);
  CHECK(result.worst_view == 1);
  CHECK(result.views[0].quality.pixels.differing_pixels == 0);
  CHECK(result.views[1].quality.pixels.rms == result.views[2].quality.pixels.rms);
  CHECK(raster::compareImages(result.original, result.grouped).rms == result.views[1].quality.pixels.rms);
}

TEST_CASE("pipeline/comparison: a scene without lights is lit from each camera, as a single picture would be") {
  TaskPool pool(2);
  const scenes::Scene scene = leaningQuad();
  const scenes::Camera back = straightCamera(scene, -5.0);
  const std::vector cameras = {straightCamera(scene), back};
  const Comparison result = compareGrouping(scene, cameras, planarGroups(0.04), squarePicture(), pool);
  const ReadyScene ready = makeReady(scene, cameras[result.worst_view], pool);
  Renderer renderer(pool);
  Frame frame;
  renderer.render(ready.prepared, ready.camera, squarePicture(), frame);
  CHECK(frame.color == result.original);
}

TEST_CASE("pipeline/comparison: built-in scenes are drawn right with groups, whatever the method") {
  TaskPool pool(2);
  for (const char* spec : {"teapot?n=6", "gallery"}) {
    scenes::Scene scene = scenes::buildBuiltin(spec);
    const std::vector cameras = {usualCamera(scene, 4.0 / 3.0), insideCamera(scene)};
    RenderSettings settings;
    settings.width = 160;
    settings.height = 120;
    for (const Grouping method : {Grouping::kPlanar, Grouping::kLinear}) {
      if (method == Grouping::kLinear && scene.vertexCount() > 3000) continue;  // slow to find
      CAPTURE(spec);
      GroupingOptions options;
      options.method = method;
      options.prefer = Prefer::kMemory;
      const Comparison result = compareGrouping(scene, cameras, options, settings, pool);
      CHECK(result.drawsRight());
      CHECK(result.geometry.eliminated() > 0.3);
      CHECK(result.geometry.displacement_max <= 0.00501);
      CHECK(result.original_bytes_per_vertex >= 12.0);
    }
  }
}

TEST_CASE("pipeline/comparison: figures of several meshes are put together by their vertices and triangles") {
  PreparedScene scene;
  scene.meshes.resize(2);
  PreparedMesh& a = scene.meshes[0];
  PreparedMesh& b = scene.meshes[1];
  a.grouping.vertices = 100;
  a.grouping.grouped = 90;
  a.grouping.displacement_max = 0.004;
  a.grouping.displacement_mean = 0.002;
  a.grouping.displacement_rms = 0.003;
  a.grouping.normal_deviation_max_rad = 0.5;
  a.grouping.normal_deviation_rms_rad = 0.1;
  a.grouping.flipped_faces = 2;
  a.triangle_count = 200;
  b.grouping.vertices = 300;
  b.grouping.grouped = 110;
  b.grouping.displacement_max = 0.001;
  b.grouping.normal_deviation_max_rad = 0.7;
  b.grouping.flipped_faces = 1;
  b.triangle_count = 600;
  const GeometricError error = geometricError(scene);
  CHECK(error.vertices == 400);
  CHECK(error.eliminated() == 0.5);
  CHECK(error.displacement_max == 0.004);
  CHECK(error.displacement_mean == doctest::Approx(0.0005));
  CHECK(error.displacement_rms == doctest::Approx(0.0015));
  CHECK(error.normal_deviation_max_rad == 0.7);
  CHECK(error.normal_deviation_rms_rad == doctest::Approx(0.05));
  CHECK(error.flipped_faces == 3);
  CHECK(geometricError({}).eliminated() == 0.0);
  CHECK(bytesPerVertex({}) == 0.0);
}

TEST_CASE("pipeline/comparison: side by side stand original, grouped and heat map, with gaps between") {
  Comparison comparison;
  comparison.original = Image8(4, 3, {10, 20, 30, 255});
  comparison.grouped = comparison.original;
  comparison.grouped.at(1, 2) = {200, 20, 30, 255};
  const Image8 picture = sideBySide(comparison);
  REQUIRE(picture.height() == 3);
  REQUIRE(picture.width() == 3 * 4 + 2 * kSideBySideGapPx);
  CHECK(picture.at(1, 2) == comparison.original.at(1, 2));
  CHECK(picture.at(4 + kSideBySideGapPx + 1, 2) == comparison.grouped.at(1, 2));
  const Image8 heat = raster::heatMap(comparison.original, comparison.grouped);
  CHECK(picture.at(2 * (4 + kSideBySideGapPx) + 1, 2) == heat.at(1, 2));
  CHECK(picture.at(2 * (4 + kSideBySideGapPx) + 3, 0) == heat.at(3, 0));
}

}  // namespace sheaf::pipeline
