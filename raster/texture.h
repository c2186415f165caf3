// raster/texture: mip-mapped 8-bit textures. Filtering is done on linear values.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/image.h"
#include "core/math.h"

namespace sheaf::raster {

enum class WrapMode : std::uint8_t { kRepeat, kClamp, kMirror };
enum class FilterMode : std::uint8_t { kTrilinear, kNearest };

struct TextureSampler {
  WrapMode wrap_u = WrapMode::kRepeat;
  WrapMode wrap_v = WrapMode::kRepeat;
  FilterMode filter = FilterMode::kTrilinear;
};

inline constexpr int kMaxMipLevels = 16;  ///< 32768 pixels per side

/// Linear colour, straight alpha, 16-bit fractions. Decoded once when the texture is made: filtering then reads two
/// words per texel instead of a byte and a table per channel.
struct LinearTexel {
  std::uint32_t rg;  ///< r | g << 16
  std::uint32_t ba;  ///< b | a << 16
};

/// An RGBA texture with its mip levels, each averaged in linear light (alpha-weighted) from the one before; any size,
/// not only powers of two. Level k has max(1, floor(size / 2^k)) pixels per side.
class MipTexture {
 public:
  /// image  sRGB-coded colour, linear straight alpha; not empty, at most 32768 pixels per side.
  /// Throws Error(kUnsupported) beyond kMaxTexels in all levels together.
  explicit MipTexture(const Image8& image);

  static constexpr std::size_t kMaxTexels = std::size_t{1} << 30;  ///< their words are numbered in 31 bits

  struct Level {
    std::int32_t width;
    std::int32_t height;
    std::int32_t first_texel;  ///< into texels()
  };
  int levelCount() const { return level_count_; }
  const Level& level(int k) const { return levels_[static_cast<std::size_t>(k)]; }
  const std::vector<LinearTexel>& texels() const { return texels_; }

 private:
  std::vector<LinearTexel> texels_;  // all levels, row by row
  std::array<Level, kMaxMipLevels> levels_{};
  int level_count_ = 0;
};

/// The plain reference that the kernels are tested against, in double precision: linear colour at (u, v), trilinear
/// between the levels for `footprint_texels` (the longer axis of a pixel's footprint, in texels of level 0), or nearest
/// in level 0.
Vec4 sampleReference(const MipTexture& texture, const TextureSampler& sampler, Vec2 uv, float footprint_texels);

}  // namespace sheaf::raster
