// raster/srgb-inl: sRGB coding in vectors.
#include "raster/shade_math-inl.h"
#include "raster/srgb.h"

#if defined(SHEAF_RASTER_SRGB_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHEAF_RASTER_SRGB_INL_H_
#undef SHEAF_RASTER_SRGB_INL_H_
#else
#define SHEAF_RASTER_SRGB_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace sheaf::raster::HWY_NAMESPACE {

/// The code nearest to the curve, as encodeSrgb(). `table` is srgbEncodeTable().
HWY_INLINE VI EncodeSrgb(const std::uint32_t* table, VF linear) {
  const DI di;
  const VF lowest = hn::BitCast(DF(), hn::Set(di, static_cast<std::int32_t>(kSrgbEncodeFirstBits)));
  const VF highest = hn::BitCast(DF(), hn::Set(di, static_cast<std::int32_t>(kSrgbEncodeLastBits)));
  const VF raised = hn::IfThenElse(hn::Gt(linear, lowest), linear, lowest);
  const VI bits = hn::Sub(hn::BitCast(di, hn::Min(raised, highest)), hn::BitCast(di, lowest));
  const VI entry = hn::BitCast(di, Gather(table, hn::ShiftRight<16>(bits)));
  return hn::ShiftRight<16>(hn::Add(entry, hn::And(bits, hn::Set(di, 0xFFFF))));
}

/// Bytes r, g, b, 255 of each lane, r lowest.
HWY_INLINE VU EncodeOpaque(const std::uint32_t* table, VF r, VF g, VF b) {
  const VI rg = hn::Or(EncodeSrgb(table, r), hn::ShiftLeft<8>(EncodeSrgb(table, g)));
  const VI ba = hn::Or(hn::ShiftLeft<16>(EncodeSrgb(table, b)), hn::Set(DI(), static_cast<std::int32_t>(0xFF000000U)));
  return hn::BitCast(DU(), hn::Or(rg, ba));
}

}  // namespace sheaf::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
