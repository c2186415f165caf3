#include "pipeline/overlays.h"

#include <doctest/doctest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "grouping/cluster_cuts.h"
#include "tests/grouping/shapes.h"
#include "tests/mesh/meshes.h"
#include "tests/pipeline/scene_fixture.h"

namespace sheaf::pipeline {
namespace {

constexpr double kWidestBar = 0.004;  // of the extent

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
  const double width = kWidestBar * double{mesh::boundsOf(c.mesh).longestEdge()};
  const scenes::Scene overlay = clusterOverlay(c.mesh, c.clusters, c.cut, {.boxes = true});
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
  const double width = kWidestBar * double{mesh::boundsOf(c.mesh).longestEdge()};
  const mesh::Mesh bars = clusterOverlay(c.mesh, c.clusters, c.cut, {.planes = true}).meshes[0];
  CHECK(bars.triangleCount() == 5 * 10 * 12);
  for (std::size_t v = 0; v < bars.vertexCount(); ++v) {
    const grouping::ClusterShape s = grouping::shapeOf(c.mesh, c.clusters, c.cut[v / 80]);
    CHECK(std::abs(glm::dot(DVec3(bars.positions[v]) - DVec3(s.center), DVec3(s.frame.normal))) < width);
  }
  const scenes::Scene both = clusterOverlay(c.mesh, c.clusters, c.cut, {.boxes = true, .planes = true});
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
    addOverlay(clusterOverlay(c.mesh, c.clusters, c.cut, what), covered, pool);
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
  const PreparedScene prepared = prepareScene(std::move(scene), pool, planar);
  for (const bool of_groups : {false, true}) {
    const scenes::Scene overlay = of_groups ? groupPlanes(prepared) : patchBoxes(prepared);
    REQUIRE(overlay.instances.size() == 2);
    CHECK(overlay.instances[1].world_from_object == moved);
    CHECK(overlay.meshes[0].triangleCount() == prepared.meshes[0].patches.size() * (of_groups ? 10 : 12) * 12);
    const Box3 around = boundsOf(overlay);
    CHECK(glm::distance(around.lo, bounds.lo) < 1.0F);  // 0.4 % of 60
    CHECK(glm::distance(around.hi, bounds.hi) < 1.0F);
  }
}

TEST_CASE("pipeline/overlays: clusters of one face, of no size, and none") {
  const Clustered each(mesh::makeCube(), 12);
  CHECK(clusterOverlay(each.mesh, each.clusters, each.cut, {true, true}).triangleCount() == 12 * 22 * 12);
  mesh::Mesh point;
  point.positions.assign(3, Vec3(2.0F));
  point.triangles = {{0, 1, 2}};
  const Clustered single(point, 1);
  TaskPool pool(1);
  PreparedScene prepared;
  addOverlay(clusterOverlay(single.mesh, single.clusters, single.cut, {true, true}), prepared, pool);
  CHECK(prepared.instances.size() == 1);
  addOverlay(clusterOverlay({}, {}, {}, {true, true}), prepared, pool);
  CHECK(prepared.instances.size() == 2);
}

}  // namespace sheaf::pipeline
