// tests/embree_scene: triangles that Embree casts rays at, for an independent answer.
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <limits>

#include "core/math.h"
#include "mesh/mesh.h"

namespace sheaf {

struct EmbreeHit {
  std::uint32_t mesh = RTC_INVALID_GEOMETRY_ID;  ///< number given to add(); RTC_INVALID_GEOMETRY_ID: nothing was hit
  std::uint32_t triangle = 0;
  double t = 0.0;
  explicit operator bool() const { return mesh != RTC_INVALID_GEOMETRY_ID; }
};

class EmbreeScene {
 public:
  EmbreeScene() : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {}
  ~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// Watertight at edges and vertices, at some cost; before commit().
  void makeRobust() { rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST); }

  void add(std::uint32_t number, const mesh::Mesh& mesh, const DMat4& world_from_object = DMat4(1.0)) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                          3 * sizeof(float), mesh.positions.size()));
    for (const Vec3& p : mesh.positions) {
      const DVec3 world(world_from_object * DVec4(p, 1.0));
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

  void commit() { rtcCommitScene(scene_); }

  /// From either side; origin and direction are rounded to float.
  EmbreeHit cast(const DVec3& origin, const DVec3& direction) const {
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
    return {ray.hit.geomID, ray.hit.primID, double{ray.ray.tfar}};
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace sheaf
