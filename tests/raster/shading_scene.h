// Random scenes for the tests of shading: no geometry, but triangles whose planes give sensible barycentrics.
#pragma once

#include <cstdint>
#include <deque>
#include <random>
#include <vector>

#include "raster/shade.h"

namespace sheaf::raster {

/// Owns what a ShadeScene points to.
struct ShadingScene {
  static constexpr std::uint32_t kVertices = 64;  // per surface

  struct Attributes {
    std::array<std::vector<float>, 3> position;
    std::vector<VertexNormal> normal;
    std::array<std::vector<float>, 2> texcoord;
    std::array<std::vector<std::uint32_t>, 2> color;
  };

  std::mt19937 rng{0x5eed};
  std::deque<Attributes> attributes;
  std::vector<Surface> surfaces;
  std::vector<ShadeMaterial> materials;
  std::vector<ShadeTriangle> triangles;

  float uniform(float lo, float hi) { return std::uniform_real_distribution<float>(lo, hi)(rng); }
  std::uint32_t below(std::uint32_t n) { return std::uniform_int_distribution<std::uint32_t>(0, n - 1)(rng); }
  Vec3 direction() {
    for (;;) {
      const Vec3 v{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
      if (glm::length(v) > 0.1F && glm::length(v) < 1.0F) return glm::normalize(v);
    }
  }

  /// A surface with all attributes; normals lean towards `facing`, so that blends of them do not vanish.
  std::uint32_t addSurface(const ShadeMaterial& material, const Vec3& facing) {
    Attributes& a = attributes.emplace_back();
    Surface s;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::uint32_t i = 0; i < kVertices; ++i) a.position[axis].push_back(uniform(-2, 2));
      s.position_object[axis] = a.position[axis].data();
    }
    for (std::uint32_t i = 0; i < kVertices; ++i) a.normal.push_back(vertexNormal(facing + 0.7F * direction()));
    s.normal = a.normal.data();
    for (std::size_t axis = 0; axis < 2; ++axis) {
      for (std::uint32_t i = 0; i < kVertices; ++i) a.texcoord[axis].push_back(uniform(-2, 2));
      s.texcoord[axis] = a.texcoord[axis].data();
      for (std::uint32_t i = 0; i < kVertices; ++i) a.color[axis].push_back(static_cast<std::uint32_t>(rng()));
      s.color[axis] = a.color[axis].data();
    }
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) s.world_from_object_normal[i][j] = (i == j ? 1.0F : 0.0F) + uniform(-0.3F, 0.3F);
    s.material = static_cast<std::uint32_t>(materials.size());
    materials.push_back(material);
    surfaces.push_back(s);
    return static_cast<std::uint32_t>(surfaces.size() - 1);
  }

  /// A triangle with positive barycentrics over the whole tile around (x, y).
  std::uint32_t addTriangle(std::uint32_t surface, int x, int y) {
    ShadeTriangle t{};
    for (int i = 0; i < 3; ++i) {
      t.u0[i] = uniform(1.0F, 2.0F);
      t.ux[i] = uniform(-0.006F, 0.006F);
      t.uy[i] = uniform(-0.006F, 0.006F);
      t.vertex[i] = below(kVertices);
    }
    t.ref_x = static_cast<std::int16_t>(x);
    t.ref_y = static_cast<std::int16_t>(y);
    t.surface = surface;
    t.back_face = below(2);
    triangles.push_back(t);
    return static_cast<std::uint32_t>(triangles.size() - 1);
  }

  /// Two lights, a hemisphere, and an eye; valid until something is added.
  ShadeScene view() const {
    ShadeScene scene;
    scene.triangles = triangles;
    scene.surfaces = surfaces;
    scene.materials = materials;
    scene.lights[0] = {glm::normalize(Vec3(0.4F, 0.7F, 0.6F)), Vec3(0.7F, 0.65F, 0.6F)};
    scene.lights[1] = {glm::normalize(Vec3(-0.8F, 0.1F, 0.3F)), Vec3(0.1F, 0.15F, 0.2F)};
    scene.light_count = 2;
    scene.ambient_sky = Vec3(0.2F, 0.22F, 0.25F);
    scene.ambient_ground = Vec3(0.1F, 0.08F, 0.07F);
    scene.to_eye = Vec3(0.5F, 0.4F, 2.0F);
    scene.to_eye_dx = Vec3(-0.006F, 0.0F, 0.0F);
    scene.to_eye_dy = Vec3(0.0F, 0.006F, 0.0F);
    scene.background = Vec4(0.25F, 0.5F, 0.75F, 0.4F);
    return scene;
  }
};

}  // namespace sheaf::raster
