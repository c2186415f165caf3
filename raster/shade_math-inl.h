// raster/shade_math-inl: arithmetic of the shading kernels. Only operations that IEEE 754 rounds exactly, in a fixed
// order, so that every SIMD target gives the same bits.
#include <cstddef>
#include <cstdint>
#include <cstring>

#include <hwy/highway.h>

#include "raster/gather-inl.h"

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

HWY_INLINE VU Gather(const std::uint32_t* base, VI index) {
  return hn::BitCast(DU(), Gather(reinterpret_cast<const std::int32_t*>(base), index));
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

/// floor(v) of a finite v below 2^31, as float and integer.
HWY_INLINE VI FloorToInt(VF v, VF& floored) {
  floored = hn::Floor(v);
  return hn::ConvertTo(DI(), floored);
}

/// Binary logarithm of a positive normal number, relative error 2e-6: x = 2^e * (1 + t) with 1 + t in [sqrt(1/2),
/// sqrt(2)), and a minimax polynomial for log2(1 + t) / t.
HWY_INLINE VF Log2(VF x) {
  const DI di;
  const VI bits = hn::BitCast(di, x);
  const VI sqrt_half = hn::Set(di, 0x3F3504F3);
  const VI exponent = hn::ShiftRight<23>(hn::Sub(bits, sqrt_half));
  const VF t = hn::Sub(hn::BitCast(DF(), hn::Sub(bits, hn::ShiftLeft<23>(exponent))), Constant(1.0F));
  VF p = Constant(0.1761672209F);
  p = hn::Add(hn::Mul(p, t), Constant(-0.2709776867F));
  p = hn::Add(hn::Mul(p, t), Constant(0.295099796F));
  p = hn::Add(hn::Mul(p, t), Constant(-0.3591847787F));
  p = hn::Add(hn::Mul(p, t), Constant(0.4806487004F));
  p = hn::Add(hn::Mul(p, t), Constant(-0.7213676937F));
  p = hn::Add(hn::Mul(p, t), Constant(1.442696307F));
  return hn::Add(hn::ConvertTo(DF(), exponent), hn::Mul(p, t));
}

/// 2^x for x in [-126, 126] (clamped; NaN counts as -126), relative error 2e-7.
HWY_INLINE VF Exp2(VF x) {
  const VF clamped = Clamped(x, -126.0F, 126.0F);
  VF whole;
  const VI exponent = FloorToInt(hn::Add(clamped, Constant(0.5F)), whole);
  const VF f = hn::Sub(clamped, whole);
  VF p = Constant(0.001327647781F);
  p = hn::Add(hn::Mul(p, f), Constant(0.009675541363F));
  p = hn::Add(hn::Mul(p, f), Constant(0.05550713259F));
  p = hn::Add(hn::Mul(p, f), Constant(0.2402211972F));
  p = hn::Add(hn::Mul(p, f), Constant(0.6931469671F));
  p = hn::Add(hn::Mul(p, f), Constant(1.000000072F));
  return hn::BitCast(DF(), hn::Add(hn::BitCast(DI(), p), hn::ShiftLeft<23>(exponent)));
}

/// sin(2 pi turns), absolute error 2e-6; |turns| below 2^20.
HWY_INLINE VF SinOfTurns(VF turns) {
  const VF r = hn::Sub(turns, hn::Floor(hn::Add(turns, Constant(0.5F))));
  const VF mirrored = hn::Sub(hn::CopySign(Constant(0.5F), r), r);
  const VF t = hn::IfThenElse(hn::Gt(hn::Abs(r), Constant(0.25F)), mirrored, r);
  const VF t2 = hn::Mul(t, t);
  VF p = Constant(-70.99873502F);
  p = hn::Add(hn::Mul(p, t2), Constant(81.34139659F));
  p = hn::Add(hn::Mul(p, t2), Constant(-41.33716463F));
  p = hn::Add(hn::Mul(p, t2), Constant(6.283164265F));
  return hn::Mul(p, t);
}

HWY_INLINE VF Mix(VF a, VF b, VF t) {
  return hn::Add(a, hn::Mul(hn::Sub(b, a), t));
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
