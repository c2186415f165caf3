#include "raster/shade_reference.h"

#include <cmath>

namespace sheaf::raster {
namespace {

/// Perspective-correct barycentric coordinates of a pixel centre.
DVec3 barycentrics(const ShadeTriangle& t, int x, int y) {
  const double dx = x - t.ref_x;
  const double dy = y - t.ref_y;
  DVec3 u;
  for (int i = 0; i < 3; ++i) u[i] = double{t.u0[i]} + double{t.ux[i]} * dx + double{t.uy[i]} * dy;
  return u / (u.x + u.y + u.z);
}

DVec3 unpackedNormal(std::uint32_t packed) {
  double px = (packed & 0xFFFFU) * (2.0 / 65535.0) - 1.0;
  double py = (packed >> 16) * (2.0 / 65535.0) - 1.0;
  const double pz = 1.0 - std::abs(px) - std::abs(py);
  if (pz < 0.0) {
    const double folded_x = std::copysign(1.0 - std::abs(py), px);
    py = std::copysign(1.0 - std::abs(px), py);
    px = folded_x;
  }
  return glm::normalize(DVec3(px, py, pz));
}

DVec3 position(const Surface& surface, std::uint32_t vertex) {
  return {surface.position_object[0][vertex], surface.position_object[1][vertex], surface.position_object[2][vertex]};
}

DVec3 worldNormal(const ShadeMaterial& material, const Surface& surface, const ShadeTriangle& t, const DVec3& b) {
  DVec3 normal(0.0);
  if (material.model == ShadeModel::kFlat || surface.normal == nullptr) {
    const DVec3 p0 = position(surface, t.vertex[0]);
    normal = glm::cross(position(surface, t.vertex[1]) - p0, position(surface, t.vertex[2]) - p0);
  } else {
    for (int i = 0; i < 3; ++i) normal += b[i] * unpackedNormal(surface.normal[t.vertex[i]]);
  }
  const DVec3 world = DMat3(surface.world_from_object_normal) * normal;
  const double length = glm::length(world);
  if (!(length > 0.0)) return DVec3(0.0);
  return t.back_face != 0 ? -world / length : world / length;
}

}  // namespace

DVec3 shadePixelReference(const ShadeScene& scene, std::uint32_t id, int x, int y) {
  const ShadeTriangle& t = scene.triangles[id];
  const Surface& surface = scene.surfaces[t.surface];
  const ShadeMaterial& material = scene.materials[surface.material];
  const DVec3 b = barycentrics(t, x, y);

  DVec3 color = DVec3(material.base_color);
  if (material.model == ShadeModel::kUnlit) return color;

  const DVec3 normal = worldNormal(material, surface, t, b);
  const double up = 0.5 + 0.5 * normal.y;
  DVec3 light = DVec3(scene.ambient_ground) * (1.0 - up) + DVec3(scene.ambient_sky) * up;
  for (int i = 0; i < scene.light_count; ++i) {
    const DirectionalLight& source = scene.lights[static_cast<std::size_t>(i)];
    light += DVec3(source.radiance) * std::max(0.0, glm::dot(DVec3(source.direction_to_light_world), normal));
  }
  return color * light;
}

}  // namespace sheaf::raster
