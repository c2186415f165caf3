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

/// Directions of packed normals as points q of an octahedron (of size 32767.5, so that unpacking is exact), and a
/// scale that makes all of them equally long, sqrt(1/2).
///
/// The scale is sqrt(1/2) / |q| to 2.3e-4: a quadratic (minimax on the |q|^2 that occur, relative error 1.2e-2), then
/// one Newton step, y (3/2 - |q|^2 y^2); the odd length saves a factor 1/2 there. The error shifts the weights of a
/// triangle's corners by as much and leaves no trace where the corners agree, as normals are normalised afterwards.
HWY_INLINE void UnpackDirections(VU packed, VF& qx, VF& qy, VF& qz, VF& scale) {
  const DF d;
  const DI di;
  const VF size = Constant(32767.5F);
  const VF u = hn::ConvertTo(d, hn::BitCast(di, hn::And(packed, hn::Set(DU(), 0xFFFFU))));
  const VF v = hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<16>(packed)));
  const VF px = hn::Sub(u, size);
  const VF py = hn::Sub(v, size);
  qz = hn::Sub(hn::Sub(size, hn::Abs(px)), hn::Abs(py));
  // The lower half is folded over the diagonals: there |x| becomes size - |y| = |x| + z, and |y| likewise.
  const VF fold = hn::Min(qz, hn::Zero(d));
  qx = hn::Sub(px, hn::CopySign(fold, px));
  qy = hn::Sub(py, hn::CopySign(fold, py));

  const VF squared = Dot(qx, qy, qz, qx, qy, qz);
  const VF slope = hn::Add(hn::Mul(squared, Constant(2.354115685e-23F)), Constant(-5.475644891e-14F));
  const VF y = hn::Add(hn::Mul(slope, squared), Constant(5.349839104e-05F));
  scale = hn::Mul(y, hn::Sub(Constant(1.5F), hn::Mul(hn::Mul(y, y), squared)));
}

}  // namespace sheaf::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
