#include "scenes/camera.h"

#include <doctest/doctest.h>

#include <random>
#include <set>

#include "core/error.h"

namespace sheaf::scenes {
namespace {

constexpr double kFov = radians(40.0);

/// Uniform in [lo, hi): from raw outputs, which the standard fixes.
double uniform(std::mt19937& random, double lo, double hi) {
  return lo + (hi - lo) * (static_cast<double>(random()) * 0x1p-32);
}

DMat4 randomAffine(std::mt19937& random, double scale, bool mirrored) {
  DMat4 m(1.0);
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) m[c][r] = scale * uniform(random, -1.0, 1.0);
  for (int r = 0; r < 3; ++r) m[3][r] = uniform(random, -5.0, 5.0);
  if ((glm::determinant(DMat3(m)) < 0.0) != mirrored) m[0] = -m[0];
  return m;
}

/// Random triangles, plus a vertex far away that no triangle uses.
mesh::Mesh randomMesh(std::mt19937& random, int triangles) {
  mesh::Mesh m;
  for (int i = 0; i < 3 * triangles; ++i)
    m.positions.emplace_back(uniform(random, -1.0, 1.0), uniform(random, -0.3, 2.0), uniform(random, -0.6, 0.5));
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(triangles); ++i)
    m.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  m.positions.emplace_back(1e6F, -1e6F, 1e6F);
  return m;
}

Scene randomScene(std::mt19937& random, int instances, double scale) {
  Scene scene;
  scene.materials.emplace_back();
  for (int i = 0; i < 3; ++i) scene.meshes.push_back(randomMesh(random, 20));
  for (int i = 0; i < instances; ++i) {
    // Nested placements are products; every second one is mirrored.
    const DMat4 parent = randomAffine(random, 0.8, false);
    scene.instances.push_back({static_cast<std::uint32_t>(i % 3), 0, parent * randomAffine(random, scale, i % 2 != 0)});
  }
  return scene;
}

Scene pointScene(const std::vector<Vec3>& points) {
  Scene scene;
  scene.materials.emplace_back();
  mesh::Mesh m;
  m.positions = points;
  for (std::uint32_t i = 0; i < points.size(); ++i) m.triangles.push_back({i, i, i});
  scene.meshes.push_back(m);
  scene.instances.emplace_back();
  return scene;
}

/// Extreme x/w, y/w and z/w over the vertices that triangles use, and the least w.
struct Projected {
  DVec3 lo{1e300};
  DVec3 hi{-1e300};
  double least_w = 1e300;
};

Projected project(const Scene& scene, const Camera& camera, double aspect) {
  Projected result;
  const DMat4 clip_from_world = clipFromView(camera, aspect) * viewFromWorld(camera);
  for (const Instance& instance : scene.instances)
    for (const mesh::Triangle& t : scene.meshes[instance.mesh].triangles)
      for (const std::uint32_t v : t) {
        const DVec3 object(scene.meshes[instance.mesh].positions[v]);
        const DVec4 clip = clip_from_world * (instance.world_from_object * DVec4(object, 1.0));
        result.lo = glm::min(result.lo, DVec3(clip) / clip.w);
        result.hi = glm::max(result.hi, DVec3(clip) / clip.w);
        result.least_w = std::min(result.least_w, clip.w);
      }
  return result;
}

void checkFit(const Scene& scene, const ViewDirection& view, double aspect, bool orthographic, double margin) {
  const Camera camera = fitClipPlanes(fitCamera(scene, view, aspect, kFov, orthographic, margin), boundsOf(scene));
  CAPTURE(aspect);
  CAPTURE(orthographic);
  CAPTURE(margin);
  CHECK(camera.near > 0.0);
  CHECK(camera.far > camera.near);
  const Projected p = project(scene, camera, aspect);
  const double limit = 1.0 - 2.0 * margin;
  CHECK(p.least_w > 0.0);
  CHECK(p.lo.z > 0.0);
  CHECK(p.hi.z < 1.0);
  for (int axis = 0; axis < 2; ++axis) {
    CHECK(p.lo[axis] >= -limit - 1e-9);
    CHECK(p.hi[axis] <= limit + 1e-9);
    CHECK(p.lo[axis] + p.hi[axis] == doctest::Approx(0.0).epsilon(1e-6));  // in the middle
  }
  // The tightest: one axis is filled from margin to margin.
  CHECK(std::max(p.hi.x, p.hi.y) == doctest::Approx(limit).epsilon(1e-6));
  CHECK(std::min(p.lo.x, p.lo.y) == doctest::Approx(-limit).epsilon(1e-6));
}

}  // namespace

TEST_CASE("scenes/camera: a fitted camera sees every vertex within the margin and none could be closer") {
  std::mt19937 random(1);
  for (int round = 0; round < 25; ++round) {
    const Scene scene = randomScene(random, 1 + round % 7, 1.0);
    const ViewDirection view = orbitView(uniform(random, -4.0, 4.0), uniform(random, -1.5, 1.5));
    const double aspect = std::exp(uniform(random, -1.5, 1.5));
    for (const bool orthographic : {false, true})
      for (const double margin : {0.0, 0.05, 0.3}) checkFit(scene, view, aspect, orthographic, margin);
  }
}

TEST_CASE("scenes/camera: every named view fits") {
  std::mt19937 random(2);
  const Scene scene = randomScene(random, 5, 1.0);
  for (const std::string& name : namedViews()) {
    CAPTURE(name);
    for (const bool orthographic : {false, true}) checkFit(scene, namedView(name), 16.0 / 9.0, orthographic, 0.05);
  }
}

TEST_CASE("scenes/camera: thousands of instances fit as exactly as one") {
  std::mt19937 random(3);
  const Scene scene = randomScene(random, 3000, 0.2);
  checkFit(scene, namedView("iso"), 1.5, false, 0.05);
  checkFit(scene, namedView("iso"), 1.5, true, 0.05);
}

TEST_CASE("scenes/camera: far from the origin and at any size the fit holds") {
  std::mt19937 random(4);
  for (const double size : {1e-4, 1.0, 1e5}) {
    Scene scene = randomScene(random, 3, 1.0);
    for (Instance& i : scene.instances)
      i.world_from_object = DMat4(DVec4(size, 0, 0, 0), DVec4(0, size, 0, 0), DVec4(0, 0, size, 0),
                                  DVec4(2000.0 * size, -500.0 * size, 800.0 * size, 1)) *
                            i.world_from_object;
    checkFit(scene, namedView("iso-left"), 1.0, false, 0.1);
    checkFit(scene, namedView("iso-left"), 1.0, true, 0.1);
  }
}

TEST_CASE("scenes/camera: a single point, a line along the view and a flat scene get sound cameras") {
  const std::vector<std::vector<Vec3>> scenes = {
      {Vec3(3.0F, 4.0F, 5.0F)},
      {Vec3(0.0F, 0.0F, -2.0F), Vec3(0.0F, 0.0F, 2.0F)},
      {Vec3(-1.0F, 0.0F, -1.0F), Vec3(1.0F, 0.0F, -1.0F), Vec3(1.0F, 0.0F, 1.0F), Vec3(-1.0F, 0.0F, 1.0F)}};
  for (const auto& points : scenes) {
    const Scene scene = pointScene(points);
    for (const std::string& name : namedViews())
      for (const bool orthographic : {false, true}) {
        CAPTURE(points.size());
        CAPTURE(name);
        const Camera camera =
            fitClipPlanes(fitCamera(scene, namedView(name), 1.3, kFov, orthographic), boundsOf(scene));
        CHECK((camera.orthographic_height > 0.0) == orthographic);
        const Projected p = project(scene, camera, 1.3);
        CHECK(p.least_w > 0.0);
        CHECK(std::max({-p.lo.x, -p.lo.y, p.hi.x, p.hi.y}) <= 0.9 + 1e-9);
        CHECK(p.lo.z > 0.0);
        CHECK(p.hi.z < 1.0);
      }
  }
}

TEST_CASE("scenes/camera: an empty scene gets a camera on the unit box") {
  Scene box = pointScene({Vec3(-0.5F, -0.5F, -0.5F), Vec3(0.5F, -0.5F, -0.5F), Vec3(-0.5F, 0.5F, -0.5F),
                          Vec3(0.5F, 0.5F, -0.5F), Vec3(-0.5F, -0.5F, 0.5F), Vec3(0.5F, -0.5F, 0.5F),
                          Vec3(-0.5F, 0.5F, 0.5F), Vec3(0.5F, 0.5F, 0.5F)});
  for (const bool orthographic : {false, true}) {
    const Camera expected = fitCamera(box, namedView("iso"), 1.0, kFov, orthographic);
    const Camera camera = fitCamera(Scene{}, namedView("iso"), 1.0, kFov, orthographic);
    CHECK(camera.eye == expected.eye);
    CHECK(camera.orthographic_height == expected.orthographic_height);
    const Camera clipped = fitClipPlanes(camera, boundsOf(Scene{}));
    CHECK(clipped.near > 0.0);
    CHECK(clipped.far > clipped.near);
  }
}

TEST_CASE("scenes/camera: named views look from where they say") {
  CHECK(namedView("front").to_eye == DVec3(0.0, 0.0, 1.0));
  CHECK(namedView("right").to_eye == DVec3(1.0, 0.0, 0.0));
  CHECK(namedView("top").to_eye == DVec3(0.0, 1.0, 0.0));
  const DVec3 iso = namedView("iso").to_eye;
  CHECK(iso.x == doctest::Approx(std::sqrt(1.0 / 3.0)));
  CHECK(iso.y == doctest::Approx(std::sqrt(1.0 / 3.0)));
  CHECK(iso.z == doctest::Approx(std::sqrt(1.0 / 3.0)));
  CHECK(namedView("iso-left").to_eye.x < 0.0);
  CHECK(namedView("iso-left").to_eye.z > 0.0);
  CHECK(namedView("iso-back").to_eye.x > 0.0);
  CHECK(namedView("iso-back").to_eye.z < 0.0);
  CHECK(std::set<std::string>(namedViews().begin(), namedViews().end()).size() == namedViews().size());
  for (const std::string& name : namedViews()) {
    CHECK(glm::length(namedView(name).to_eye) == doctest::Approx(1.0));
    CHECK(glm::dot(namedView(name).to_eye, namedView(name).up) == doctest::Approx(0.0));
  }
  CHECK_THROWS_WITH_AS(namedView("sideways"), doctest::Contains("front, back"), Error);
}

TEST_CASE("scenes/camera: azimuth grows counter-clockwise from above and up stays up over the poles") {
  CHECK(orbitView(0.0, 0.0).to_eye.z == doctest::Approx(1.0));
  CHECK(orbitView(radians(90.0), 0.0).to_eye.x == doctest::Approx(1.0));
  CHECK(orbitView(0.3, radians(30.0)).to_eye.y == doctest::Approx(0.5));
  const ViewDirection steep = orbitView(0.0, radians(89.9999));
  CHECK(steep.up.z == doctest::Approx(-1.0));
}

TEST_CASE("scenes/camera: an up along the view is replaced") {
  Camera camera;
  camera.eye = DVec3(0.0, 5.0, 0.0);
  camera.target = DVec3(0.0);
  const DMat4 from_above = viewFromWorld(camera);
  CHECK(DVec3(from_above * DVec4(1.0, 0.0, 0.0, 0.0)).x == doctest::Approx(1.0));
  CHECK(DVec3(from_above * DVec4(0.0, 0.0, -1.0, 0.0)).y == doctest::Approx(1.0));
  camera.eye = DVec3(0.0, -5.0, 0.0);
  CHECK(DVec3(viewFromWorld(camera) * DVec4(0.0, 0.0, 1.0, 0.0)).y == doctest::Approx(1.0));
  camera.eye = camera.target;  // no direction at all
  CHECK(std::abs(glm::determinant(DMat3(viewFromWorld(camera)))) == doctest::Approx(1.0));
}

TEST_CASE("scenes/camera: view space looks down -Z and clip depth is 1 at near and 0 at far") {
  Camera camera;
  camera.eye = DVec3(1.0, 2.0, 3.0);
  camera.target = DVec3(4.0, 2.0, -1.0);
  const DVec4 target = viewFromWorld(camera) * DVec4(camera.target, 1.0);
  CHECK(target.x == doctest::Approx(0.0));
  CHECK(target.y == doctest::Approx(0.0));
  CHECK(target.z == doctest::Approx(-5.0));
  camera.near = 0.5;
  camera.far = 40.0;
  for (const double height : {0.0, 3.0}) {
    camera.orthographic_height = height;
    const DMat4 clip = clipFromView(camera, 2.0);
    const DVec4 at_near = clip * DVec4(0.0, 0.0, -0.5, 1.0);
    const DVec4 at_far = clip * DVec4(0.0, 0.0, -40.0, 1.0);
    CHECK(at_near.z / at_near.w == doctest::Approx(1.0));
    CHECK(at_far.z / at_far.w == doctest::Approx(0.0));
    // The top right corner of the picture, ten metres away.
    const double top = height > 0.0 ? 0.5 * height : 10.0 * std::tan(0.5 * camera.vertical_fov_rad);
    const DVec4 corner = clip * DVec4(2.0 * top, top, -10.0, 1.0);
    CHECK(corner.x / corner.w == doctest::Approx(1.0));
    CHECK(corner.y / corner.w == doctest::Approx(1.0));
  }
}

TEST_CASE("scenes/camera: clip planes that are set stay, the others fit around the box, whatever its place") {
  const Box3 box{Vec3(-1.0F), Vec3(1.0F)};
  for (const DVec3& eye : {DVec3(0.0, 0.0, 5.0), DVec3(0.0, 0.0, 0.5), DVec3(0.0, 0.0, -50.0), DVec3(0.0, 0.0, 1e7)})
    for (const double near : {0.0, 0.25, 100.0})
      for (const double far : {0.0, 0.5, 200.0}) {
        if (near > 0.0 && far > 0.0 && far <= near) continue;
        Camera camera;
        camera.eye = eye;
        camera.target = eye - DVec3(0.0, 0.0, 1.0);
        camera.near = near;
        camera.far = far;
        const Camera fitted = fitClipPlanes(camera, box);
        CAPTURE(eye.z);
        CAPTURE(near);
        CAPTURE(far);
        CHECK(fitted.near > 0.0);
        CHECK(fitted.far > fitted.near);
        if (near > 0.0) CHECK(fitted.near == near);
        if (far > 0.0) CHECK(fitted.far == far);
        if (near == 0.0 && far == 0.0 && eye.z > 0.0) {
          CHECK(fitted.far > eye.z + 1.0);
          CHECK(fitted.near <= std::max(eye.z - 1.0, 1e-3 * fitted.far));
        }
      }
}

TEST_CASE("scenes/camera: default lights never push a white surface beyond white, and leave other lights alone") {
  for (const std::string& name : namedViews()) {
    Scene scene;
    const Camera camera = fitCamera(scene, namedView(name), 1.0, kFov, false);
    addDefaultLights(scene, camera);
    REQUIRE(scene.lights.size() >= 2);
    for (const Light& l : scene.lights) CHECK(glm::length(l.direction_to_light_world) == doctest::Approx(1.0F));
    std::mt19937 random(5);
    float brightest = 0.0F;
    for (int i = 0; i < 2000; ++i) {
      DVec3 n;
      do {
        n = DVec3(uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0));
      } while (glm::dot(n, n) > 1.0 || glm::dot(n, n) < 0.01);
      const Vec3 normal(glm::normalize(n));
      Vec3 light = glm::mix(scene.ambient.ground, scene.ambient.sky, 0.5F * normal.y + 0.5F);
      for (const Light& l : scene.lights)
        light += std::max(0.0F, glm::dot(normal, l.direction_to_light_world)) * l.radiance;
      brightest = std::max({brightest, light.x, light.y, light.z});
    }
    CHECK(brightest <= 0.97F);
    CHECK(brightest > 0.7F);
    const Light first = scene.lights.front();
    const std::size_t count = scene.lights.size();
    addDefaultLights(scene, camera);
    CHECK(scene.lights.size() == count);
    CHECK(scene.lights.front().radiance == first.radiance);
  }
}

}  // namespace sheaf::scenes
