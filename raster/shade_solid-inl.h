// raster/shade_solid-inl: marble, wood and checker as functions of the position, after [Per85]: marble is a sine bent
// by turbulence, wood is distance from an axis, both disturbed by gradient noise [Per02] on hashed lattice points. The
// plain form is in raster/shade_reference.cpp.
#include "raster/shade.h"
#include "raster/shade_math-inl.h"

#if defined(SHEAF_RASTER_SHADE_SOLID_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHEAF_RASTER_SHADE_SOLID_INL_H_
#undef SHEAF_RASTER_SHADE_SOLID_INL_H_
#else
#define SHEAF_RASTER_SHADE_SOLID_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace sheaf::raster::HWY_NAMESPACE {

/// Dot product of (x, y, z) with one of twelve edge directions, chosen by the hash.
HWY_INLINE VF EdgeGradient(VU hash, VF x, VF y, VF z) {
  const DF d;
  const DU du;
  const auto has = [&](std::uint32_t mask, std::uint32_t value) HWY_ATTR {
    return hn::RebindMask(d, hn::Eq(hn::And(hash, hn::Set(du, mask)), hn::Set(du, value)));
  };
  const VF u = hn::IfThenElse(has(8, 0), x, y);
  const VF v = hn::IfThenElse(has(12, 0), y, hn::IfThenElse(has(13, 12), x, z));
  const VF sign_u = hn::BitCast(d, hn::ShiftLeft<31>(hash));
  const VF sign_v = hn::BitCast(d, hn::ShiftLeft<31>(hn::ShiftRight<1>(hash)));
  return hn::Add(hn::Xor(u, sign_u), hn::Xor(v, sign_v));
}

/// Bits 0 to 3 are well mixed.
HWY_INLINE VU MixHash(VU h) {
  const DU du;
  h = hn::Mul(hn::Xor(h, hn::ShiftRight<15>(h)), hn::Set(du, 0x2C1B3C6DU));
  return hn::ShiftRight<20>(hn::Xor(h, hn::ShiftRight<12>(h)));
}

/// 6 t^5 - 15 t^4 + 10 t^3
HWY_INLINE VF Fade(VF t) {
  const VF p = hn::Add(hn::Mul(hn::Sub(hn::Mul(t, Constant(6.0F)), Constant(15.0F)), t), Constant(10.0F));
  return hn::Mul(hn::Mul(hn::Mul(t, t), t), p);
}

/// Gradient noise, about [-1, 1], 0 at lattice points. Coordinates of any size; beyond 2^20 it is constant.
HWY_INLINE VF Noise(VF x, VF y, VF z) {
  const DU du;
  constexpr float kLimit = 1048576.0F;
  const VF cx = Clamped(x, -kLimit, kLimit);
  const VF cy = Clamped(y, -kLimit, kLimit);
  const VF cz = Clamped(z, -kLimit, kLimit);
  VF fx, fy, fz;
  const VU prime_x = hn::Set(du, 0x8DA6B343U);
  const VU prime_y = hn::Set(du, 0xD8163841U);
  const VU prime_z = hn::Set(du, 0xCB1AB31FU);
  const VU hx0 = hn::Mul(hn::BitCast(du, FloorToInt(cx, fx)), prime_x);
  const VU hy0 = hn::Mul(hn::BitCast(du, FloorToInt(cy, fy)), prime_y);
  const VU hz0 = hn::Mul(hn::BitCast(du, FloorToInt(cz, fz)), prime_z);
  const VU hx1 = hn::Add(hx0, prime_x);
  const VU hy1 = hn::Add(hy0, prime_y);
  const VU hz1 = hn::Add(hz0, prime_z);
  const VF one = Constant(1.0F);
  const VF x0 = hn::Sub(cx, fx);
  const VF y0 = hn::Sub(cy, fy);
  const VF z0 = hn::Sub(cz, fz);
  const VF x1 = hn::Sub(x0, one);
  const VF y1 = hn::Sub(y0, one);
  const VF z1 = hn::Sub(z0, one);
  const VF blend_x = Fade(x0);
  const auto edge = [&](VU hyz, VF dy, VF dz) HWY_ATTR {
    const VF at0 = EdgeGradient(MixHash(hn::Xor(hx0, hyz)), x0, dy, dz);
    const VF at1 = EdgeGradient(MixHash(hn::Xor(hx1, hyz)), x1, dy, dz);
    return Mix(at0, at1, blend_x);
  };
  const VF blend_y = Fade(y0);
  const VF near_side = Mix(edge(hn::Xor(hy0, hz0), y0, z0), edge(hn::Xor(hy1, hz0), y1, z0), blend_y);
  const VF far_side = Mix(edge(hn::Xor(hy0, hz1), y0, z1), edge(hn::Xor(hy1, hz1), y1, z1), blend_y);
  return Mix(near_side, far_side, Fade(z0));
}

/// Sum of |noise| over octaves, each at twice the frequency and half the strength: creased like folds.
HWY_INLINE VF Turbulence(VF x, VF y, VF z) {
  constexpr int kOctaves = 5;
  VF sum = hn::Zero(DF());
  float scale = 1.0F;
  float strength = 1.0F;
  for (int octave = 0; octave < kOctaves; ++octave) {
    const VF s = Constant(scale);
    const VF n = Noise(hn::Mul(x, s), hn::Mul(y, s), hn::Mul(z, s));
    sum = hn::Add(sum, hn::Mul(hn::Abs(n), Constant(strength)));
    scale *= 2.03F;  // not 2, so that the lattices' common points do not show
    strength *= 0.5F;
  }
  return sum;
}

/// Share of the second colour: thin dark veins across a cloudy ground, one per unit along x + z / 2.
HWY_INLINE VF Marble(VF x, VF y, VF z) {
  const VF t = Turbulence(x, y, z);
  const VF along = hn::Add(hn::Add(x, hn::Mul(z, Constant(0.5F))), hn::Mul(y, Constant(0.25F)));
  const VF wave = SinOfTurns(hn::Mul(hn::Add(along, hn::Mul(t, Constant(1.5F))), Constant(0.5F)));
  // 1 - |sin| is 1 in the middle of a vein: its second power is a broad soft shade, its sixth a thin line.
  const VF ridge = hn::Sub(Constant(1.0F), hn::Abs(wave));
  const VF soft = hn::Mul(ridge, ridge);
  const VF thin = hn::Mul(hn::Mul(soft, soft), soft);
  const VF cloud = hn::Mul(hn::Mul(t, t), Constant(0.12F));
  const VF share = hn::Add(hn::Add(hn::Mul(soft, Constant(0.3F)), hn::Mul(thin, Constant(0.55F))), cloud);
  return Clamped(share, 0.0F, 1.0F);
}

/// Share of the second colour: rings about the y axis, one per unit, each turning slowly dark and abruptly light again;
/// fine fibres along y.
HWY_INLINE VF Wood(VF x, VF y, VF z) {
  const auto noise_at = [&](float across, float along) HWY_ATTR {
    return Noise(hn::Mul(x, Constant(across)), hn::Mul(y, Constant(along)), hn::Mul(z, Constant(across)));
  };
  const VF radius = hn::Sqrt(hn::Add(hn::Mul(x, x), hn::Mul(z, z)));
  const VF wobble =
      hn::Add(hn::Mul(noise_at(0.35F, 0.12F), Constant(0.6F)), hn::Mul(noise_at(1.3F, 0.3F), Constant(0.12F)));
  const VF ring = Clamped(hn::Add(radius, wobble), -1048576.0F, 1048576.0F);
  const VF phase = hn::Sub(ring, hn::Floor(ring));
  // Late wood: rises over the ring with the third power, falls within the last eighth.
  const VF rise = hn::Mul(hn::Mul(phase, phase), phase);
  const VF fall = hn::Min(hn::Mul(hn::Sub(Constant(1.0F), phase), Constant(8.0F)), Constant(1.0F));
  const VF fibre = hn::Mul(noise_at(14.0F, 0.7F), Constant(0.18F));
  return Clamped(hn::Add(hn::Add(hn::Mul(hn::Mul(rise, fall), Constant(0.9F)), Constant(0.08F)), fibre), 0.0F, 1.0F);
}

/// Share of the second colour: cubes of one unit. Faces at whole coordinates lie within a cube, not between two.
HWY_INLINE VF Checker(VF x, VF y, VF z) {
  const auto cell = [](VF v) HWY_ATTR {
    VF floored;
    return FloorToInt(Clamped(hn::Add(v, Constant(1.0F / 1024.0F)), -1048576.0F, 1048576.0F), floored);
  };
  const VI sum = hn::Add(hn::Add(cell(x), cell(y)), cell(z));
  return hn::ConvertTo(DF(), hn::And(sum, hn::Set(DI(), 1)));
}

HWY_INLINE VF SolidShare(SolidTexture solid, VF x, VF y, VF z) {
  if (solid == SolidTexture::kMarble) return Marble(x, y, z);
  if (solid == SolidTexture::kWood) return Wood(x, y, z);
  return Checker(x, y, z);
}

}  // namespace sheaf::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
