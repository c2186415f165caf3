// raster/shade_albedo-inl: the colour of a surface before light: base colour times vertex colour, texture and solid.
#include "raster/shade_fetch-inl.h"
#include "raster/shade_solid-inl.h"
#include "raster/shade_texture-inl.h"

#if defined(SHEAF_RASTER_SHADE_ALBEDO_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHEAF_RASTER_SHADE_ALBEDO_INL_H_
#undef SHEAF_RASTER_SHADE_ALBEDO_INL_H_
#else
#define SHEAF_RASTER_SHADE_ALBEDO_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace sheaf::raster::HWY_NAMESPACE {

/// One vector of a block's fragments.
struct Fragments {
  const BlockFragments& block;
  std::size_t begin;

  VF barycentric(int corner) const { return hn::Load(DF(), block.barycentric[corner] + begin); }
  VI vertex(int corner) const { return hn::Load(DI(), block.vertex[corner] + begin); }
  VF along_x(int corner) const { return hn::Load(DF(), block.along_x[corner] + begin); }
  VF along_y(int corner) const { return hn::Load(DF(), block.along_y[corner] + begin); }
};

HWY_INLINE VF Interpolate(const Fragments& at, VF a0, VF a1, VF a2) {
  return Dot(at.barycentric(0), at.barycentric(1), at.barycentric(2), a0, a1, a2);
}

HWY_INLINE void MultiplyByVertexColor(const std::array<const std::uint32_t*, 2>& color, const Fragments& at, VF& r,
                                      VF& g, VF& b) {
  const DF d;
  const DI di;
  VF sum_r = hn::Zero(d);
  VF sum_g = hn::Zero(d);
  VF sum_b = hn::Zero(d);
  for (int corner = 0; corner < 3; ++corner) {
    const VI rg = hn::BitCast(di, Gather(color[0], at.vertex(corner)));
    const VI ba = hn::BitCast(di, Gather(color[1], at.vertex(corner)));
    const VF weight = hn::Mul(at.barycentric(corner), Constant(1.0F / 65535.0F));
    const VI green = hn::BitCast(di, hn::ShiftRight<16>(hn::BitCast(DU(), rg)));
    sum_r = hn::Add(sum_r, hn::Mul(weight, hn::ConvertTo(d, hn::And(rg, hn::Set(di, 0xFFFF)))));
    sum_g = hn::Add(sum_g, hn::Mul(weight, hn::ConvertTo(d, green)));
    sum_b = hn::Add(sum_b, hn::Mul(weight, hn::ConvertTo(d, hn::And(ba, hn::Set(di, 0xFFFF)))));
  }
  r = hn::Mul(r, sum_r);
  g = hn::Mul(g, sum_g);
  b = hn::Mul(b, sum_b);
}

/// A texture coordinate of the mesh and its derivatives by x and y in the frame, from the planes of screen.h:
/// d(sum b_i t_i) = (sum du_i t_i - t sum du_i) / sum u, where du_i / sum u is along_x or along_y.
HWY_INLINE void InterpolateWithSlopes(const float* coordinate, const Fragments& at, VF& value, VF& by_x, VF& by_y) {
  const VF t0 = Gather(coordinate, at.vertex(0));
  const VF t1 = Gather(coordinate, at.vertex(1));
  const VF t2 = Gather(coordinate, at.vertex(2));
  value = Interpolate(at, t0, t1, t2);
  // With t_i - t in place of t_i the second sum is part of the first, and large coordinates cancel early.
  const VF d0 = hn::Sub(t0, value);
  const VF d1 = hn::Sub(t1, value);
  const VF d2 = hn::Sub(t2, value);
  by_x = Dot(at.along_x(0), at.along_x(1), at.along_x(2), d0, d1, d2);
  by_y = Dot(at.along_y(0), at.along_y(1), at.along_y(2), d0, d1, d2);
}

HWY_INLINE void MultiplyByTexture(const Surface& surface, const ShadeMaterial& material, const Fragments& at, VF& r,
                                  VF& g, VF& b) {
  VF mesh_u, mesh_v, mesh_u_x, mesh_u_y, mesh_v_x, mesh_v_y;
  InterpolateWithSlopes(surface.texcoord[0], at, mesh_u, mesh_u_x, mesh_u_y);
  InterpolateWithSlopes(surface.texcoord[1], at, mesh_v, mesh_v_x, mesh_v_y);
  const glm::mat2& m = material.uv_linear;
  const auto transformed = [&](int row, VF u, VF v) HWY_ATTR {
    return hn::Add(hn::Mul(Constant(m[0][row]), u), hn::Mul(Constant(m[1][row]), v));
  };
  const VF u = hn::Add(transformed(0, mesh_u, mesh_v), Constant(material.uv_offset.x));
  const VF v = hn::Add(transformed(1, mesh_u, mesh_v), Constant(material.uv_offset.y));
  const VF width = Constant(static_cast<float>(material.texture->level(0).width));
  const VF height = Constant(static_cast<float>(material.texture->level(0).height));
  const auto length_squared = [&](VF mesh_du, VF mesh_dv) HWY_ATTR {
    const VF du = hn::Mul(transformed(0, mesh_du, mesh_dv), width);
    const VF dv = hn::Mul(transformed(1, mesh_du, mesh_dv), height);
    return hn::Add(hn::Mul(du, du), hn::Mul(dv, dv));
  };
  const VF squared_x = length_squared(mesh_u_x, mesh_v_x);
  const VF squared_y = length_squared(mesh_u_y, mesh_v_y);
  const VF longer = hn::IfThenElse(hn::Gt(squared_x, squared_y), squared_x, squared_y);
  VF texel_r, texel_g, texel_b;
  SampleTexture(*material.texture, material.sampler, u, v, longer, texel_r, texel_g, texel_b);
  r = hn::Mul(r, texel_r);
  g = hn::Mul(g, texel_g);
  b = hn::Mul(b, texel_b);
}

HWY_INLINE void MultiplyBySolid(const Surface& surface, const ShadeMaterial& material, const Fragments& at, VF& r,
                                VF& g, VF& b) {
  const auto coordinate = [&](std::size_t axis) HWY_ATTR {
    const float* position = surface.position_object[axis];
    const VF p =
        Interpolate(at, Gather(position, at.vertex(0)), Gather(position, at.vertex(1)), Gather(position, at.vertex(2)));
    return hn::Mul(p, Constant(material.solid_frequency));
  };
  const VF share = SolidShare(material.solid, coordinate(0), coordinate(1), coordinate(2));
  const Vec3& first = material.solid_colors[0];
  const Vec3& second = material.solid_colors[1];
  r = hn::Mul(r, Mix(Constant(first.x), Constant(second.x), share));
  g = hn::Mul(g, Mix(Constant(first.y), Constant(second.y), share));
  b = hn::Mul(b, Mix(Constant(first.z), Constant(second.z), share));
}

inline bool HasTexture(const Surface& surface, const ShadeMaterial& material) {
  return material.texture != nullptr && surface.texcoord[0] != nullptr;
}

/// Whether the colour varies over the surface.
inline bool HasPattern(const Surface& surface, const ShadeMaterial& material) {
  return HasTexture(surface, material) || surface.color[0] != nullptr || material.solid != SolidTexture::kNone;
}

/// Fills the albedo of all vectors that have lanes to shade.
HWY_NOINLINE void FetchAlbedo(const Surface& surface, const ShadeMaterial& material, BlockFragments& fragments) {
  const DF d;
  for (std::size_t begin = 0; begin < kBlockPixels; begin += hn::Lanes(d)) {
    if (fragments.lanes[begin] == 0) continue;
    const Fragments at{fragments, begin};
    VF r = Constant(material.base_color.x);
    VF g = Constant(material.base_color.y);
    VF b = Constant(material.base_color.z);
    if (surface.color[0] != nullptr) MultiplyByVertexColor(surface.color, at, r, g, b);
    if (HasTexture(surface, material)) MultiplyByTexture(surface, material, at, r, g, b);
    if (material.solid != SolidTexture::kNone) MultiplyBySolid(surface, material, at, r, g, b);
    hn::Store(r, d, fragments.albedo[0] + begin);
    hn::Store(g, d, fragments.albedo[1] + begin);
    hn::Store(b, d, fragments.albedo[2] + begin);
  }
}

}  // namespace sheaf::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
