// What is seen at each pixel, against rays cast by Embree through its centre.
#include <doctest/doctest.h>

#include <cmath>

#include "tests/embree_scene.h"
#include "tests/pipeline/scene_fixture.h"

namespace sheaf::pipeline {
namespace {

struct Hit {
  std::uint32_t instance = raster::kNoTriangle;
  std::uint32_t triangle = raster::kNoTriangle;
  double distance = 0.0;
  bool operator==(const Hit& other) const { return instance == other.instance && triangle == other.triangle; }
};

// All instances as world-space triangles.
class RayCaster {
 public:
  explicit RayCaster(const scenes::Scene& scene) {
    embree_.makeRobust();
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i)
      embree_.add(i, scene.meshes[scene.instances[i].mesh], scene.instances[i].world_from_object);
    embree_.commit();
  }

  Hit cast(const DVec3& origin, const DVec3& direction) const {
    const EmbreeHit hit = embree_.cast(origin, direction);
    return hit ? Hit{hit.mesh, hit.triangle, hit.t} : Hit{};
  }

 private:
  EmbreeScene embree_;
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
