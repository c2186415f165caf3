// Drawing by groups against drawing the same snapped mesh without them.
#include <doctest/doctest.h>

#include <string>
#include <utility>
#include <vector>

#include "raster/image_compare.h"
#include "tests/pipeline/scene_fixture.h"
#include "tests/simd_targets.h"

namespace sheaf::pipeline {
namespace {

constexpr int kWidth = 131;
constexpr int kHeight = 97;

GroupingOptions planar(double epsilon, ParameterForm form = ParameterForm::k16Bit) {
  GroupingOptions options;
  options.method = Grouping::kPlanar;
  options.epsilon = epsilon;
  options.form = form;
  options.prefer = Prefer::kMemory;  // so that small scenes are drawn by planes
  return options;
}

GroupingOptions ungrouped(GroupingOptions options) {
  options.use_groups = false;
  return options;
}

PreparedScene prepare(scenes::Scene scene, const scenes::Camera& camera, const GroupingOptions& options,
                      TaskPool& pool) {
  if (scene.lights.empty()) scenes::addDefaultLights(scene, camera);
  return prepareScene(std::move(scene), pool, options);
}

Frame draw(const PreparedScene& scene, const scenes::Camera& camera, TaskPool& pool, bool cull = true) {
  RenderSettings settings = allChannels(kWidth, kHeight);
  settings.culling = cull ? Culling::kTree : Culling::kNone;
  Frame frame;
  Renderer(pool).render(scene, camera, settings, frame);
  return frame;
}

// From outside, from within, close to the near plane, and without perspective.
std::vector<scenes::Camera> camerasFor(const scenes::Scene& scene) {
  const scenes::Camera outside = usualCamera(scene, static_cast<double>(kWidth) / kHeight);
  scenes::Camera close = outside;
  close.eye = glm::mix(outside.eye, outside.target, 0.8);
  close = scenes::fitClipPlanes(close, scenes::boundsOf(scene));
  close.near = 0.2 * glm::length(outside.eye - outside.target);  // through the scene
  scenes::Camera parallel = outside;
  parallel.orthographic_height = 0.4 * glm::length(outside.eye - outside.target);
  return {outside, insideCamera(scene), close, parallel};
}

}  // namespace

TEST_CASE("pipeline/grouped: by planes, grouped and ungrouped drawing of the snapped mesh are the same bytes") {
  constexpr std::pair<ParameterForm, double> kForms[] = {{ParameterForm::k16Bit, 0.0},   {ParameterForm::k16Bit, 0.005},
                                                         {ParameterForm::k16Bit, 0.05},  {ParameterForm::k16Bit, 2.0},
                                                         {ParameterForm::kFloat, 0.005}, {ParameterForm::kFloat, 2.0}};
  TaskPool pool(2);
  std::uint64_t grouped_vertices = 0, outside = 0, inside = 0;
  for (const char* spec : kSmallScenes) {
    CAPTURE(spec);
    const scenes::Scene scene = scenes::buildBuiltin(spec);
    const std::vector<scenes::Camera> cameras = camerasFor(scene);
    int draws = 0;
    for (const auto& [form, epsilon] : kForms) {
      CAPTURE(epsilon);
      const GroupingOptions options = planar(epsilon, form);
      const PreparedScene by_groups = prepare(scene, cameras[0], options, pool);
      const PreparedScene in_full = prepare(scene, cameras[0], ungrouped(options), pool);
      for (const scenes::Camera& camera : cameras) {
        // Each camera with culling in one form and without in the next.
        const bool cull = draws++ % 2 == 0;
        CAPTURE(cull);
        const Frame grouped = draw(by_groups, camera, pool, cull);
        const Frame expected = draw(in_full, camera, pool, cull);
        CHECK(samePicture(grouped, expected));
        CHECK(expected.counters.vertices_grouped == 0);
        grouped_vertices += grouped.counters.vertices_grouped;
        outside += grouped.counters.groups_outside;
        inside += grouped.counters.groups_inside;
      }
      ++draws;
    }
  }
  CHECK(grouped_vertices > 100000);
  CHECK(outside > 300);
  CHECK(inside > 300);
}

TEST_CASE("pipeline/grouped: a small mesh is stored by planes to save memory, and in full for speed") {
  TaskPool pool(2);
  const scenes::Scene scene = scenes::buildBuiltin("terrain?n=129");
  const scenes::Camera camera = insideCamera(scene);
  GroupingOptions options = planar(0.01);
  const PreparedScene small = prepare(scene, camera, options, pool);
  options.prefer = Prefer::kSpeed;
  const PreparedScene fast = prepare(scene, camera, options, pool);
  CHECK(fast.meshes[0].vertices.isFullBySlot());
  CHECK(fast.meshes[0].vertices.runs.size() == fast.meshes[0].patches.size());
  CHECK(small.meshes[0].vertexBytes() * 4 < fast.meshes[0].vertexBytes() * 3);
  CHECK(samePicture(draw(small, camera, pool), draw(fast, camera, pool)));
}

TEST_CASE("pipeline/grouped: every SIMD target and thread count draws the same bytes") {
  for (const char* spec : {"cornell?n=6", "terrain?n=33"}) {
    CAPTURE(spec);
    const scenes::Scene scene = scenes::buildBuiltin(spec);
    const scenes::Camera camera = insideCamera(scene);
    for (const Grouping method : {Grouping::kPlanar, Grouping::kLinear, Grouping::kCluster}) {
      GroupingOptions options = planar(0.01);
      options.method = method;
      TaskPool one(1);
      const PreparedScene prepared = prepare(scene, camera, options, one);
      const Frame expected = draw(prepared, camera, one);
      TaskPool seven(7);
      CHECK(samePicture(draw(prepare(scene, camera, options, seven), camera, seven), expected));
      forEachTarget([&] {
        CHECK(samePicture(draw(prepared, camera, one), expected));
        CHECK(samePicture(draw(prepared, camera, seven), expected));
      });
    }
  }
}

TEST_CASE(
    "pipeline/grouped: at epsilon 0 a mesh without common coordinates keeps its vertices and its picture but for the "
    "grid") {
  TaskPool pool(2);
  scenes::Scene scene = scenes::buildBuiltin("teapot?n=6");
  std::uint32_t seed = 1;
  for (mesh::Mesh& mesh : scene.meshes)
    for (Vec3& p : mesh.positions)
      for (int k = 0; k < 3; ++k)
        p[k] += 1e-5F * static_cast<float>((seed = seed * 1664525U + 1013904223U) >> 8) / 65536.0F;
  const scenes::Camera camera = usualCamera(scene, static_cast<double>(kWidth) / kHeight);
  const Frame original = draw(prepare(scene, camera, {}, pool), camera, pool);
  const PreparedScene prepared = prepare(scene, camera, planar(0.0), pool);
  CHECK(prepared.meshes[0].grouping.grouped < prepared.meshes[0].grouping.vertices / 20);
  CHECK(raster::compareImages(draw(prepared, camera, pool).color, original.color).differing_pixels <
        kWidth * kHeight / 100);
}

TEST_CASE("pipeline/grouped: by lines, what differs from the ungrouped snapped mesh is round-off") {
  TaskPool pool(2);
  for (const char* spec : {"teapot?n=4", "terrain?n=33", "cornell?n=6"}) {
    CAPTURE(spec);
    const scenes::Scene scene = scenes::buildBuiltin(spec);
    const std::vector<scenes::Camera> cameras = camerasFor(scene);
    GroupingOptions options = planar(0.005);
    options.method = Grouping::kLinear;
    const PreparedScene by_groups = prepare(scene, cameras[0], options, pool);
    const PreparedScene in_full = prepare(scene, cameras[0], ungrouped(options), pool);
    for (const scenes::Camera& camera : cameras) {
      const Frame grouped = draw(by_groups, camera, pool);
      const Frame expected = draw(in_full, camera, pool);
      CHECK(grouped.counters.vertices_grouped > 0);
      // V1' + s L' rounds otherwise than M (V1 + s L), by a few units in the last place: less than a subpixel, so that
      // only pixels whose centres lie within that of an edge can show another triangle.
      const raster::ImageDifference difference = raster::compareImages(grouped.color, expected.color);
      CHECK(difference.differing_pixels <= 50);  // 38 seen where the near plane cuts the scene, else 2 at most
    }
  }
}

// As for lines; in the space of a patch, sums have other terms.
TEST_CASE("pipeline/grouped: by planes of patches, what differs from the ungrouped snapped mesh is round-off") {
  TaskPool pool(2);
  std::uint64_t grouped_vertices = 0, outside = 0, inside = 0;
  for (const char* spec : kSmallScenes) {
    CAPTURE(spec);
    const scenes::Scene scene = scenes::buildBuiltin(spec);
    const std::vector<scenes::Camera> cameras = camerasFor(scene);
    for (const auto& [form, epsilon] : {std::pair{ParameterForm::k16Bit, 0.005}, {ParameterForm::kFloat, 0.02}}) {
      GroupingOptions options = planar(epsilon, form);
      options.method = Grouping::kCluster;
      options.prefer = Prefer::kMemory;
      const PreparedScene by_groups = prepare(scene, cameras[0], options, pool);
      const PreparedScene in_full = prepare(scene, cameras[0], ungrouped(options), pool);
      for (const scenes::Camera& camera : cameras) {
        // With culling in every second view. Cones are those of the original surface, so that with and without may
        // differ.
        const bool cull = &camera == &cameras[0] || &camera == &cameras[2];
        const Frame grouped = draw(by_groups, camera, pool, cull);
        const Frame expected = draw(in_full, camera, pool, cull);
        CHECK(expected.counters.vertices_grouped == 0);
        CHECK(raster::compareImages(grouped.color, expected.color).differing_pixels <= 10);  // 4 at most were seen
        grouped_vertices += grouped.counters.vertices_grouped;
        outside += grouped.counters.groups_outside;
        inside += grouped.counters.groups_inside;
      }
    }
  }
  CHECK(grouped_vertices > 10000);
  CHECK(outside > 10);
  CHECK(inside > 10);
}

// The same vertices in another frame: what falls outside, is clipped or culled must not depend on the space of the
// test.
TEST_CASE("pipeline/grouped: planes of patches, far from the mesh's origin, mirrored and unevenly scaled") {
  TaskPool pool(1);
  scenes::Scene scene = scenes::buildBuiltin("teapot?n=6");
  DMat4 mirror(1.0);
  mirror[0][0] = -2.0;
  mirror[1][1] = 0.3;
  mirror[3] = DVec4(2000.5, 1.0, -0.5, 1.0);
  for (mesh::Mesh& mesh : scene.meshes)
    for (Vec3& p : mesh.positions) p.x += 1000.0F;
  scene.instances[0].world_from_object = mirror * scene.instances[0].world_from_object;
  GroupingOptions options = planar(0.02);
  options.method = Grouping::kCluster;
  for (const scenes::Camera& camera : camerasFor(scene)) {
    const Frame grouped = draw(prepare(scene, camera, options, pool), camera, pool);
    CHECK(grouped.counters.vertices_grouped > 0);
    const Frame expected = draw(prepare(scene, camera, ungrouped(options), pool), camera, pool);
    // A thousand units away, floats are a thousand times as coarse as the mesh: 14 to 64 were seen.
    CHECK(raster::compareImages(grouped.color, expected.color).differing_pixels <= 100);
  }
}

TEST_CASE("pipeline/grouped: mirrored and unevenly scaled instances") {
  TaskPool pool(1);
  scenes::Scene scene = scenes::buildBuiltin("teapot?n=6");
  DMat4 mirror(1.0);
  mirror[0][0] = -2.0;
  mirror[1][1] = 0.3;
  mirror[3] = DVec4(0.5, 1.0, -0.5, 1.0);
  scene.instances[0].world_from_object = mirror * scene.instances[0].world_from_object;
  for (const scenes::Camera& camera : camerasFor(scene)) {
    const GroupingOptions options = planar(0.01);
    CHECK(samePicture(draw(prepare(scene, camera, options, pool), camera, pool),
                      draw(prepare(scene, camera, ungrouped(options), pool), camera, pool)));
  }
}

TEST_CASE("pipeline/grouped: the quadric metric draws the same bytes grouped and ungrouped") {
  TaskPool pool(1);
  const scenes::Scene scene = scenes::buildBuiltin("teapot?n=6");
  GroupingOptions options = planar(0.01);
  options.metric = grouping::Metric::kQuadric;
  for (const scenes::Camera& camera : camerasFor(scene))
    CHECK(samePicture(draw(prepare(scene, camera, options, pool), camera, pool),
                      draw(prepare(scene, camera, ungrouped(options), pool), camera, pool)));
}

}  // namespace sheaf::pipeline
