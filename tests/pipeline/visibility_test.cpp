// What is seen at each pixel, against rays cast by Embree through its centre.
#include <doctest/doctest.h>
#include <embree3/rtcore.h>

#include <cmath>
#include <memory>

#include "tests/pipeline/scene_fixture.h"

namespace sheaf::pipeline {
namespace {

struct Hit {
  std::uint32_t instance = raster::kNoTriangle;
  std::uint32_t triangle = raster::kNoTriangle;
  double distance = 0.0;
  bool operator==(const Hit& other) const { return instance == other.instance && triangle == other.triangle; }
};

// All instances as world-space triangles in one ray-casting scene.
class RayCaster {
 public:
  explicit RayCaster(const scenes::Scene& scene) : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) add(scene, i);
    rtcCommitScene(scene_);
  }
  ~RayCaster() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  Hit cast(const DVec3& origin, const DVec3& direction) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit ray{};
    ray.ray.org_x = static_cast<float>(origin.x);
    ray.ray.org_y = static_cast<float>(origin.y);
    ray.ray.org_z = static_cast<float>(origin.z);
    ray.ray.dir_x = static_cast<float>(direction.x);
    ray.ray.dir_y = static_cast<float>(direction.y);
    ray.ray.dir_z = static_cast<float>(direction.z);
    ray.ray.tfar = std::numeric_limits<float>::infinity();
    ray.ray.mask = ~0U;
    ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {ray.hit.geomID, ray.hit.primID, double{ray.ray.tfar}};
  }

 private:
  void add(const scenes::Scene& scene, std::uint32_t number) {
    const scenes::Instance& instance = scene.instances[number];
    const mesh::Mesh& mesh = scene.meshes[instance.mesh];
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                          3 * sizeof(float), mesh.positions.size()));
    for (const Vec3& p : mesh.positions) {
      const DVec3 world(instance.world_from_object * DVec4(p, 1.0));
      for (int k = 0; k < 3; ++k) *v++ = static_cast<float>(world[k]);
    }
    auto* t = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                             3 * sizeof(unsigned), mesh.triangles.size()));
    for (const mesh::Triangle& triangle : mesh.triangles)
      for (const std::uint32_t index : triangle) *t++ = index;
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene_, geometry, number);
    rtcReleaseGeometry(geometry);
  }

  RTCDevice device_;
  RTCScene scene_;
};

// Origin and direction of rays through points of the picture, in pixels.
class PixelRays {
 public:
  PixelRays(const scenes::Camera& camera, int width, int height)
      : eye_(camera.eye), width_(width), height_(height), tan_(std::tan(0.5 * camera.vertical_fov_rad)) {
    forward_ = glm::normalize(camera.target - camera.eye);
    right_ = glm::normalize(glm::cross(forward_, camera.up));
    up_ = glm::cross(right_, forward_);
  }
  const DVec3& origin() const { return eye_; }
  DVec3 through(double x_px, double y_px) const {
    const double scale = 2.0 * tan_ / height_;
    return forward_ + right_ * ((x_px - 0.5 * width_) * scale) + up_ * ((0.5 * height_ - y_px) * scale);
  }

 private:
  DVec3 eye_, forward_, right_, up_;
  int width_, height_;
  double tan_;
};

// Corners are snapped to 1/256 pixel, so that an edge may lie up to that far from where rays see it: what the picture
// shows must be hit by a ray that near to the pixel's centre, or lie at the same distance as what is hit.
bool seenNearby(const RayCaster& rays, const PixelRays& pixels, int x, int y, const Hit& seen) {
  for (const double radius : {0.002, 0.004, 0.008})
    for (int i = 0; i < 16; ++i) {
      const double angle = 2.0 * kPi * i / 16.0;
      const Hit hit = rays.cast(pixels.origin(),
                                pixels.through(x + 0.5 + radius * std::cos(angle), y + 0.5 + radius * std::sin(angle)));
      if (hit == seen) return true;
    }
  return false;
}

}  // namespace

TEST_CASE("pipeline/visibility: what is seen at each pixel is what a ray hits") {
  constexpr int kWidth = 211;
  constexpr int kHeight = 157;
  TaskPool pool(2);
  for (const char* spec : {"teapot?n=10", "torusknot?u=200&v=24", "terrain?n=129", "city?blocks=3", "gallery"})
    for (const bool from_within : {false, true}) {
      CAPTURE(spec);
      CAPTURE(from_within);
      scenes::Scene scene = scenes::buildBuiltin(spec);
      for (scenes::Material& material : scene.materials) material.double_sided = true;  // as for rays
      const scenes::Camera camera =
          from_within ? insideCamera(scene) : usualCamera(scene, static_cast<double>(kWidth) / kHeight);
      const RayCaster rays(scene);
      const PixelRays pixels(camera, kWidth, kHeight);
      const ReadyScene ready = makeReady(std::move(scene), camera, pool);
      Frame frame;
      Renderer(pool).render(ready.prepared, camera, allChannels(kWidth, kHeight), frame);

      int differing = 0;
      int unexplained = 0;
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          const Hit seen{frame.instance_id.at(x, y), frame.triangle_id.at(x, y)};
          const Hit hit = rays.cast(pixels.origin(), pixels.through(x + 0.5, y + 0.5));
          if (hit == seen) continue;
          if (hit.instance != raster::kNoTriangle && hit.distance < camera.near * 1.5)
            continue;  // before the near plane
          ++differing;
          unexplained += !seenNearby(rays, pixels, x, y, seen);
        }
      CAPTURE(differing);
      CHECK(differing < kWidth * kHeight / 50);
      CHECK(unexplained <= kWidth * kHeight / 5000);
    }
}

}  // namespace sheaf::pipeline
