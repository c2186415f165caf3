#include "scenes/camera_path.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/error.h"
#include "core/file.h"
#include "scenes/builtin.h"
#include "scenes/camera.h"
#include "tests/temp_folder.h"

namespace sheaf::scenes {
namespace {

constexpr double kAspect = 1.5;

PathOptions usualOptions() {
  PathOptions options;
  options.azimuth_rad = radians(30.0);
  options.elevation_rad = radians(20.0);
  options.aspect = kAspect;
  return options;
}

/// `count` small triangles in a row along -Z, one at each whole number from 0 on.
Scene rowOfTriangles(int count) {
  Scene scene;
  mesh::Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const auto z = static_cast<float>(-i);
    const auto v = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {{-0.1F, -0.1F, z}, {0.1F, -0.1F, z}, {0.0F, 0.1F, z}});
    mesh.triangles.push_back({v, v + 1, v + 2});
  }
  scene.meshes.push_back(std::move(mesh));
  scene.materials.emplace_back();
  scene.instances.emplace_back();
  return scene;
}

}  // namespace

TEST_CASE("scenes/camera_path: an orbit goes round in equal steps, each camera fitted to the whole scene") {
  const Scene scene = buildBuiltin("torusknot?u=64&v=8");
  const std::vector<Camera> cameras = orbitPath(scene, 8, usualOptions());
  REQUIRE(cameras.size() == 8);
  for (std::size_t i = 0; i < 8; ++i) {
    CAPTURE(i);
    const Camera& camera = cameras[i];
    CHECK(shareInView(scene, camera, kAspect) == 1.0);
    const Camera fitted = fitCamera(scene, orbitView(radians(30.0 + 45.0 * static_cast<double>(i)), radians(20.0)),
                                    kAspect, camera.vertical_fov_rad, false);
    CHECK(glm::length(camera.eye - fitted.eye) < 1e-9);
  }
  CHECK(cameras[0].name == "30,20");
  CHECK(cameras[7].name == "345,20");
  PathOptions backwards = usualOptions();
  backwards.azimuth_rad = radians(-90.0);
  CHECK(orbitPath(scene, 4, backwards)[0].name == "270,20");
  CHECK(orbitPath(scene, 4, backwards)[1].name == "0,20");
}

TEST_CASE("scenes/camera_path: of triangles before and behind the eye the share before it is in view") {
  const Scene scene = rowOfTriangles(10);
  Camera camera;
  camera.eye = {0.0, 0.0, -2.5};
  camera.target = {0.0, 0.0, -3.5};
  camera.near = 0.01;
  camera.far = 100.0;
  CHECK(shareInView(scene, camera, kAspect) == 0.7);
  camera.far = 3.0;
  CHECK(shareInView(scene, camera, kAspect) == doctest::Approx(0.3));
  camera.target = {0.0, 0.0, 0.0};
  camera.far = 100.0;
  CHECK(shareInView(scene, camera, kAspect) == doctest::Approx(0.3));
  CHECK(shareInView(Scene{}, camera, kAspect) == 0.0);
}

TEST_CASE("scenes/camera_path: instances count where they stand") {
  Scene scene = rowOfTriangles(1);
  scene.instances.emplace_back();
  scene.instances.back().world_from_object[3] = DVec4(1000.0, 0.0, 0.0, 1.0);
  Camera camera;
  camera.eye = {0.0, 0.0, 5.0};
  camera.near = 0.1;
  camera.far = 100.0;
  CHECK(shareInView(scene, camera, kAspect) == 0.5);
}

TEST_CASE("scenes/camera_path: the wanted share of triangles is in view from inside") {
  const Scene scene = buildBuiltin("sphere?n=60");
  for (const double share : {0.05, 0.25, 0.5}) {
    const InsideView view = insideView(scene, share, usualOptions());
    CHECK(view.share_in_view == doctest::Approx(share).epsilon(0.02));
    CHECK(shareInView(scene, view.camera, kAspect) == view.share_in_view);
    CHECK(view.camera.near > 0.0);
    CHECK(glm::length(view.camera.eye) > 1.0);
  }
}

TEST_CASE("scenes/camera_path: the way inside ends before a surface that faces it, and goes on with a longer lens") {
  Scene scene = buildBuiltin("sphere?n=60");
  InsideView view = insideView(scene, 0.002, usualOptions());
  CHECK(view.share_in_view == doctest::Approx(0.002).epsilon(0.1));
  CHECK(glm::length(view.camera.eye) > 1.0);
  CHECK(view.camera.vertical_fov_rad < Camera{}.vertical_fov_rad);
  // Turned inside out it shows nothing from without, and is entered; mirrored as well it is as it was.
  for (mesh::Triangle& t : scene.meshes[0].triangles) std::swap(t[1], t[2]);
  view = insideView(scene, 0.05, usualOptions());
  CHECK(glm::length(view.camera.eye) < 1.0);
  CHECK(view.camera.vertical_fov_rad == Camera{}.vertical_fov_rad);
  for (mesh::Triangle& t : scene.meshes[0].triangles) std::swap(t[1], t[2]);
  scene.instances[0].world_from_object = DMat4(-1.0);
  scene.instances[0].world_from_object[3] = DVec4(0.0, 0.0, 0.0, 1.0);
  CHECK(glm::length(insideView(scene, 0.05, usualOptions()).camera.eye) > 1.0);
  scene.instances[0].world_from_object = DMat4(1.0);
  for (mesh::Triangle& t : scene.meshes[0].triangles) std::swap(t[1], t[2]);
  scene.materials[0].double_sided = true;
  CHECK(glm::length(insideView(scene, 0.05, usualOptions()).camera.eye) > 1.0);
}

TEST_CASE("scenes/camera_path: where the mesh has too few triangles for a share, what was reached is said") {
  const InsideView view = insideView(rowOfTriangles(3), 0.05, usualOptions());
  CHECK((view.share_in_view == 0.0 || view.share_in_view == doctest::Approx(1.0 / 3)));
  CHECK(insideView(Scene{}, 0.5, usualOptions()).share_in_view == 0.0);
}

TEST_CASE("scenes/camera_path: a flight begins with all in view and ends inside") {
  for (const char* spec : {"terrain?n=65", "teapot?n=4", "sphere?n=20"}) {
    CAPTURE(spec);
    const Scene scene = buildBuiltin(spec);
    const std::vector<Camera> cameras = flyPath(scene, 30, usualOptions());
    REQUIRE(cameras.size() == 30);
    CHECK(shareInView(scene, cameras.front(), kAspect) > 0.9);
    CHECK(shareInView(scene, cameras.back(), kAspect) < 0.8);
    for (std::size_t i = 1; i < cameras.size(); ++i)
      CHECK(glm::length(cameras[i].eye - cameras[i - 1].eye) < 0.1 * double{boundsOf(scene).longestEdge()});
  }
  CHECK(flyPath(Scene{}, 2, usualOptions()).size() == 2);
}

TEST_CASE("scenes/camera_path: cameras are read from JSON, missing parts have their defaults") {
  const TempFolder folder;
  folder.write("c.json", R"([{"eye": [1, 2, 3], "target": [0, 0.5, 0]},
    {"name": "top", "eye": [0, 9, 0], "target": [0, 0, 0], "up": [0, 0, -1], "orthographic_height": 4},
    {"eye": [0, 0, 1], "target": [0, 0, 0], "vertical_fov_degrees": 90}])");
  const std::vector<Camera> cameras = readCameras(folder.file("c.json"));
  REQUIRE(cameras.size() == 3);
  CHECK(cameras[0].eye == DVec3(1.0, 2.0, 3.0));
  CHECK(cameras[0].target == DVec3(0.0, 0.5, 0.0));
  CHECK(cameras[0].name == "0");
  CHECK(cameras[0].vertical_fov_rad == Camera{}.vertical_fov_rad);
  CHECK(cameras[1].name == "top");
  CHECK(cameras[1].orthographic_height == 4.0);
  CHECK(cameras[2].vertical_fov_rad == doctest::Approx(kPi / 2));
}

TEST_CASE("scenes/camera_path: a camera file that is not sound is refused with its name, the camera and the reason") {
  const TempFolder folder;
  const std::pair<const char*, const char*> bad[] = {
      {"", "parse error"},
      {"{", "parse error"},
      {"[]", "array of cameras"},
      {"{}", "array of cameras"},
      {"[7]", "camera 0: is not an object"},
      {R"([{"target": [0,0,0]}])", "camera 0: eye is missing"},
      {R"([{"eye": [0,0], "target": [0,0,0]}])", "eye: is not an array of three"},
      {R"([{"eye": [0,0,"x"], "target": [0,0,0]}])", "eye: is not a number"},
      {R"([{"eye": [0,0,1e999], "target": [0,0,0]}])", "c.json"},
      {R"([{"eye": [0,0,1], "target": [0,0,1]}])", "same point"},
      {R"([{"eye": [0,1,0], "target": [0,0,0]}])", "line of sight"},
      {R"([{"eye": [0,0,1], "target": [0,0,0], "up": [0,0,0]}])", "up is zero"},
      {R"([{"eye": [0,0,1], "target": [0,0,0], "vertical_fov_degrees": 0}])", "within 1 to 170"},
      {R"([{"eye": [0,0,1], "target": [0,0,0], "orthographic_height": -1}])", "above 0"},
      {R"([{"eye": [0,0,1], "target": [0,0,0], "orthographic_height": 1, "vertical_fov_degrees": 9}])", "has both"},
      {R"([{"eye": [0,0,1], "target": [0,0,0]}, {"eye": [0,0,1], "target": [0,0,0], "fov": 9}])",
       "camera 1: unknown key \"fov\""},
      {R"([{"eye": [0,0,1], "target": [0,0,0], "name": 3}])", "name: is not a string"},
  };
  for (const auto& [text, reason] : bad) {
    CAPTURE(text);
    folder.write("c.json", text);
    CHECK_THROWS_WITH_AS(readCameras(folder.file("c.json")), doctest::Contains(reason), Error);
    CHECK_THROWS_WITH_AS(readCameras(folder.file("c.json")), doctest::Contains("c.json"), Error);
  }
  CHECK_THROWS_AS(readCameras(folder.file("none.json")), Error);
}

}  // namespace sheaf::scenes
