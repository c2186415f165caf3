// raster/shade_math-inl: arithmetic of the shading kernels. Only operations that IEEE 754 rounds exactly, in a fixed
// order, so that every SIMD target gives the same bits.
#include <cstddef>
#include <cstdint>
#include <cstring>

#include <hwy/highway.h>

#if defined(SHEAF_RASTER_SHADE_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHEAF_RASTER_SHADE_MATH_INL_H_
#undef SHEAF_RASTER_SHADE_MATH_INL_H_
#else
#define SHEAF_RASTER_SHADE_MATH_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace sheaf::raster::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// At most 16 lanes: two rows of a block (screen.h, tileIndex()).
using DF = hn::CappedTag<float, 16>;
using DI = hn::RebindToSigned<DF>;
using DU = hn::RebindToUnsigned<DF>;
using VF = hn::Vec<DF>;
using VI = hn::Vec<DI>;
using VU = hn::Vec<DU>;
using MF = hn::Mask<DF>;

inline constexpr std::size_t kMaxLanes = 16;

HWY_INLINE VF Constant(float value) {
  return hn::Set(DF(), value);
}

HWY_INLINE VF Dot(VF ax, VF ay, VF az, VF bx, VF by, VF bz) {
  return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
}

/// max(v, 0); NaN becomes 0. (hn::Max of a NaN depends on the target.)
HWY_INLINE VF AtLeastZero(VF v) {
  return hn::IfThenElseZero(hn::Gt(v, hn::Zero(DF())), v);
}

/// v within [lo, hi]; NaN becomes lo.
HWY_INLINE VF Clamped(VF v, float lo, float hi) {
  const VF raised = hn::IfThenElse(hn::Gt(v, Constant(lo)), v, Constant(lo));
  return hn::Min(raised, Constant(hi));
}

/// 1 / sqrt(squared), 0 where the square vanishes.
HWY_INLINE VF InverseLength(VF squared) {
  const VF inverse = hn::Div(Constant(1.0F), hn::Sqrt(squared));
  return hn::IfThenElseZero(hn::Gt(squared, Constant(1e-30F)), inverse);
}

/// The lanes of `bits`, lane 0 in bit 0.
HWY_INLINE MF MaskOfBits(std::uint64_t bits) {
  const std::uint64_t lanes = bits & ((std::uint64_t{1} << hn::Lanes(DF())) - 1);
  alignas(8) std::uint8_t bytes[8];
  std::memcpy(bytes, &lanes, sizeof bytes);
  return hn::LoadMaskBits(DF(), bytes);
}

HWY_INLINE std::uint64_t BitsOfMask(MF mask) {
  // Read back as it was written: a wider load would have to wait for the store.
  alignas(8) std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(DF(), mask, bytes);
  if constexpr (hn::MaxLanes(DF()) > 8) {
    std::uint16_t bits;
    std::memcpy(&bits, bytes, sizeof bits);
    return bits;
  } else {
    return bytes[0] & ((1U << hn::Lanes(DF())) - 1);
  }
}

}  // namespace sheaf::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
