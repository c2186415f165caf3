#include <cstddef>
#include <cstring>

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
static_assert(std::int64_t{kMaxExtent} * kMaxExtent < 1 << 30);

unsigned MaskBits(hn::Mask<decltype(di)> mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(di, mask, bits);
  return bits[0] | static_cast<unsigned>(bits[1]) << 8;
}

#if HWY_TARGET == HWY_SCALAR || HWY_HAVE_SCALABLE

HWY_INLINE void LoadVertices(const ScreenVertex* vertices, const std::uint8_t* index, VI& x, VI& y, VF& depth,
                             VF& inv_w) {
  const hn::Rebind<std::uint8_t, decltype(di)> du8;
  const VI first = hn::ShiftLeft<2>(hn::PromoteTo(di, hn::LoadU(du8, index)));
  x = Gather(&vertices->x_fx, first);
  y = Gather(&vertices->x_fx + 1, first);
  depth = Gather(&vertices->depth, first);
  inv_w = Gather(&vertices->depth + 1, first);
}

#else

// The vertices index[0], index[4] and so on, one in each 128-bit block.
template <class D>
HWY_INLINE hn::Vec<D> LoadVertexBlocks(D d, const ScreenVertex* vertices, const std::uint8_t* index) {
  if constexpr (hn::MaxLanes(D()) == 4) {
    return hn::Load(d, &vertices[*index].x_fx);
  } else {
    const hn::Half<D> half;
    return hn::Combine(d, LoadVertexBlocks(half, vertices, index + hn::MaxLanes(half)),
                       LoadVertexBlocks(half, vertices, index));
  }
}

// A vector of vertices: loads of whole ones and a transposition are twice as fast as gathers of their words.
HWY_INLINE void LoadVertices(const ScreenVertex* vertices, const std::uint8_t* index, VI& x, VI& y, VF& depth,
                             VF& inv_w) {
  VI depth_bits, inv_w_bits;
  TransposeBlocks(LoadVertexBlocks(di, vertices, index), LoadVertexBlocks(di, vertices, index + 1),
                  LoadVertexBlocks(di, vertices, index + 2), LoadVertexBlocks(di, vertices, index + 3), x, y,
                  depth_bits, inv_w_bits);
  depth = hn::BitCast(df, depth_bits);
  inv_w = hn::BitCast(df, inv_w_bits);
}

#endif

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

// What goes into memory for each surviving lane: quarters of its ShadeTriangle, halves of its BinEntry, and what a
// LargeTriangle needs besides.
struct alignas(64) LaneOutput {
  std::uint32_t shade[4][kMaxLanes][4];
  std::uint32_t entry[2][kMaxLanes][4];
  std::int32_t a[3][kMaxLanes], b[3][kMaxLanes], c[3][kMaxLanes];  // PixelEdge
  std::int32_t x_max[kMaxLanes], y_max[kMaxLanes];
};
static_assert(sizeof(ShadeTriangle) == 4 * sizeof(LaneOutput::shade[0][0]));
static_assert(offsetof(ShadeTriangle, ux) == 12 && offsetof(ShadeTriangle, uy) == 24);
static_assert(offsetof(ShadeTriangle, ref_x) == 36 && offsetof(ShadeTriangle, vertex) == 40);
static_assert(offsetof(ShadeTriangle, surface) == 52 && offsetof(ShadeTriangle, back_face) == 60);
static_assert(sizeof(BinEntry) == 2 * sizeof(LaneOutput::entry[0][0]));
static_assert(offsetof(BinEntry, mask) == 4 && offsetof(BinEntry, depth) == 8 && offsetof(BinEntry, index) == 28);

// Four words of every lane, lane by lane.
HWY_INLINE void StoreWords(VI w0, VI w1, VI w2, VI w3, std::uint32_t (&to)[kMaxLanes][4]) {
  const hn::RebindToUnsigned<decltype(di)> du;
  hn::StoreInterleaved4(hn::BitCast(du, w0), hn::BitCast(du, w1), hn::BitCast(du, w2), hn::BitCast(du, w3), du, to[0]);
}

HWY_INLINE VI Bits(VF v) {
  return hn::BitCast(di, v);
}

void StorePixelEdge(const EdgeLanes& edge, int i, LaneOutput& out) {
  hn::Store(edge.a, di, out.a[i]);
  hn::Store(edge.b, di, out.b[i]);
  hn::Store(hn::ShiftRight<kSubpixelBits>(hn::Add(edge.e, TopLeftBias(edge))), di, out.c[i]);
}

HWY_INLINE void EmitLane(const LaneOutput& out, std::size_t lane, bool small, std::uint32_t triangle, Binner& binner) {
  const std::uint32_t index = binner.newShadeTriangle();
  ShadeTriangle& shade = binner.shadeTriangle(index);
  for (std::size_t quarter = 0; quarter < 4; ++quarter)
    std::memcpy(reinterpret_cast<char*>(&shade) + 16 * quarter, out.shade[quarter][lane], 16);
  shade.triangle = triangle;
  BinEntry entry;
  for (std::size_t half = 0; half < 2; ++half)
    std::memcpy(reinterpret_cast<char*>(&entry) + 16 * half, out.entry[half][lane], 16);
  entry.index = index;
  if (small) {
    binner.addSmall(entry);
    return;
  }
  LargeTriangle large;
  for (int i = 0; i < 3; ++i) large.edges[i] = {out.a[i][lane], out.b[i][lane], out.c[i][lane]};
  large.ref_x = entry.x;
  large.ref_y = entry.y;
  large.last_x = static_cast<std::int16_t>(out.x_max[lane]);
  large.last_y = static_cast<std::int16_t>(out.y_max[lane]);
  large.depth = entry.depth;
  large.shade = index;
  binner.addLarge(large);
}

void SetupTriangles(const ScreenVertex* vertices, const PatchTriangles& triangles, Binner& binner,
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
    VI x0, y0, x1, y1, x2, y2;
    VF z0, z1, z2, inv_w0, inv_w1, inv_w2;
    LoadVertices(vertices, triangles.corner[0] + t, x0, y0, z0, inv_w0);
    LoadVertices(vertices, triangles.corner[1] + t, x1, y1, z1, inv_w1);
    LoadVertices(vertices, triangles.corner[2] + t, x2, y2, z2, inv_w2);

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
    const VF z1_in = z1;
    const VF inv_w1_in = inv_w1;
    const auto turned = hn::RebindMask(df, negative);
    x1 = hn::IfThenElse(negative, x2, x1);
    y1 = hn::IfThenElse(negative, y2, y1);
    z1 = hn::IfThenElse(turned, z2, z1);
    inv_w1 = hn::IfThenElse(turned, inv_w2, inv_w1);
    x2 = hn::IfThenElse(negative, x1_in, x2);
    y2 = hn::IfThenElse(negative, y1_in, y2);
    z2 = hn::IfThenElse(turned, z1_in, z2);
    inv_w2 = hn::IfThenElse(turned, inv_w1_in, inv_w2);

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
    VI mask = zero;
    if (small != 0) {
      // Pixels of the 4x4 beyond the box lie beyond the target's edge or are not covered.
      VI in_box = hn::Set(di, 0xFFFF);
      in_box = hn::IfThenElse(hn::Lt(columns, hn::Set(di, 3)), hn::And(in_box, hn::Set(di, 0x7777)), in_box);
      in_box = hn::IfThenElse(hn::Lt(columns, hn::Set(di, 2)), hn::And(in_box, hn::Set(di, 0x3333)), in_box);
      in_box = hn::IfThenElse(hn::Lt(columns, one), hn::And(in_box, hn::Set(di, 0x1111)), in_box);
      in_box = hn::IfThenElse(hn::Lt(rows, hn::Set(di, 3)), hn::And(in_box, hn::Set(di, 0x0FFF)), in_box);
      in_box = hn::IfThenElse(hn::Lt(rows, hn::Set(di, 2)), hn::And(in_box, hn::Set(di, 0x00FF)), in_box);
      in_box = hn::IfThenElse(hn::Lt(rows, one), hn::And(in_box, hn::Set(di, 0x000F)), in_box);
      mask = hn::And(CoverSmall(e0, e1, e2), in_box);
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
    const VF d1 = hn::Sub(z1, z0);
    const VF d2 = hn::Sub(z2, z0);
    const VF inv_area_px = hn::Mul(inv_area, subpixels);
    const VF z = hn::Add(z0, hn::Mul(hn::Add(hn::Mul(f1e, d1), hn::Mul(f2e, d2)), inv_area));
    const VF dzdx = hn::Mul(hn::Add(hn::Mul(f1a, d1), hn::Mul(f2a, d2)), inv_area_px);
    const VF dzdy = hn::Mul(hn::Add(hn::Mul(f1b, d1), hn::Mul(f2b, d2)), inv_area_px);
    const VI ref = hn::Or(hn::And(x_min, hn::Set(di, 0xFFFF)), hn::ShiftLeft<16>(y_min));
    StoreWords(ref, mask, Bits(z), Bits(dzdx), out.entry[0]);
    StoreWords(Bits(dzdy), Bits(hn::Min(hn::Min(z0, z1), z2)), Bits(hn::Max(hn::Max(z0, z1), z2)), zero, out.entry[1]);

    const VF s0 = hn::Mul(inv_area, inv_w0);
    const VF s1 = hn::Mul(inv_area, inv_w1);
    const VF s2 = hn::Mul(inv_area, inv_w2);
    const VF s0_px = hn::Mul(s0, subpixels);
    const VF s1_px = hn::Mul(s1, subpixels);
    const VF s2_px = hn::Mul(s2, subpixels);
    const VF u0_1 = hn::Mul(f1e, s1);
    const VF u0_2 = hn::Mul(f2e, s2);
    const VF ux_1 = hn::Mul(f1a, s1_px);
    const VF ux_2 = hn::Mul(f2a, s2_px);
    const VF uy_1 = hn::Mul(f1b, s1_px);
    const VF uy_2 = hn::Mul(f2b, s2_px);
    // Shading wants the mesh's own order of corners.
    const VI first_vertex = hn::Set(di, static_cast<std::int32_t>(triangles.first_vertex));
    const auto vertex = [&](std::size_t corner) HWY_ATTR {
      return hn::Add(first_vertex, hn::PromoteTo(di, hn::LoadU(du8, triangles.corner[corner] + t)));
    };
    const VI back_lanes =
        hn::IfThenElse(negative, hn::Set(di, front_positive ? 1 : 0), hn::Set(di, front_positive ? 0 : 1));
    StoreWords(Bits(hn::Mul(hn::ConvertTo(df, e0.e), s0)), Bits(hn::IfThenElse(turned, u0_2, u0_1)),
               Bits(hn::IfThenElse(turned, u0_1, u0_2)), Bits(hn::Mul(hn::ConvertTo(df, e0.a), s0_px)), out.shade[0]);
    StoreWords(Bits(hn::IfThenElse(turned, ux_2, ux_1)), Bits(hn::IfThenElse(turned, ux_1, ux_2)),
               Bits(hn::Mul(hn::ConvertTo(df, e0.b), s0_px)), Bits(hn::IfThenElse(turned, uy_2, uy_1)), out.shade[1]);
    StoreWords(Bits(hn::IfThenElse(turned, uy_1, uy_2)), ref, vertex(0), vertex(1), out.shade[2]);
    StoreWords(vertex(2), hn::Set(di, static_cast<std::int32_t>(triangles.surface)), zero, back_lanes, out.shade[3]);
    if ((alive & ~small) != 0) {
      StorePixelEdge(e0, 0, out);
      StorePixelEdge(e1, 1, out);
      StorePixelEdge(e2, 2, out);
      hn::Store(x_max, di, out.x_max);
      hn::Store(y_max, di, out.y_max);
    }

    for (unsigned rest = alive; rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(rest));
      EmitLane(out, lane, (small >> lane & 1U) != 0, triangles.source[t + lane], binner);
    }
  }
}

}  // namespace sheaf::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sheaf::raster {
HWY_EXPORT(SetupTriangles);
void setupTriangles(const ScreenVertex* vertices, const PatchTriangles& triangles, Binner& binner,
                    SetupCounts& counts) {
  HWY_DYNAMIC_DISPATCH(SetupTriangles)(vertices, triangles, binner, counts);
}
}  // namespace sheaf::raster
#endif
