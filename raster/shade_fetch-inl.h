// raster/shade_fetch-inl: brings what a vector of pixels needs from its triangles into rows of lanes.
#include <algorithm>
#include <bit>

#include "raster/shade.h"
#include "raster/shade_math-inl.h"

#if defined(SHEAF_RASTER_SHADE_FETCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHEAF_RASTER_SHADE_FETCH_INL_H_
#undef SHEAF_RASTER_SHADE_FETCH_INL_H_
#else
#define SHEAF_RASTER_SHADE_FETCH_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace sheaf::raster::HWY_NAMESPACE {

// ShadeTriangle as sixteen 32-bit words; Records relies on their order.
inline constexpr int kWords = 16;
static_assert(sizeof(ShadeTriangle) == kWords * sizeof(std::uint32_t));
static_assert(offsetof(ShadeTriangle, ux) == 3 * 4 && offsetof(ShadeTriangle, uy) == 6 * 4);
static_assert(offsetof(ShadeTriangle, ref_x) == 9 * 4 && offsetof(ShadeTriangle, vertex) == 10 * 4);
static_assert(offsetof(ShadeTriangle, surface) == 13 * 4 && offsetof(ShadeTriangle, back_face) == 15 * 4);

/// What the triangles of a block's pixels say there, in the order of tileIndex(): a vector of pixels is a piece of
/// every row. In memory, so that each step over a block is a short loop whose turns overlap in the processor; in one
/// long loop the latencies of loads, decoding and lighting add up.
struct BlockFragments {
  alignas(64) float barycentric[3][kBlockPixels];  ///< perspective-correct
  alignas(64) std::int32_t vertex[3][kBlockPixels];
  alignas(64) std::uint32_t flip[kBlockPixels];  ///< sign bit set: the normal is turned round
  alignas(64) float normal[3][kBlockPixels];     ///< object space, any length
  // For surfaces with a pattern only: linear colour before light.
  alignas(64) float albedo[3][kBlockPixels];
  // For the same only: how the planes of ShadeTriangle rise along x and y, divided by their sum here.
  alignas(64) float along_x[3][kBlockPixels];
  alignas(64) float along_y[3][kBlockPixels];
  // Of each vector, at its first pixel: the lanes to shade now, and 1 if all of them show the same triangle.
  std::uint32_t lanes[kBlockPixels];
  std::uint32_t uniform[kBlockPixels];
};

/// The words of a ShadeTriangle in every lane, in their order.
struct Records {
  VU u00, u01, u02, ux0, ux1, ux2, uy0, uy1, uy2;  ///< bits of floats
  VU ref;                                          ///< x in the lower half, y in the upper one
  VU vertex0, vertex1, vertex2;
  VU surface, triangle, back_face;
};

HWY_INLINE std::uint64_t AllLanes() {
  return (std::uint64_t{1} << hn::Lanes(DF())) - 1;
}

#if HWY_TARGET == HWY_SCALAR || HWY_HAVE_SCALABLE

/// The record of each lane's triangle.
HWY_INLINE Records LoadRecords(const std::uint32_t* words, const std::uint32_t* ids) {
  const VI first = hn::BitCast(DI(), hn::ShiftLeft<4>(hn::Load(DU(), ids)));
  const auto word = [&](int i) HWY_ATTR { return Gather(words + i, first); };
  return {word(0), word(1), word(2),  word(3),  word(4),  word(5),  word(6),  word(7),
          word(8), word(9), word(10), word(11), word(12), word(13), word(14), word(15)};
}

HWY_INLINE void LoadNormals(const VertexNormal* normals, const std::int32_t* vertices, VF& x, VF& y, VF& z) {
  const VI first = hn::ShiftLeft<2>(hn::Load(DI(), vertices));
  const auto* words = reinterpret_cast<const float*>(normals);
  x = Gather(words, first);
  y = Gather(words + 1, first);
  z = Gather(words + 2, first);
}

#else

/// Quarters of the records ids[0], ids[4] and so on: one record to a 128-bit block. Records are read in as few loads as
/// there can be: pieces of different cache lines that lie at the same place in them are read one after the other.
HWY_INLINE void LoadQuarters(const std::uint32_t* words, const std::uint32_t* ids, VU& q0, VU& q1, VU& q2, VU& q3) {
  const DU du;
  const auto record = [&](std::size_t i) HWY_ATTR { return words + std::size_t{kWords} * ids[4 * i]; };
  if constexpr (hn::MaxLanes(DU()) == 16) {
    const VU r0 = hn::Load(du, record(0));
    const VU r1 = hn::Load(du, record(1));
    const VU r2 = hn::Load(du, record(2));
    const VU r3 = hn::Load(du, record(3));
    const VU r01_even = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(r1), r0);
    const VU r01_odd = hn::OddEvenBlocks(r1, hn::SwapAdjacentBlocks(r0));
    const VU r23_even = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(r3), r2);
    const VU r23_odd = hn::OddEvenBlocks(r3, hn::SwapAdjacentBlocks(r2));
    q0 = hn::ConcatLowerLower(du, r23_even, r01_even);
    q1 = hn::ConcatLowerLower(du, r23_odd, r01_odd);
    q2 = hn::ConcatUpperUpper(du, r23_even, r01_even);
    q3 = hn::ConcatUpperUpper(du, r23_odd, r01_odd);
  } else if constexpr (hn::MaxLanes(DU()) == 8) {
    const VU r0_lower = hn::Load(du, record(0));
    const VU r0_upper = hn::Load(du, record(0) + 8);
    const VU r1_lower = hn::Load(du, record(1));
    const VU r1_upper = hn::Load(du, record(1) + 8);
    q0 = hn::ConcatLowerLower(du, r1_lower, r0_lower);
    q1 = hn::ConcatUpperUpper(du, r1_lower, r0_lower);
    q2 = hn::ConcatLowerLower(du, r1_upper, r0_upper);
    q3 = hn::ConcatUpperUpper(du, r1_upper, r0_upper);
  } else {
    q0 = hn::Load(du, record(0));
    q1 = hn::Load(du, record(0) + 4);
    q2 = hn::Load(du, record(0) + 8);
    q3 = hn::Load(du, record(0) + 12);
  }
}

/// The record of each lane's triangle: loads of whole records and a transposition, which are faster than gathers that
/// read one word at a time.
HWY_INLINE Records LoadRecords(const std::uint32_t* words, const std::uint32_t* ids) {
  Records r;
  VU a0, a1, a2, a3, b0, b1, b2, b3, c0, c1, c2, c3, d0, d1, d2, d3;
  LoadQuarters(words, ids, a0, b0, c0, d0);
  LoadQuarters(words, ids + 1, a1, b1, c1, d1);
  LoadQuarters(words, ids + 2, a2, b2, c2, d2);
  LoadQuarters(words, ids + 3, a3, b3, c3, d3);
  TransposeBlocks(a0, a1, a2, a3, r.u00, r.u01, r.u02, r.ux0);
  TransposeBlocks(b0, b1, b2, b3, r.ux1, r.ux2, r.uy0, r.uy1);
  TransposeBlocks(c0, c1, c2, c3, r.uy2, r.ref, r.vertex0, r.vertex1);
  TransposeBlocks(d0, d1, d2, d3, r.vertex2, r.surface, r.triangle, r.back_face);
  return r;
}

/// The normals of vertices[0], vertices[4] and so on, one in each 128-bit block.
template <class D>
HWY_INLINE hn::Vec<D> LoadNormalBlocks(D d, const VertexNormal* normals, const std::int32_t* vertices) {
  if constexpr (hn::MaxLanes(D()) == 4) {
    return hn::Load(d, reinterpret_cast<const std::uint32_t*>(normals + vertices[0]));
  } else {
    const hn::Half<D> half;
    return hn::Combine(d, LoadNormalBlocks(half, normals, vertices + hn::MaxLanes(half)),
                       LoadNormalBlocks(half, normals, vertices));
  }
}

HWY_INLINE void LoadNormals(const VertexNormal* normals, const std::int32_t* vertices, VF& x, VF& y, VF& z) {
  const DU du;
  VU row_x, row_y, row_z, unused;
  TransposeBlocks(LoadNormalBlocks(du, normals, vertices), LoadNormalBlocks(du, normals, vertices + 1),
                  LoadNormalBlocks(du, normals, vertices + 2), LoadNormalBlocks(du, normals, vertices + 3), row_x,
                  row_y, row_z, unused);
  x = hn::BitCast(DF(), row_x);
  y = hn::BitCast(DF(), row_y);
  z = hn::BitCast(DF(), row_z);
}

#endif

/// One record for all lanes.
HWY_INLINE Records BroadcastRecord(const std::uint32_t* record) {
  const auto word = [&](int i) HWY_ATTR { return hn::Set(DU(), record[i]); };
  return {word(0), word(1), word(2),  word(3),  word(4),  word(5),  word(6),  word(7),
          word(8), word(9), word(10), word(11), word(12), word(13), word(14), word(15)};
}

/// Evaluates the triangles at one vector of pixels; returns the lanes that are of the surface.
template <bool kUniform, bool kPatterned>
HWY_INLINE MF FetchVector(const ShadeTriangle* triangles, const std::uint32_t* ids, std::uint32_t surface_id, VI x,
                          VI y, std::size_t begin, BlockFragments& out) {
  const DF d;
  const DI di;
  const DU du;
  const auto* words = reinterpret_cast<const std::uint32_t*>(triangles);
  const Records r = kUniform ? BroadcastRecord(words + std::size_t{kWords} * ids[0]) : LoadRecords(words, ids);

  const VI ref_xy = hn::BitCast(di, r.ref);
  const VF dx = hn::ConvertTo(d, hn::Sub(x, hn::ShiftRight<16>(hn::ShiftLeft<16>(ref_xy))));
  const VF dy = hn::ConvertTo(d, hn::Sub(y, hn::ShiftRight<16>(ref_xy)));
  const auto plane = [&](VU at_ref, VU along_x, VU along_y) HWY_ATTR {
    const VF moved_x = hn::Mul(hn::BitCast(DF(), along_x), dx);
    const VF moved_y = hn::Mul(hn::BitCast(DF(), along_y), dy);
    return hn::Add(hn::Add(hn::BitCast(DF(), at_ref), moved_x), moved_y);
  };
  const VF u0 = plane(r.u00, r.ux0, r.uy0);
  const VF u1 = plane(r.u01, r.ux1, r.uy1);
  const VF u2 = plane(r.u02, r.ux2, r.uy2);
  const VF inverse_sum = hn::Div(Constant(1.0F), hn::Add(hn::Add(u0, u1), u2));
  hn::Store(hn::Mul(u0, inverse_sum), d, out.barycentric[0] + begin);
  hn::Store(hn::Mul(u1, inverse_sum), d, out.barycentric[1] + begin);
  hn::Store(hn::Mul(u2, inverse_sum), d, out.barycentric[2] + begin);
  hn::Store(hn::BitCast(di, r.vertex0), di, out.vertex[0] + begin);
  hn::Store(hn::BitCast(di, r.vertex1), di, out.vertex[1] + begin);
  hn::Store(hn::BitCast(di, r.vertex2), di, out.vertex[2] + begin);
  hn::Store(hn::ShiftLeft<31>(r.back_face), du, out.flip + begin);
  if constexpr (kPatterned) {
    hn::Store(hn::Mul(hn::BitCast(d, r.ux0), inverse_sum), d, out.along_x[0] + begin);
    hn::Store(hn::Mul(hn::BitCast(d, r.ux1), inverse_sum), d, out.along_x[1] + begin);
    hn::Store(hn::Mul(hn::BitCast(d, r.ux2), inverse_sum), d, out.along_x[2] + begin);
    hn::Store(hn::Mul(hn::BitCast(d, r.uy0), inverse_sum), d, out.along_y[0] + begin);
    hn::Store(hn::Mul(hn::BitCast(d, r.uy1), inverse_sum), d, out.along_y[1] + begin);
    hn::Store(hn::Mul(hn::BitCast(d, r.uy2), inverse_sum), d, out.along_y[2] + begin);
  }
  return hn::RebindMask(d, hn::Eq(r.surface, hn::Set(du, surface_id)));
}

/// Lets the lanes outside `mine`, which belong to another surface's arrays, read the vertices of a lane within.
HWY_INLINE void HideOtherVertices(std::uint64_t mine, std::size_t begin, BlockFragments& out) {
  const DI di;
  const auto mask = hn::RebindMask(di, MaskOfBits(mine));
  for (auto& row : out.vertex) {
    std::int32_t* vertex = row + begin;
    const VI shared = hn::Set(di, vertex[std::countr_zero(mine)]);
    hn::Store(hn::IfThenElse(mask, hn::Load(di, vertex), shared), di, vertex);
  }
}

/// Evaluates the triangles at those pending pixels that show the surface, and returns these pixels. (x0, y0) is the
/// block's top left pixel, ids are its kBlockPixels triangles.
template <bool kPatterned>
HWY_INLINE std::uint64_t FetchFragments(const ShadeTriangle* triangles, const std::uint32_t* ids,
                                        std::uint32_t surface_id, std::uint64_t pending, std::int32_t x0,
                                        std::int32_t y0, BlockFragments& out) {
  const DI di;
  const DU du;
  constexpr std::int32_t kRowMask = kBlockSize - 1;
  const VI lane = hn::Iota(di, 0);
  const VI lane_x = hn::Add(hn::And(lane, hn::Set(di, kRowMask)), hn::Set(di, x0));
  const VI lane_y = hn::Add(hn::ShiftRight<3>(lane), hn::Set(di, y0));
  std::uint64_t all_mine = 0;
  for (std::size_t begin = 0; begin < kBlockPixels; begin += hn::Lanes(du)) {
    out.lanes[begin] = 0;
    const std::uint64_t bits = pending >> begin & AllLanes();
    if (bits == 0) continue;
    // Lanes without a pixel of their own follow the first that has one.
    const std::uint32_t first_id = ids[begin + static_cast<std::size_t>(std::countr_zero(bits))];
    const VU first = hn::Set(du, first_id);
    const VU id = hn::IfThenElse(hn::RebindMask(du, MaskOfBits(bits)), hn::Load(du, ids + begin), first);
    alignas(64) std::uint32_t lane_ids[kMaxLanes];
    hn::Store(id, du, lane_ids);
    const bool uniform = hn::AllTrue(du, hn::Eq(id, first));
    out.uniform[begin] = uniform ? 1 : 0;
    const VI x = hn::Add(lane_x, hn::Set(di, static_cast<std::int32_t>(begin) & kRowMask));
    const VI y = hn::Add(lane_y, hn::Set(di, static_cast<std::int32_t>(begin) / kBlockSize));
    const MF of_surface = uniform ? FetchVector<true, kPatterned>(triangles, lane_ids, surface_id, x, y, begin, out)
                                  : FetchVector<false, kPatterned>(triangles, lane_ids, surface_id, x, y, begin, out);
    const std::uint64_t mine = bits & BitsOfMask(of_surface);
    out.lanes[begin] = static_cast<std::uint32_t>(mine);
    all_mine |= mine << begin;
    if (mine != 0 && mine != bits) HideOtherVertices(mine, begin, out);
  }
  return all_mine;
}

/// Object-space normals of all vectors, interpolated between the corners'.
HWY_INLINE void FetchSmoothNormals(const VertexNormal* normals, BlockFragments& fragments) {
  const DF d;
  for (std::size_t begin = 0; begin < kBlockPixels; begin += hn::Lanes(d)) {
    if (fragments.lanes[begin] == 0) continue;
    const bool uniform = fragments.uniform[begin] != 0;
    VF nx = hn::Zero(d);
    VF ny = hn::Zero(d);
    VF nz = hn::Zero(d);
    for (int corner = 0; corner < 3; ++corner) {
      const std::int32_t* vertices = fragments.vertex[corner] + begin;
      VF x, y, z;
      if (uniform) {
        const VertexNormal& normal = normals[vertices[0]];
        x = Constant(normal.x);
        y = Constant(normal.y);
        z = Constant(normal.z);
      } else {
        LoadNormals(normals, vertices, x, y, z);
      }
      const VF weight = hn::Load(d, fragments.barycentric[corner] + begin);
      nx = corner == 0 ? hn::Mul(weight, x) : hn::Add(nx, hn::Mul(weight, x));
      ny = corner == 0 ? hn::Mul(weight, y) : hn::Add(ny, hn::Mul(weight, y));
      nz = corner == 0 ? hn::Mul(weight, z) : hn::Add(nz, hn::Mul(weight, z));
    }
    hn::Store(nx, d, fragments.normal[0] + begin);
    hn::Store(ny, d, fragments.normal[1] + begin);
    hn::Store(nz, d, fragments.normal[2] + begin);
  }
}

/// The triangles' own object-space normals.
HWY_INLINE void FetchFlatNormals(const std::array<const float*, 3>& position, BlockFragments& fragments) {
  const DF d;
  for (std::size_t begin = 0; begin < kBlockPixels; begin += hn::Lanes(d)) {
    if (fragments.lanes[begin] == 0) continue;
    const VI v0 = hn::Load(DI(), fragments.vertex[0] + begin);
    const VI v1 = hn::Load(DI(), fragments.vertex[1] + begin);
    const VI v2 = hn::Load(DI(), fragments.vertex[2] + begin);
    const VF x0 = Gather(position[0], v0);
    const VF y0 = Gather(position[1], v0);
    const VF z0 = Gather(position[2], v0);
    const VF ax = hn::Sub(Gather(position[0], v1), x0);
    const VF ay = hn::Sub(Gather(position[1], v1), y0);
    const VF az = hn::Sub(Gather(position[2], v1), z0);
    const VF bx = hn::Sub(Gather(position[0], v2), x0);
    const VF by = hn::Sub(Gather(position[1], v2), y0);
    const VF bz = hn::Sub(Gather(position[2], v2), z0);
    hn::Store(hn::Sub(hn::Mul(ay, bz), hn::Mul(az, by)), d, fragments.normal[0] + begin);
    hn::Store(hn::Sub(hn::Mul(az, bx), hn::Mul(ax, bz)), d, fragments.normal[1] + begin);
    hn::Store(hn::Sub(hn::Mul(ax, by), hn::Mul(ay, bx)), d, fragments.normal[2] + begin);
  }
}

}  // namespace sheaf::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
