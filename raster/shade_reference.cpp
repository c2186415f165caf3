#include "raster/shade_reference.h"

#include <algorithm>
#include <cmath>

namespace sheaf::raster {
namespace {

using DVec2 = glm::dvec2;

// Solid textures: as in shade_solid-inl.h, one point at a time.

double edgeGradient(std::uint32_t hash, const DVec3& p) {
  const double u = (hash & 8U) == 0 ? p.x : p.y;
  const double v = (hash & 12U) == 0 ? p.y : (hash & 13U) == 12 ? p.x : p.z;
  return ((hash & 1U) != 0 ? -u : u) + ((hash & 2U) != 0 ? -v : v);
}

std::uint32_t latticeHash(const glm::ivec3& at) {
  std::uint32_t h = (static_cast<std::uint32_t>(at.x) * 0x8DA6B343U) ^
                    (static_cast<std::uint32_t>(at.y) * 0xD8163841U) ^ (static_cast<std::uint32_t>(at.z) * 0xCB1AB31FU);
  h = (h ^ h >> 15) * 0x2C1B3C6DU;
  return (h ^ h >> 12) >> 20;
}

double fade(double t) {
  return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

double noise(const DVec3& p) {
  const DVec3 cell = glm::floor(p);
  const DVec3 in_cell = p - cell;
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 offset(corner & 1, corner >> 1 & 1, corner >> 2);
    const DVec3 to_corner = in_cell - DVec3(offset);
    double weight = 1.0;
    for (int axis = 0; axis < 3; ++axis) weight *= offset[axis] != 0 ? fade(in_cell[axis]) : 1.0 - fade(in_cell[axis]);
    sum += weight * edgeGradient(latticeHash(glm::ivec3(cell) + offset), to_corner);
  }
  return sum;
}

double marble(const DVec3& p) {
  double turbulence = 0.0;
  double scale = 1.0;
  for (double strength = 1.0; strength > 0.05; strength *= 0.5, scale *= 2.03)
    turbulence += strength * std::abs(noise(p * scale));
  const double along = p.x + 0.25 * p.y + 0.5 * p.z;
  const double ridge = 1.0 - std::abs(std::sin(kPi * (along + 1.5 * turbulence)));
  return std::min(1.0, 0.3 * std::pow(ridge, 2.0) + 0.55 * std::pow(ridge, 6.0) + 0.12 * turbulence * turbulence);
}

double wood(const DVec3& p) {
  const auto noise_at = [&](double across, double along) { return noise(p * DVec3(across, along, across)); };
  const double ring = std::hypot(p.x, p.z) + 0.6 * noise_at(0.35, 0.12) + 0.12 * noise_at(1.3, 0.3);
  const double phase = ring - std::floor(ring);
  const double late = phase * phase * phase * std::min(1.0, 8.0 * (1.0 - phase));
  return std::clamp(0.9 * late + 0.08 + 0.18 * noise_at(14.0, 0.7), 0.0, 1.0);
}

double checker(const DVec3& p) {
  const glm::ivec3 cell(glm::floor(p + 1.0 / 1024.0));
  return (cell.x + cell.y + cell.z) & 1;
}

/// Perspective-correct barycentric coordinates of a pixel centre.
DVec3 barycentrics(const ShadeTriangle& t, double x, double y) {
  const double dx = x - t.ref_x;
  const double dy = y - t.ref_y;
  DVec3 u;
  for (int i = 0; i < 3; ++i) u[i] = double{t.u0[i]} + double{t.ux[i]} * dx + double{t.uy[i]} * dy;
  return u / (u.x + u.y + u.z);
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
    for (int i = 0; i < 3; ++i) {
      const VertexNormal& n = surface.normal[t.vertex[i]];
      normal += b[i] * DVec3(n.x, n.y, n.z);
    }
  }
  const DVec3 world = DMat3(surface.world_from_object_normal) * normal;
  const double length = glm::length(world);
  if (!(length > 0.0)) return DVec3(0.0);
  return t.back_face != 0 ? -world / length : world / length;
}

DVec3 vertexColor(const Surface& surface, const ShadeTriangle& t, const DVec3& b) {
  DVec3 sum(0.0);
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t rg = surface.color[0][t.vertex[i]];
    const std::uint32_t ba = surface.color[1][t.vertex[i]];
    sum += b[i] * DVec3(rg & 0xFFFFU, rg >> 16, ba & 0xFFFFU) / 65535.0;
  }
  return sum;
}

DVec2 textureCoordinate(const ShadeMaterial& material, const Surface& surface, const ShadeTriangle& t, const DVec3& b) {
  DVec2 uv(0.0);
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t v = t.vertex[i];
    uv += b[i] * DVec2(surface.texcoord[0][v], surface.texcoord[1][v]);
  }
  return DVec2(material.uv_offset) + glm::dmat2(material.uv_linear) * uv;
}

DVec3 textureColor(const ShadeMaterial& material, const Surface& surface, const ShadeTriangle& t, int x, int y) {
  // Derivatives as differences over a small fraction of a pixel, unlike the kernels'.
  constexpr double kStep = 1e-4;
  const auto coordinate = [&](double px, double py) {
    return textureCoordinate(material, surface, t, barycentrics(t, px, py));
  };
  const DVec2 uv = coordinate(x, y);
  const DVec2 size(material.texture->level(0).width, material.texture->level(0).height);
  const double along_x = glm::length((coordinate(x + kStep, y) - coordinate(x - kStep, y)) * size) / (2.0 * kStep);
  const double along_y = glm::length((coordinate(x, y + kStep) - coordinate(x, y - kStep)) * size) / (2.0 * kStep);
  const auto footprint = static_cast<float>(std::max(along_x, along_y));
  return DVec3(sampleReference(*material.texture, material.sampler, Vec2(uv), footprint));
}

DVec3 solidColor(const ShadeMaterial& material, const Surface& surface, const ShadeTriangle& t, const DVec3& b) {
  DVec3 p(0.0);
  for (int i = 0; i < 3; ++i) p += b[i] * position(surface, t.vertex[i]);
  const double share = solidReference(material.solid, p * double{material.solid_frequency});
  return glm::mix(DVec3(material.solid_colors[0]), DVec3(material.solid_colors[1]), share);
}

DVec3 albedo(const ShadeMaterial& material, const Surface& surface, const ShadeTriangle& t, int x, int y) {
  const DVec3 b = barycentrics(t, x, y);
  DVec3 color(material.base_color);
  if (surface.color[0] != nullptr) color *= vertexColor(surface, t, b);
  if (material.texture != nullptr && surface.texcoord[0] != nullptr) color *= textureColor(material, surface, t, x, y);
  if (material.solid != SolidTexture::kNone) color *= solidColor(material, surface, t, b);
  return color;
}

}  // namespace

double solidReference(SolidTexture solid, const DVec3& p) {
  if (solid == SolidTexture::kMarble) return marble(p);
  if (solid == SolidTexture::kWood) return wood(p);
  if (solid == SolidTexture::kChecker) return checker(p);
  return 0.0;
}

DVec3 shadePixelReference(const ShadeScene& scene, std::uint32_t id, int x, int y) {
  const ShadeTriangle& t = scene.triangles[id];
  const Surface& surface = scene.surfaces[t.surface];
  const ShadeMaterial& material = scene.materials[surface.material];
  const DVec3 b = barycentrics(t, x, y);
  const DVec3 color = albedo(material, surface, t, x, y);
  if (material.model == ShadeModel::kUnlit) return color;

  const DVec3 normal = worldNormal(material, surface, t, b);
  const double up = 0.5 + 0.5 * normal.y;
  DVec3 diffuse = DVec3(scene.ambient_ground) * (1.0 - up) + DVec3(scene.ambient_sky) * up;
  DVec3 highlights(0.0);
  const DVec3 eye =
      glm::normalize(DVec3(scene.to_eye) + DVec3(scene.to_eye_dx) * double(x) + DVec3(scene.to_eye_dy) * double(y));
  for (int i = 0; i < scene.light_count; ++i) {
    const DirectionalLight& light = scene.lights[static_cast<std::size_t>(i)];
    const DVec3 to_light(light.direction_to_light_world);
    const double cosine = std::max(0.0, glm::dot(to_light, normal));
    diffuse += DVec3(light.radiance) * cosine;
    const double facing = std::max(0.0, glm::dot(normal, glm::normalize(to_light + eye)));
    highlights += DVec3(light.radiance) * cosine * std::pow(facing, double{material.shininess});
  }
  return color * diffuse + material.specular * (material.shininess + 8.0) / 8.0 * highlights;
}

}  // namespace sheaf::raster
