#include "raster/setup.h"
#include "raster/setup_one.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/setup_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "raster/gather-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sheaf::raster::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kMaxLanes = 16;
const hn::CappedTag<std::int32_t, kMaxLanes> di;
const hn::RebindToFloat<decltype(di)> df;
using VI = hn::Vec<decltype(di)>;
using VF = hn::Vec<decltype(df)>;

// Within this extent, in subpixels, every product of two differences fits 30 bits, so that 32-bit edge functions are
// exact.
constexpr std::int32_t kMaxExtent = 32000;

unsigned MaskBits(hn::Mask<decltype(di)> mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(di, mask, bits);
  return bits[0] | static_cast<unsigned>(bits[1]) << 8;
}

struct EdgeLanes {
  VI a, b, e;  // e: at the centre of the reference pixel, unbiased
};

// Edge from corner j to corner k, as in raster/edges.h.
EdgeLanes EdgeOf(VI xj, VI yj, VI xk, VI yk, VI cx, VI cy) {
  const VI a = hn::Sub(yj, yk);
  const VI b = hn::Sub(xk, xj);
  return {a, b, hn::Add(hn::Mul(a, hn::Sub(cx, xj)), hn::Mul(b, hn::Sub(cy, yj)))};
}

// -1 unless the edge is a top or left one.
VI TopLeftBias(const EdgeLanes& edge) {
  const VI zero = hn::Zero(di);
  const auto top_left = hn::Or(hn::Gt(edge.a, zero), hn::And(hn::Eq(edge.a, zero), hn::Gt(edge.b, zero)));
  return hn::IfThenElse(top_left, zero, hn::Set(di, -1));
}

// Coverage of the 4x4 pixels at the reference pixel, bit 4 * row + column.
HWY_INLINE VI CoverSmall(const EdgeLanes& e0, const EdgeLanes& e1, const EdgeLanes& e2) {
  VI row0 = hn::Add(e0.e, TopLeftBias(e0));
  VI row1 = hn::Add(e1.e, TopLeftBias(e1));
  VI row2 = hn::Add(e2.e, TopLeftBias(e2));
  const VI step_x0 = hn::ShiftLeft<kSubpixelBits>(e0.a);
  const VI step_x1 = hn::ShiftLeft<kSubpixelBits>(e1.a);
  const VI step_x2 = hn::ShiftLeft<kSubpixelBits>(e2.a);
  const VI step_y0 = hn::ShiftLeft<kSubpixelBits>(e0.b);
  const VI step_y1 = hn::ShiftLeft<kSubpixelBits>(e1.b);
  const VI step_y2 = hn::ShiftLeft<kSubpixelBits>(e2.b);
  VI mask = hn::Zero(di);
  for (int y = 0; y < kSmallSize; ++y) {
    VI v0 = row0;
    VI v1 = row1;
    VI v2 = row2;
    for (int x = 0; x < kSmallSize; ++x) {
      const VI outside = hn::ShiftRight<31>(hn::Or(hn::Or(v0, v1), v2));
      mask = hn::Or(mask, hn::AndNot(outside, hn::Set(di, 1 << (kSmallSize * y + x))));
      v0 = hn::Add(v0, step_x0);
      v1 = hn::Add(v1, step_x1);
      v2 = hn::Add(v2, step_x2);
    }
    row0 = hn::Add(row0, step_y0);
    row1 = hn::Add(row1, step_y1);
    row2 = hn::Add(row2, step_y2);
  }
  return mask;
}

// What goes into memory for each surviving lane.
struct alignas(64) LaneOutput {
  float u0[3][kMaxLanes], ux[3][kMaxLanes], uy[3][kMaxLanes];
  float z[kMaxLanes], dzdx[kMaxLanes], dzdy[kMaxLanes], lo[kMaxLanes], hi[kMaxLanes];
  std::int32_t vertex[3][kMaxLanes];
  std::int32_t a[3][kMaxLanes], b[3][kMaxLanes], c[3][kMaxLanes];  // PixelEdge
  std::int32_t x_min[kMaxLanes], y_min[kMaxLanes], x_max[kMaxLanes], y_max[kMaxLanes];
  std::int32_t mask[kMaxLanes];
};

void StorePixelEdge(const EdgeLanes& edge, int i, LaneOutput& out) {
  hn::Store(edge.a, di, out.a[i]);
  hn::Store(edge.b, di, out.b[i]);
  hn::Store(hn::ShiftRight<kSubpixelBits>(hn::Add(edge.e, TopLeftBias(edge))), di, out.c[i]);
}

void EmitLane(const LaneOutput& out, int lane, bool small, bool turned, bool back, std::uint32_t t,
              const PatchTriangles& triangles, Binner& binner) {
  const std::uint32_t index = binner.newShadeTriangle();
  ShadeTriangle& shade = binner.shadeTriangle(index);
  // Shading wants the mesh's own order of corners.
  const int from[3] = {0, turned ? 2 : 1, turned ? 1 : 2};
  for (int i = 0; i < 3; ++i) {
    shade.u0[i] = out.u0[from[i]][lane];
    shade.ux[i] = out.ux[from[i]][lane];
    shade.uy[i] = out.uy[from[i]][lane];
    shade.vertex[i] = triangles.first_vertex + static_cast<std::uint32_t>(out.vertex[from[i]][lane]);
  }
  shade.ref_x = static_cast<std::int16_t>(out.x_min[lane]);
  shade.ref_y = static_cast<std::int16_t>(out.y_min[lane]);
  shade.surface = triangles.surface;
  shade.triangle = triangles.source[t];
  shade.back_face = back ? 1 : 0;
  const DepthPlane plane = {out.z[lane], out.dzdx[lane], out.dzdy[lane], out.lo[lane], out.hi[lane]};
  if (small) {
    binner.addSmall({shade.ref_x, shade.ref_y, static_cast<std::uint16_t>(out.mask[lane]), 0, plane, index});
  } else {
    LargeTriangle large;
    for (int i = 0; i < 3; ++i) large.edges[i] = {out.a[i][lane], out.b[i][lane], out.c[i][lane]};
    large.ref_x = shade.ref_x;
    large.ref_y = shade.ref_y;
    large.last_x = static_cast<std::int16_t>(out.x_max[lane]);
    large.last_y = static_cast<std::int16_t>(out.y_max[lane]);
    large.depth = plane;
    large.shade = index;
    binner.addLarge(large);
  }
}

void SetupTriangles(const ScreenVertices& vertices, const PatchTriangles& triangles, Binner& binner,
                    SetupCounts& counts) {
  const hn::Rebind<std::uint8_t, decltype(di)> du8;
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(di));
  const VI zero = hn::Zero(di);
  const VI one = hn::Set(di, 1);
  const VI half = hn::Set(di, kSubpixels / 2);
  const VI last_x = hn::Set(di, binner.width() - 1);
  const VI last_y = hn::Set(di, binner.height() - 1);
  const bool front_positive = triangles.facing.front_sign > 0;
  LaneOutput out;

  for (std::uint32_t t = 0; t < triangles.count; t += lanes) {
    const unsigned in_range = (1U << std::min(lanes, triangles.count - t)) - 1U;

    // Fetch the corners.
    const VI i0 = hn::PromoteTo(di, hn::LoadU(du8, triangles.corner[0] + t));
    VI i1 = hn::PromoteTo(di, hn::LoadU(du8, triangles.corner[1] + t));
    VI i2 = hn::PromoteTo(di, hn::LoadU(du8, triangles.corner[2] + t));
    const VI x0 = Gather(vertices.x_fx, i0);
    const VI y0 = Gather(vertices.y_fx, i0);
    VI x1 = Gather(vertices.x_fx, i1);
    VI y1 = Gather(vertices.y_fx, i1);
    VI x2 = Gather(vertices.x_fx, i2);
    VI y2 = Gather(vertices.y_fx, i2);

    // Bound them, in subpixels and in pixels whose centres may be covered.
    const VI x_lo = hn::Min(hn::Min(x0, x1), x2);
    const VI x_hi = hn::Max(hn::Max(x0, x1), x2);
    const VI y_lo = hn::Min(hn::Min(y0, y1), y2);
    const VI y_hi = hn::Max(hn::Max(y0, y1), y2);
    const VI x_min = hn::Max(zero, hn::ShiftRight<kSubpixelBits>(hn::Sub(hn::Add(x_lo, half), one)));
    const VI y_min = hn::Max(zero, hn::ShiftRight<kSubpixelBits>(hn::Sub(hn::Add(y_lo, half), one)));
    const VI x_max = hn::Min(last_x, hn::ShiftRight<kSubpixelBits>(hn::Sub(x_hi, half)));
    const VI y_max = hn::Min(last_y, hn::ShiftRight<kSubpixelBits>(hn::Sub(y_hi, half)));
    const VI max_extent = hn::Set(di, kMaxExtent);
    const unsigned wide =
        in_range & MaskBits(hn::Or(hn::Gt(hn::Sub(x_hi, x_lo), max_extent), hn::Gt(hn::Sub(y_hi, y_lo), max_extent)));
    const unsigned narrow = in_range & ~wide;

    // Cull by facing, then by box.
    const VI area = hn::Sub(hn::Mul(hn::Sub(x1, x0), hn::Sub(y2, y0)), hn::Mul(hn::Sub(x2, x0), hn::Sub(y1, y0)));
    const auto negative = hn::Lt(area, zero);
    const unsigned no_area = MaskBits(hn::Eq(area, zero));
    const unsigned negative_bits = MaskBits(negative);
    const unsigned back = front_positive ? negative_bits : ~negative_bits;
    const unsigned culled = narrow & (no_area | (triangles.facing.cull_back ? back : 0U));
    const unsigned no_pixel = MaskBits(hn::Or(hn::Gt(x_min, x_max), hn::Gt(y_min, y_max)));
    unsigned alive = narrow & ~culled & ~no_pixel;
    counts.back_facing += static_cast<unsigned>(__builtin_popcount(culled));
    counts.no_sample += static_cast<unsigned>(__builtin_popcount(narrow & ~culled & no_pixel));
    for (unsigned rest = wide; rest != 0; rest &= rest - 1)
      setupOne(vertices, triangles, t + static_cast<std::uint32_t>(__builtin_ctz(rest)), binner, counts);
    if (alive == 0) continue;

    // Turn triangles of negative area round.
    const VI x1_in = x1;
    const VI y1_in = y1;
    const VI i1_in = i1;
    x1 = hn::IfThenElse(negative, x2, x1);
    y1 = hn::IfThenElse(negative, y2, y1);
    i1 = hn::IfThenElse(negative, i2, i1);
    x2 = hn::IfThenElse(negative, x1_in, x2);
    y2 = hn::IfThenElse(negative, y1_in, y2);
    i2 = hn::IfThenElse(negative, i1_in, i2);

    // Cover the small ones; drop those that cover nothing.
    const VI cx = hn::Add(hn::ShiftLeft<kSubpixelBits>(x_min), half);
    const VI cy = hn::Add(hn::ShiftLeft<kSubpixelBits>(y_min), half);
    const EdgeLanes e0 = EdgeOf(x1, y1, x2, y2, cx, cy);
    const EdgeLanes e1 = EdgeOf(x2, y2, x0, y0, cx, cy);
    const EdgeLanes e2 = EdgeOf(x0, y0, x1, y1, cx, cy);
    const VI columns = hn::Sub(x_max, x_min);
    const VI rows = hn::Sub(y_max, y_min);
    const VI small_max = hn::Set(di, kSmallSize - 1);
    const unsigned small = alive & ~MaskBits(hn::Or(hn::Gt(columns, small_max), hn::Gt(rows, small_max)));
    if (small != 0) {
      // Pixels of the 4x4 beyond the box lie beyond the target's edge or are not covered.
      VI in_box = hn::Set(di, 0xFFFF);
      in_box = hn::IfThenElse(hn::Lt(columns, hn::Set(di, 3)), hn::And(in_box, hn::Set(di, 0x7777)), in_box);
      in_box = hn::IfThenElse(hn::Lt(columns, hn::Set(di, 2)), hn::And(in_box, hn::Set(di, 0x3333)), in_box);
      in_box = hn::IfThenElse(hn::Lt(columns, one), hn::And(in_box, hn::Set(di, 0x1111)), in_box);
      in_box = hn::IfThenElse(hn::Lt(rows, hn::Set(di, 3)), hn::And(in_box, hn::Set(di, 0x0FFF)), in_box);
      in_box = hn::IfThenElse(hn::Lt(rows, hn::Set(di, 2)), hn::And(in_box, hn::Set(di, 0x00FF)), in_box);
      in_box = hn::IfThenElse(hn::Lt(rows, one), hn::And(in_box, hn::Set(di, 0x000F)), in_box);
      const VI mask = hn::And(CoverSmall(e0, e1, e2), in_box);
      hn::Store(mask, di, out.mask);
      const unsigned empty = small & MaskBits(hn::Eq(mask, zero));
      counts.no_sample += static_cast<unsigned>(__builtin_popcount(empty));
      alive &= ~empty;
      if (alive == 0) continue;
    }
    counts.binned += static_cast<unsigned>(__builtin_popcount(alive));

    // Planes of depth and of barycentrics over w.
    const VF positive_area = hn::ConvertTo(df, hn::Abs(area));
    const VF inv_area = hn::Div(hn::Set(df, 1.0F), positive_area);
    const VF subpixels = hn::Set(df, static_cast<float>(kSubpixels));
    const VF f1e = hn::ConvertTo(df, e1.e);
    const VF f2e = hn::ConvertTo(df, e2.e);
    const VF f1a = hn::ConvertTo(df, e1.a);
    const VF f2a = hn::ConvertTo(df, e2.a);
    const VF f1b = hn::ConvertTo(df, e1.b);
    const VF f2b = hn::ConvertTo(df, e2.b);
    const VF z0 = Gather(vertices.depth, i0);
    const VF z1 = Gather(vertices.depth, i1);
    const VF z2 = Gather(vertices.depth, i2);
    const VF d1 = hn::Sub(z1, z0);
    const VF d2 = hn::Sub(z2, z0);
    const VF inv_area_px = hn::Mul(inv_area, subpixels);
    hn::Store(hn::Add(z0, hn::Mul(hn::Add(hn::Mul(f1e, d1), hn::Mul(f2e, d2)), inv_area)), df, out.z);
    hn::Store(hn::Mul(hn::Add(hn::Mul(f1a, d1), hn::Mul(f2a, d2)), inv_area_px), df, out.dzdx);
    hn::Store(hn::Mul(hn::Add(hn::Mul(f1b, d1), hn::Mul(f2b, d2)), inv_area_px), df, out.dzdy);
    hn::Store(hn::Min(hn::Min(z0, z1), z2), df, out.lo);
    hn::Store(hn::Max(hn::Max(z0, z1), z2), df, out.hi);
    const VF s0 = hn::Mul(inv_area, Gather(vertices.inv_w, i0));
    const VF s1 = hn::Mul(inv_area, Gather(vertices.inv_w, i1));
    const VF s2 = hn::Mul(inv_area, Gather(vertices.inv_w, i2));
    const VF s0_px = hn::Mul(s0, subpixels);
    const VF s1_px = hn::Mul(s1, subpixels);
    const VF s2_px = hn::Mul(s2, subpixels);
    hn::Store(hn::Mul(hn::ConvertTo(df, e0.e), s0), df, out.u0[0]);
    hn::Store(hn::Mul(f1e, s1), df, out.u0[1]);
    hn::Store(hn::Mul(f2e, s2), df, out.u0[2]);
    hn::Store(hn::Mul(hn::ConvertTo(df, e0.a), s0_px), df, out.ux[0]);
    hn::Store(hn::Mul(f1a, s1_px), df, out.ux[1]);
    hn::Store(hn::Mul(f2a, s2_px), df, out.ux[2]);
    hn::Store(hn::Mul(hn::ConvertTo(df, e0.b), s0_px), df, out.uy[0]);
    hn::Store(hn::Mul(f1b, s1_px), df, out.uy[1]);
    hn::Store(hn::Mul(f2b, s2_px), df, out.uy[2]);
    hn::Store(i0, di, out.vertex[0]);
    hn::Store(i1, di, out.vertex[1]);
    hn::Store(i2, di, out.vertex[2]);
    hn::Store(x_min, di, out.x_min);
    hn::Store(y_min, di, out.y_min);
    if ((alive & ~small) != 0) {
      StorePixelEdge(e0, 0, out);
      StorePixelEdge(e1, 1, out);
      StorePixelEdge(e2, 2, out);
      hn::Store(x_max, di, out.x_max);
      hn::Store(y_max, di, out.y_max);
    }

    for (unsigned rest = alive; rest != 0; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      EmitLane(out, lane, (small >> lane & 1U) != 0, (negative_bits >> lane & 1U) != 0, (back >> lane & 1U) != 0,
               t + static_cast<std::uint32_t>(lane), triangles, binner);
    }
  }
}

}  // namespace sheaf::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sheaf::raster {
HWY_EXPORT(SetupTriangles);
void setupTriangles(const ScreenVertices& vertices, const PatchTriangles& triangles, Binner& binner,
                    SetupCounts& counts) {
  HWY_DYNAMIC_DISPATCH(SetupTriangles)(vertices, triangles, binner, counts);
}
}  // namespace sheaf::raster
#endif
