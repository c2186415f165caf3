// raster/shade_texture-inl: filtered texture reads. The plain form is sampleReference() in raster/texture.cpp.
#include "raster/shade_math-inl.h"
#include "raster/texture.h"

#if defined(SHEAF_RASTER_SHADE_TEXTURE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHEAF_RASTER_SHADE_TEXTURE_INL_H_
#undef SHEAF_RASTER_SHADE_TEXTURE_INL_H_
#else
#define SHEAF_RASTER_SHADE_TEXTURE_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace sheaf::raster::HWY_NAMESPACE {

/// Coordinate in [0, 1]; what is not finite becomes 0.
HWY_INLINE VF WrapCoordinate(VF u, WrapMode wrap) {
  if (wrap == WrapMode::kRepeat) u = hn::Sub(u, hn::Floor(u));
  if (wrap == WrapMode::kMirror) {
    u = hn::Sub(u, hn::Mul(Constant(2.0F), hn::Floor(hn::Mul(u, Constant(0.5F)))));
    u = hn::IfThenElse(hn::Gt(u, Constant(1.0F)), hn::Sub(Constant(2.0F), u), u);
  }
  return Clamped(u, 0.0F, 1.0F);
}

/// The two texels around a wrapped coordinate on an axis of `size` texels, and the weight of the second.
HWY_INLINE void BilinearAxis(VF unit, VI size, WrapMode wrap, VI& texel0, VI& texel1, VF& weight1) {
  const DI di;
  const VF position = hn::Sub(hn::Mul(unit, hn::ConvertTo(DF(), size)), Constant(0.5F));
  VF floored;
  const VI first = FloorToInt(position, floored);
  const VI second = hn::Add(first, hn::Set(di, 1));
  const VI last = hn::Sub(size, hn::Set(di, 1));
  const VI zero = hn::Zero(di);
  const bool repeat = wrap == WrapMode::kRepeat;
  texel0 = hn::IfThenElse(hn::Lt(first, zero), repeat ? last : zero, first);
  texel1 = hn::IfThenElse(hn::Gt(second, last), repeat ? zero : last, second);
  weight1 = hn::Sub(position, floored);
}

/// Colour of the numbered texels, in units of 1 / 65535.
HWY_INLINE void ReadTexels(const MipTexture& texture, VI texel, VF& r, VF& g, VF& b) {
  const DF d;
  const DI di;
  const auto* words = reinterpret_cast<const std::int32_t*>(texture.texels().data());
  const VI low16 = hn::Set(di, 0xFFFF);
  const VI rg_word = hn::Add(texel, texel);
  const VI rg = Gather(words, rg_word);
  const VI ba = Gather(words + 1, rg_word);
  r = hn::ConvertTo(d, hn::And(rg, low16));
  g = hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<16>(hn::BitCast(DU(), rg))));
  b = hn::ConvertTo(d, hn::And(ba, low16));
}

/// Size and first texel of each lane's level.
HWY_INLINE void LoadLevels(const MipTexture& texture, VI level, VI& width, VI& height, VI& first_texel) {
  const DI di;
  const std::int32_t level0 = hn::GetLane(level);
  if (hn::AllTrue(di, hn::Eq(level, hn::Set(di, level0)))) {
    const MipTexture::Level& common = texture.level(level0);
    width = hn::Set(di, common.width);
    height = hn::Set(di, common.height);
    first_texel = hn::Set(di, common.first_texel);
    return;
  }
  static_assert(sizeof(MipTexture::Level) == 3 * sizeof(std::int32_t));
  const std::int32_t* fields = &texture.level(0).width;
  const VI word = hn::Add(hn::Add(level, level), level);
  width = Gather(fields, word);
  height = Gather(fields + 1, word);
  first_texel = Gather(fields + 2, word);
}

/// Bilinear at (u, v), both wrapped, in units of 1 / 65535.
HWY_INLINE void SampleLevel(const MipTexture& texture, const TextureSampler& sampler, VF u, VF v, VI level, VF& r,
                            VF& g, VF& b) {
  VI width, height, first_texel;
  LoadLevels(texture, level, width, height, first_texel);
  VI x0, x1, y0, y1;
  VF weight_x, weight_y;
  BilinearAxis(u, width, sampler.wrap_u, x0, x1, weight_x);
  BilinearAxis(v, height, sampler.wrap_v, y0, y1, weight_y);
  const VI row0 = hn::Add(first_texel, hn::Mul(y0, width));
  const VI row1 = hn::Add(first_texel, hn::Mul(y1, width));
  VF r00, g00, b00, r01, g01, b01, r10, g10, b10, r11, g11, b11;
  ReadTexels(texture, hn::Add(row0, x0), r00, g00, b00);
  ReadTexels(texture, hn::Add(row0, x1), r01, g01, b01);
  ReadTexels(texture, hn::Add(row1, x0), r10, g10, b10);
  ReadTexels(texture, hn::Add(row1, x1), r11, g11, b11);
  r = Mix(Mix(r00, r01, weight_x), Mix(r10, r11, weight_x), weight_y);
  g = Mix(Mix(g00, g01, weight_x), Mix(g10, g11, weight_x), weight_y);
  b = Mix(Mix(b00, b01, weight_x), Mix(b10, b11, weight_x), weight_y);
}

HWY_INLINE void SampleNearest(const MipTexture& texture, VF u, VF v, VF& r, VF& g, VF& b) {
  const DI di;
  const MipTexture::Level& level = texture.level(0);
  const auto texel = [&](VF unit, std::int32_t size) HWY_ATTR {
    const VI at = hn::ConvertTo(di, hn::Mul(unit, Constant(static_cast<float>(size))));
    return hn::Min(at, hn::Set(di, size - 1));
  };
  const VI x = texel(u, level.width);
  const VI y = texel(v, level.height);
  ReadTexels(texture, hn::Add(hn::Mul(y, hn::Set(di, level.width)), x), r, g, b);
}

/// Linear colour at (u, v). footprint_squared: square of the longer axis of the pixel's footprint, in texels of level
/// 0.
HWY_INLINE void SampleTexture(const MipTexture& texture, const TextureSampler& sampler, VF u, VF v,
                              VF footprint_squared, VF& r, VF& g, VF& b) {
  const DI di;
  const VF unit_u = WrapCoordinate(u, sampler.wrap_u);
  const VF unit_v = WrapCoordinate(v, sampler.wrap_v);
  if (sampler.filter == FilterMode::kNearest) {
    SampleNearest(texture, unit_u, unit_v, r, g, b);
  } else {
    const auto coarsest = static_cast<float>(texture.levelCount() - 1);
    const VF log2_footprint = hn::Mul(Constant(0.5F), Log2(Clamped(footprint_squared, 1.0F, 1e18F)));
    const VF level = Clamped(log2_footprint, 0.0F, coarsest);
    VF finer_level;
    const VI finer = FloorToInt(level, finer_level);
    const VF blend = hn::Sub(level, finer_level);
    SampleLevel(texture, sampler, unit_u, unit_v, finer, r, g, b);
    // Magnified textures and those at their coarsest level need one level only.
    if (!hn::AllTrue(DF(), hn::Eq(blend, hn::Zero(DF())))) {
      const VI coarser = hn::Min(hn::Add(finer, hn::Set(di, 1)), hn::Set(di, texture.levelCount() - 1));
      VF coarse_r, coarse_g, coarse_b;
      SampleLevel(texture, sampler, unit_u, unit_v, coarser, coarse_r, coarse_g, coarse_b);
      r = Mix(r, coarse_r, blend);
      g = Mix(g, coarse_g, blend);
      b = Mix(b, coarse_b, blend);
    }
  }
  const VF scale = Constant(1.0F / 65535.0F);
  r = hn::Mul(r, scale);
  g = hn::Mul(g, scale);
  b = hn::Mul(b, scale);
}

}  // namespace sheaf::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
