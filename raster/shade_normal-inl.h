// raster/shade_normal-inl: octahedral normals [CDE14] in vectors.
#include "raster/shade_math-inl.h"

#if defined(SHEAF_RASTER_SHADE_NORMAL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHEAF_RASTER_SHADE_NORMAL_INL_H_
#undef SHEAF_RASTER_SHADE_NORMAL_INL_H_
#else
#define SHEAF_RASTER_SHADE_NORMAL_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace sheaf::raster::HWY_NAMESPACE {

/// 1 / sqrt(x) for x in [1/3, 1] to 2.3e-4: a quadratic (minimax, relative error 1.2e-2), then one Newton step. The
/// error is common to the three components of a normal: it shifts the weights of a triangle's corners by as much and
/// leaves no trace after the final normalisation where the corners agree.
HWY_INLINE VF InverseSqrtOfThirdToOne(VF x) {
  const VF p =
      hn::Add(hn::Mul(hn::Add(hn::Mul(x, Constant(1.25764868F)), Constant(-2.724458503F)), x), Constant(2.479128436F));
  return hn::Mul(p, hn::Sub(Constant(1.5F), hn::Mul(hn::Mul(hn::Mul(x, Constant(0.5F)), p), p)));
}

/// Unit vectors, to the accuracy above.
HWY_INLINE void UnpackNormals(VU packed, VF& x, VF& y, VF& z) {
  const DF d;
  const DI di;
  const VF u = hn::ConvertTo(d, hn::BitCast(di, hn::And(packed, hn::Set(DU(), 0xFFFFU))));
  const VF v = hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<16>(packed)));
  const VF px = hn::Sub(hn::Mul(u, Constant(2.0F / 65535.0F)), Constant(1.0F));
  const VF py = hn::Sub(hn::Mul(v, Constant(2.0F / 65535.0F)), Constant(1.0F));
  const VF pz = hn::Sub(hn::Sub(Constant(1.0F), hn::Abs(px)), hn::Abs(py));
  // The lower half is folded over the diagonals: there |x| becomes 1 - |y| = |x| + z, and |y| likewise.
  const VF fold = hn::Min(pz, hn::Zero(d));
  const VF qx = hn::Sub(px, hn::CopySign(fold, px));
  const VF qy = hn::Sub(py, hn::CopySign(fold, py));
  const VF inverse_length = InverseSqrtOfThirdToOne(Dot(qx, qy, pz, qx, qy, pz));
  x = hn::Mul(qx, inverse_length);
  y = hn::Mul(qy, inverse_length);
  z = hn::Mul(pz, inverse_length);
}

}  // namespace sheaf::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
