// raster/shade: colours of the visible pixels, once each, in batches of one surface.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/image.h"
#include "core/math.h"
#include "raster/screen.h"
#include "raster/texture.h"

namespace sheaf::raster {

enum class SolidTexture : std::uint8_t { kNone, kMarble, kWood, kChecker };
enum class ShadeModel : std::uint8_t { kSmooth, kFlat, kUnlit };

struct ShadeMaterial {
  Vec4 base_color{0.8F, 0.8F, 0.8F, 1.0F};  ///< linear
  const MipTexture* texture = nullptr;      ///< may be null
  TextureSampler sampler;
  glm::mat2 uv_linear{1.0F};  ///< uv_texture = uv_offset + uv_linear * uv_mesh
  Vec2 uv_offset{0.0F};
  SolidTexture solid = SolidTexture::kNone;
  std::array<Vec3, 2> solid_colors{};  ///< linear
  float solid_frequency = 1.0F;        ///< per object-space unit
  float specular = 0.0F;
  float shininess = 32.0F;
  ShadeModel model = ShadeModel::kSmooth;
};

/// A unit vector, padded so that a vector of them is read by one load each and a transposition.
struct alignas(16) VertexNormal {
  float x, y, z;
  float unused;
};

/// One instance: where its attributes are and how its normals turn. Attribute arrays are indexed by
/// ShadeTriangle::vertex and readable at every index that a triangle names.
struct Surface {
  std::array<const float*, 3> position_object{};  ///< x, y, z; null only if nothing reads them:
                                                  ///< no solid texture, and normals that are not the triangle's own
  const VertexNormal* normal = nullptr;           ///< object space; null = use the triangle's own
  std::array<const float*, 2> texcoord{};         ///< u, v; null = none
  std::array<const std::uint32_t*, 2> color{};    ///< packColor(): rg, ba; null = none
  Mat3 world_from_object_normal{1.0F};            ///< takes normals to world space, any scale (cofactor matrix)
  std::uint32_t material = 0;
  std::uint32_t instance = 0;
};

struct DirectionalLight {
  Vec3 direction_to_light_world{0.0F, 1.0F, 0.0F};  ///< unit
  Vec3 radiance{1.0F};
};

inline constexpr int kMaxLights = 8;

/// Everything that shading reads, the same for all tiles of a frame.
struct ShadeScene {
  std::span<const ShadeTriangle> triangles;
  std::span<const Surface> surfaces;
  std::span<const ShadeMaterial> materials;
  std::array<DirectionalLight, kMaxLights> lights{};
  int light_count = 0;
  Vec3 ambient_sky{0.0F};     ///< linear
  Vec3 ambient_ground{0.0F};  ///< linear
  /// From a surface point towards the eye at the centre of pixel (x, y): to_eye + x * to_eye_dx + y * to_eye_dy, world
  /// space, any length.
  Vec3 to_eye{0.0F, 0.0F, 1.0F};
  Vec3 to_eye_dx{0.0F};
  Vec3 to_eye_dy{0.0F};
  Vec4 background{0.0F, 0.0F, 0.0F, 0.0F};  ///< linear, straight alpha
};

/// Where a tile's colours go; either image may be null. Both have the frame's size.
struct ColorTarget {
  Image8* srgb = nullptr;     ///< sRGB-coded, straight alpha
  ImageF4* linear = nullptr;  ///< linear, premultiplied
};

struct ShadeCounts {
  std::uint64_t pixels_shaded = 0;
  std::uint64_t pixels_background = 0;
};

/// Shades the tile whose top left pixel is (x0, y0), multiples of kTileSize; pixels beyond the image's edge are
/// skipped.
ShadeCounts shadeTile(const ShadeScene& scene, const TileVisibility& tile, int x0, int y0, const ColorTarget& target);

/// The same for a tile in which nothing is visible.
ShadeCounts fillTile(const ShadeScene& scene, int x0, int y0, const ColorTarget& target);

/// +Z for a vector that has no direction.
VertexNormal vertexNormal(const Vec3& direction);

/// Linear colour and straight alpha as 16-bit fractions: {r | g << 16, b | a << 16}; clamped to [0, 1].
std::array<std::uint32_t, 2> packColor(const Vec4& linear);

}  // namespace sheaf::raster
