#include "pipeline/overlays.h"

#include <doctest/doctest.h>

#include <cstddef>
#include <glm/gtc/matrix_transform.hpp>
#include <numeric>
#include <vector>

#include "grouping/cluster_cuts.h"
#include "tests/grouping/shapes.h"
#include "tests/mesh/meshes.h"
#include "tests/pipeline/scene_fixture.h"

namespace sheaf::pipeline {
namespace {

constexpr double kWidestBarPx = 1.7;
constexpr int kHeightPx = 400;

// All of it in view.
OverlayView viewOf(const mesh::Mesh& mesh) {
  scenes::Scene scene;
  scene.meshes.push_back(mesh);
  scene.materials.emplace_back();
  scene.instances.emplace_back();
  return {usualCamera(scene, 1.0), kHeightPx};
}

// Of a bar in the world, at most.
double widestBar(const OverlayView& view, const mesh::Mesh& mesh) {
  const double farthest =
      glm::distance(view.camera.eye, DVec3(mesh::boundsOf(mesh).center())) + double{mesh::boundsOf(mesh).longestEdge()};
  return kWidestBarPx * farthest * 2.0 * std::tan(0.5 * view.camera.vertical_fov_rad) / view.height_px;
}

struct Clustered {
  mesh::Mesh mesh;
  grouping::FaceClusters clusters;
  grouping::ClusterCut cut;

  Clustered(mesh::Mesh of, std::uint32_t count) : mesh(std::move(of)) {
    TaskPool pool(1);
    clusters = grouping::clusterFaces(mesh, {}, pool);
    cut = grouping::cutByCount(clusters, count);
  }
};

double distanceTo(const mesh::Mesh& mesh, const DVec3& point) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& p : mesh.positions) least = std::min(least, glm::distance(DVec3(p), point));
  return least;
}

Clustered ball(std::uint32_t count) {
  std::mt19937 rng(0x0ba1);
  return {grouping::lumpyBall(rng, 20, 30, 0.01F), count};
}

}  // namespace

TEST_CASE("pipeline/overlays: the bars of a box run from corner to corner, and nowhere else") {
  const Clustered c = ball(9);
  const OverlayView view = viewOf(c.mesh);
  const double width = widestBar(view, c.mesh);
  const scenes::Scene overlay = clusterOverlay(c.mesh, c.clusters, c.cut, {.boxes = true}, view);
  REQUIRE(overlay.meshes.size() == 1);
  const mesh::Mesh& bars = overlay.meshes[0];
  CHECK(bars.triangleCount() == 9 * 12 * 12);
  for (std::size_t i = 0; i < c.cut.size(); ++i) {
    const grouping::ClusterShape s = grouping::shapeOf(c.mesh, c.clusters, c.cut[i]);
    const DMat3 axes(DVec3(s.frame.axis_s), DVec3(s.frame.axis_t), DVec3(s.frame.normal));
    for (int corner = 0; corner < 8; ++corner) {
      const DVec3 local((corner & 1) != 0 ? s.hi.x : s.lo.x, (corner & 2) != 0 ? s.hi.y : s.lo.y,
                        (corner & 4) != 0 ? s.hi.z : s.lo.z);
      CHECK(distanceTo(bars, DVec3(s.center) + axes * local) < width);
    }
    for (std::size_t v = i * 12 * 8; v < (i + 1) * 12 * 8; ++v) {
      const DVec3 local = glm::transpose(axes) * (DVec3(bars.positions[v]) - DVec3(s.center));
      int at_side = 0;
      for (int k = 0; k < 3; ++k) {
        CHECK(local[k] > double{s.lo[k]} - width);
        CHECK(local[k] < double{s.hi[k]} + width);
        at_side += std::min(std::abs(local[k] - double{s.lo[k]}), std::abs(local[k] - double{s.hi[k]})) < width;
      }
      CHECK(at_side == 3);  // every bar ends in a corner
    }
  }
}

TEST_CASE("pipeline/overlays: a plane is a lattice of bars in it, as large as the box") {
  const Clustered c = ball(5);
  const OverlayView view = viewOf(c.mesh);
  const double width = widestBar(view, c.mesh);
  const mesh::Mesh bars = clusterOverlay(c.mesh, c.clusters, c.cut, {.planes = true}, view).meshes[0];
  CHECK(bars.triangleCount() == 5 * 10 * 12);
  for (std::size_t v = 0; v < bars.vertexCount(); ++v) {
    const grouping::ClusterShape s = grouping::shapeOf(c.mesh, c.clusters, c.cut[v / 80]);
    CHECK(std::abs(glm::dot(DVec3(bars.positions[v]) - DVec3(s.center), DVec3(s.frame.normal))) < width);
  }
  const scenes::Scene both = clusterOverlay(c.mesh, c.clusters, c.cut, {.boxes = true, .planes = true}, view);
  CHECK(both.triangleCount() == 5 * 22 * 12);
}

TEST_CASE("pipeline/overlays: bars are seen where nothing is before them, and what is seen otherwise stays") {
  const Clustered c = ball(6);
  TaskPool pool(2);
  scenes::Scene scene;
  scene.meshes.push_back(c.mesh);
  scene.materials.emplace_back();
  scene.instances.emplace_back();
  const scenes::Camera camera = usualCamera(scene, 1.0);
  const RenderSettings settings = allChannels(150, 150);
  PreparedScene prepared = prepareScene(scene, pool);
  Frame plain, with_boxes, with_planes;
  Renderer(pool).render(prepared, camera, settings, plain);
  const auto draw = [&](const Overlay& what, Frame& frame) {
    PreparedScene covered = prepareScene(scene, pool);
    addOverlay(clusterOverlay(c.mesh, c.clusters, c.cut, what, {camera, 150}), covered, pool);
    CHECK(covered.instances.size() == 2);
    CHECK(covered.meshes.size() == 2);
    Renderer(pool).render(covered, camera, settings, frame);
    int bars = 0, changed = 0;
    for (int y = 0; y < 150; ++y)
      for (int x = 0; x < 150; ++x) {
        if (frame.instance_id.at(x, y) == 1) {
          ++bars;
          changed += frame.depth.at(x, y) < plain.depth.at(x, y);  // behind the surface
          changed += frame.color.at(x, y).r > 40;                  // dark in any light
        } else {
          changed +=
              frame.color.at(x, y) != plain.color.at(x, y) || frame.triangle_id.at(x, y) != plain.triangle_id.at(x, y);
        }
      }
    CHECK(changed == 0);
    return bars;
  };
  const int box_pixels = draw({.boxes = true}, with_boxes), plane_pixels = draw({.planes = true}, with_planes);
  CHECK(box_pixels > 300);
  CHECK(box_pixels < 150 * 150 / 5);
  CHECK(plane_pixels > 100);
}

TEST_CASE("pipeline/overlays: a bar is as wide in the picture near and far, seen in perspective and parallel") {
  TaskPool pool(1);
  // A floor that runs from just before the eye far into the distance, in one patch, seen from above its middle.
  scenes::Scene scene;
  mesh::Mesh floor;
  floor.positions = {{-1.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}, {1.0F, 0.0F, -60.0F}, {-1.0F, 0.0F, -60.0F}};
  floor.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.meshes.push_back(floor);
  scene.materials.emplace_back();
  scene.instances.emplace_back();
  scenes::Camera camera;
  camera.eye = DVec3(0.0, 1.0, 1.0);
  camera.target = DVec3(0.0, 0.0, -4.0);
  for (const double parallel_height : {0.0, 6.0})
    for (const int height : {150, 600}) {
      CAPTURE(parallel_height);
      CAPTURE(height);
      camera.orthographic_height = parallel_height;
      const scenes::Camera fitted = scenes::fitClipPlanes(camera, boundsOf(scene));
      PreparedScene prepared = prepareScene(scene, pool);
      addOverlay(patchBoxes(prepared, {fitted, height}), prepared, pool);
      Frame frame;
      Renderer(pool).render(prepared, fitted, allChannels(height, height), frame);
      // Rows cross the two long edges, one left and one right of the middle.
      std::vector<int> widths;  // far to near
      for (int y = 0; y < height; ++y) {
        int left = 0;
        for (int x = 0; x < height / 2 - 4; ++x) left += frame.instance_id.at(x, y) == 1;
        if (left == 0 || left > 8) continue;  // beyond the ends, or along one
        widths.push_back(left);
        CHECK(left <= 4);  // 1.6 pixels, at a slant
      }
      REQUIRE(static_cast<int>(widths.size()) > height / 8);
      const auto third = static_cast<std::ptrdiff_t>(widths.size() / 3);
      const double far = std::accumulate(widths.begin(), widths.begin() + third, 0.0) / double(third);
      const double near = std::accumulate(widths.end() - third, widths.end(), 0.0) / double(third);
      CHECK(near > 1.5);
      CHECK(far == doctest::Approx(near).epsilon(0.1));
    }
}

TEST_CASE("pipeline/overlays: bars on what is small in the picture are narrower, and none begins behind the eye") {
  const Clustered c = ball(1);
  const grouping::ClusterShape s = grouping::shapeOf(c.mesh, c.clusters, c.cut[0]);
  OverlayView view = viewOf(c.mesh);
  const double diagonal = glm::distance(DVec3(s.lo), DVec3(s.hi));
  view.camera.eye = view.camera.target + 1000.0 * (view.camera.eye - view.camera.target);  // less than a pixel
  const Box3 around = boundsOf(clusterOverlay(c.mesh, c.clusters, c.cut, {.boxes = true}, view));
  CHECK(double{around.longestEdge()} < 1.2 * diagonal);
  view.camera.eye = DVec3(s.center);
  view.camera.target = DVec3(s.center) + DVec3(0.0, 0.0, -1.0);
  view.camera.near = 0.01 * diagonal;
  const scenes::Scene inside = clusterOverlay(c.mesh, c.clusters, c.cut, {.boxes = true}, view);
  CHECK(inside.triangleCount() > 0);
  CHECK(inside.triangleCount() < 12 * 12);
  CHECK(double{boundsOf(inside).hi.z} < double{s.center.z});
}

TEST_CASE("pipeline/overlays: boxes of patches and planes of groups stand where the instances stand") {
  TaskPool pool(1);
  scenes::Scene scene;
  scene.meshes.push_back(mesh::makeGrid(30));
  scene.materials.emplace_back();
  const DMat4 moved = glm::translate(DMat4(1.0), DVec3(50.0, 0.0, 0.0)) * glm::scale(DMat4(1.0), DVec3(10.0));
  scene.instances = {{0, 0, DMat4(1.0)}, {0, 0, moved}};
  GroupingOptions planar;
  planar.method = Grouping::kPlanar;
  planar.prefer = Prefer::kMemory;
  const Box3 bounds = boundsOf(scene);
  const OverlayView view{usualCamera(scene, 1.0), kHeightPx};
  const PreparedScene prepared = prepareScene(std::move(scene), pool, planar);
  for (const bool of_groups : {false, true}) {
    const scenes::Scene overlay = of_groups ? groupPlanes(prepared, view) : patchBoxes(prepared, view);
    CHECK(overlay.triangleCount() == 2 * prepared.meshes[0].patches.size() * (of_groups ? 10 : 12) * 12);
    const Box3 around = boundsOf(overlay);
    CHECK(glm::distance(around.lo, bounds.lo) < 1.0F);  // 400 pixels show some 60
    CHECK(glm::distance(around.hi, bounds.hi) < 1.0F);
  }
}

TEST_CASE("pipeline/overlays: clusters of one face, of no size, and none") {
  const Clustered each(mesh::makeCube(), 12);
  CHECK(clusterOverlay(each.mesh, each.clusters, each.cut, {true, true}, viewOf(each.mesh)).triangleCount() ==
        12 * 22 * 12);
  mesh::Mesh point;
  point.positions.assign(3, Vec3(2.0F));
  point.triangles = {{0, 1, 2}};
  const Clustered single(point, 1);
  TaskPool pool(1);
  PreparedScene prepared;
  addOverlay(clusterOverlay(single.mesh, single.clusters, single.cut, {true, true}, viewOf(each.mesh)), prepared, pool);
  CHECK(prepared.instances.size() == 1);
  addOverlay(clusterOverlay({}, {}, {}, {true, true}, viewOf(each.mesh)), prepared, pool);
  CHECK(prepared.instances.size() == 2);
}

}  // namespace sheaf::pipeline
