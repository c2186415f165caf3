#include "cli/view.h"

#include <doctest/doctest.h>

#include "core/error.h"

namespace sheaf::cli {
namespace {

/// A unit square in the plane z = 0, its middle at the origin, and two cameras of its own.
scenes::Scene sampleScene() {
  scenes::Scene scene;
  mesh::Mesh square;
  square.positions = {{-0.5F, -0.5F, 0.0F}, {0.5F, -0.5F, 0.0F}, {0.5F, 0.5F, 0.0F}, {-0.5F, 0.5F, 0.0F}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.meshes = {square};
  scene.materials.emplace_back();
  scene.instances.emplace_back();
  scenes::Camera first;
  first.name = "first";
  first.eye = {0.0, 0.0, 7.0};
  scenes::Camera parallel = first;
  parallel.name = "parallel";
  parallel.orthographic_height = 3.0;
  scene.cameras = {first, parallel};
  return scene;
}

}  // namespace

TEST_CASE("cli/view: without a wish it is the scene's first camera, with near and far set") {
  const scenes::Camera camera = chooseCamera(sampleScene(), {}, 1.5);
  CHECK(camera.name == "first");
  CHECK(camera.near > 0.0);
  CHECK(camera.far > camera.near);
}

TEST_CASE("cli/view: a scene without cameras is seen from a corner") {
  scenes::Scene scene = sampleScene();
  scene.cameras.clear();
  const scenes::Camera camera = chooseCamera(scene, {}, 1.5);
  CHECK(camera.eye.x > 0.0);
  CHECK(camera.eye.y > 0.0);
  CHECK(camera.eye.z > 0.0);
}

TEST_CASE("cli/view: cameras of the file are chosen by name or number") {
  ViewRequest request;
  request.file_camera.emplace("parallel");
  CHECK(chooseCamera(sampleScene(), request, 1.0).orthographic_height == 3.0);
  request.file_camera.emplace("1");
  CHECK(chooseCamera(sampleScene(), request, 1.0).name == "parallel");
  request.file_camera.emplace("2");
  CHECK_THROWS_WITH_AS(chooseCamera(sampleScene(), request, 1.0), doctest::Contains("first"), Error);
  scenes::Scene none = sampleScene();
  none.cameras.clear();
  CHECK_THROWS_WITH_AS(chooseCamera(none, request, 1.0), doctest::Contains("no camera"), Error);
}

TEST_CASE("cli/view: --fov changes a perspective camera of the file and is refused for a parallel one") {
  ViewRequest request;
  request.fov_rad = 1.0;
  CHECK(chooseCamera(sampleScene(), request, 1.0).vertical_fov_rad == 1.0);
  request.file_camera.emplace("parallel");
  CHECK_THROWS_AS(chooseCamera(sampleScene(), request, 1.0), Error);
}

TEST_CASE("cli/view: an eye looks at the middle of the scene unless told otherwise") {
  ViewRequest request;
  request.eye = DVec3(1.0, 2.0, 3.0);
  CHECK(chooseCamera(sampleScene(), request, 1.0).target == DVec3(0.0));
  request.target = DVec3(0.0, 1.0, 0.0);
  CHECK(chooseCamera(sampleScene(), request, 1.0).target == DVec3(0.0, 1.0, 0.0));
}

TEST_CASE("cli/view: points are in the file's coordinates, also when +Z is up there") {
  ViewRequest request;
  request.z_up = true;
  request.eye = DVec3(1.0, 2.0, 3.0);
  request.up = DVec3(0.0, 0.0, 1.0);
  const scenes::Camera camera = chooseCamera(sampleScene(), request, 1.0);
  CHECK(camera.eye == DVec3(1.0, 3.0, -2.0));
  CHECK(camera.up == DVec3(0.0, 1.0, 0.0));
}

TEST_CASE("cli/view: an up direction along the line of sight and an eye in the middle are refused") {
  ViewRequest request;
  request.eye = DVec3(0.0, 5.0, 0.0);
  request.up = DVec3(0.0, 2.0, 0.0);
  CHECK_THROWS_AS(chooseCamera(sampleScene(), request, 1.0), Error);
  request.up.reset();
  request.eye = DVec3(0.0);
  CHECK_THROWS_AS(chooseCamera(sampleScene(), request, 1.0), Error);
}

TEST_CASE("cli/view: parallel projection from an eye is as tall as the perspective picture at the target") {
  ViewRequest request;
  request.eye = DVec3(0.0, 0.0, 2.0);
  request.fov_rad = kPi / 2;
  request.orthographic = true;
  CHECK(chooseCamera(sampleScene(), request, 1.0).orthographic_height == doctest::Approx(4.0));
}

}  // namespace sheaf::cli
