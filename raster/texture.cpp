#include "raster/texture.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/error.h"
#include "raster/srgb.h"

namespace sheaf::raster {
namespace {

using Level = MipTexture::Level;

std::uint32_t fraction16(double value) {
  return static_cast<std::uint32_t>(std::clamp(value, 0.0, 1.0) * 65535.0 + 0.5);
}

LinearTexel packTexel(const DVec4& linear) {
  return {fraction16(linear.x) | fraction16(linear.y) << 16, fraction16(linear.z) | fraction16(linear.w) << 16};
}

DVec4 unpackTexel(const LinearTexel& texel) {
  return DVec4(texel.rg & 0xFFFFU, texel.rg >> 16, texel.ba & 0xFFFFU, texel.ba >> 16) / 65535.0;
}

/// Which texels of a row of `source` lie under texel `index` of a row of `target`, and how much of each.
struct Span {
  int first;
  int count;         // at most 3: the target has at least a third of the source's texels
  double weight[3];  // add up to source / target
};

Span spanUnder(int index, int source, int target) {
  // Texel edges in units of 1 / target of a source texel: exact integers.
  const int begin = index * source;
  const int end = begin + source;
  Span span{begin / target, 0, {}};
  for (int texel = span.first; texel * target < end; ++texel) {
    const int overlap = std::min(end, (texel + 1) * target) - std::max(begin, texel * target);
    assert(span.count < 3);
    span.weight[span.count++] = static_cast<double>(overlap) / target;
  }
  return span;
}

/// Mean of the texels under (x, y) of `to`; colours weighted with alpha, or evenly where all are transparent.
LinearTexel averageUnder(const LinearTexel* source, const Level& from, const Level& to, int x, const Span& rows) {
  const Span columns = spanUnder(x, from.width, to.width);
  DVec4 weighted(0.0);
  DVec3 plain(0.0);
  double area = 0.0;
  for (int j = 0; j < rows.count; ++j)
    for (int i = 0; i < columns.count; ++i) {
      const std::size_t row = static_cast<std::size_t>(rows.first + j);
      const std::size_t at = row * static_cast<std::size_t>(from.width) + static_cast<std::size_t>(columns.first + i);
      const DVec4 texel = unpackTexel(source[at]);
      const double weight = rows.weight[j] * columns.weight[i];
      weighted += weight * DVec4(DVec3(texel) * texel.w, texel.w);
      plain += weight * DVec3(texel);
      area += weight;
    }
  const DVec3 color = weighted.w > 0.0 ? DVec3(weighted) / weighted.w : plain / area;
  return packTexel(DVec4(color, weighted.w / area));
}

void averageLevel(std::vector<LinearTexel>& texels, const Level& from, const Level& to) {
  const LinearTexel* source = texels.data() + from.first_texel;
  LinearTexel* target = texels.data() + to.first_texel;
  for (int y = 0; y < to.height; ++y) {
    const Span rows = spanUnder(y, from.height, to.height);
    for (int x = 0; x < to.width; ++x) *target++ = averageUnder(source, from, to, x, rows);
  }
}

std::array<std::uint32_t, 256> makeDecodeTable() {
  std::array<std::uint32_t, 256> table{};
  for (int code = 0; code < 256; ++code)
    table[static_cast<std::size_t>(code)] = fraction16(linearFromSrgb(code / 255.0));
  return table;
}

}  // namespace

MipTexture::MipTexture(const Image8& image) {
  assert(!image.empty() && image.width() <= 32768 && image.height() <= 32768);
  int width = image.width();
  int height = image.height();
  std::size_t count = 0;
  for (;; width = std::max(1, width / 2), height = std::max(1, height / 2)) {
    if (count + static_cast<std::size_t>(width) * static_cast<std::size_t>(height) > kMaxTexels)
      throw Error(ErrorCode::kUnsupported, "texture: has more than 2^30 texels with its smaller copies");
    levels_[static_cast<std::size_t>(level_count_++)] = {width, height, static_cast<std::int32_t>(count)};
    count += static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (width == 1 && height == 1) break;
  }
  texels_.resize(count);
  static const std::array<std::uint32_t, 256> decode = makeDecodeTable();
  std::transform(image.pixels().begin(), image.pixels().end(), texels_.begin(), [](const Rgba8& p) {
    // 257 = 65535 / 255
    return LinearTexel{decode[p.r] | decode[p.g] << 16, decode[p.b] | p.a * 257U << 16};
  });
  for (int k = 1; k < level_count_; ++k) averageLevel(texels_, level(k - 1), level(k));
}

namespace {

/// Texel under coordinate `texel` (in [-1, size]) of a row of `size`, at the row's ends by the wrap mode.
int wrappedTexel(int texel, int size, WrapMode wrap) {
  if (wrap == WrapMode::kRepeat) return texel < 0 ? size - 1 : texel >= size ? 0 : texel;
  return std::clamp(texel, 0, size - 1);
}

/// Coordinate in [0, 1]; what is not finite becomes 0.
double wrappedCoordinate(double u, WrapMode wrap) {
  if (wrap == WrapMode::kRepeat) u -= std::floor(u);
  if (wrap == WrapMode::kMirror) {
    u -= 2.0 * std::floor(0.5 * u);
    if (u > 1.0) u = 2.0 - u;
  }
  return u > 0.0 ? std::min(u, 1.0) : 0.0;
}

struct Axis {
  int texel[2];
  double weight;  // of the second
};

Axis bilinearAxis(double u, int size, WrapMode wrap) {
  const double position = wrappedCoordinate(u, wrap) * size - 0.5;
  const int first = static_cast<int>(std::floor(position));
  return {{wrappedTexel(first, size, wrap), wrappedTexel(first + 1, size, wrap)}, position - first};
}

DVec4 texelAt(const MipTexture& texture, const Level& level, int x, int y) {
  const std::size_t offset = static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width);
  return unpackTexel(
      texture.texels()[static_cast<std::size_t>(level.first_texel) + offset + static_cast<std::size_t>(x)]);
}

DVec4 bilinear(const MipTexture& texture, const TextureSampler& sampler, Vec2 uv, int k) {
  const Level& level = texture.level(k);
  const Axis x = bilinearAxis(uv.x, level.width, sampler.wrap_u);
  const Axis y = bilinearAxis(uv.y, level.height, sampler.wrap_v);
  const auto row = [&](int j) {
    return glm::mix(texelAt(texture, level, x.texel[0], y.texel[j]), texelAt(texture, level, x.texel[1], y.texel[j]),
                    x.weight);
  };
  return glm::mix(row(0), row(1), y.weight);
}

DVec4 nearest(const MipTexture& texture, const TextureSampler& sampler, Vec2 uv) {
  const Level& level = texture.level(0);
  const auto texel = [](double u, int size, WrapMode wrap) {
    return std::min(static_cast<int>(wrappedCoordinate(u, wrap) * size), size - 1);
  };
  return texelAt(texture, level, texel(uv.x, level.width, sampler.wrap_u), texel(uv.y, level.height, sampler.wrap_v));
}

}  // namespace

Vec4 sampleReference(const MipTexture& texture, const TextureSampler& sampler, Vec2 uv, float footprint_texels) {
  if (sampler.filter == FilterMode::kNearest) return Vec4(nearest(texture, sampler, uv));
  const double coarsest = texture.levelCount() - 1;
  const double level = footprint_texels > 1.0F ? std::min(std::log2(double{footprint_texels}), coarsest) : 0.0;
  const int finer = static_cast<int>(level);
  const DVec4 fine = bilinear(texture, sampler, uv, finer);
  if (level == finer) return Vec4(fine);
  return Vec4(glm::mix(fine, bilinear(texture, sampler, uv, finer + 1), level - finer));
}

}  // namespace sheaf::raster
