// raster/shade_fetch-inl: brings what a vector of pixels needs from its triangles into rows of lanes.
#include <algorithm>
#include <bit>

#include "raster/shade.h"
#include "raster/shade_normal-inl.h"

#if defined(SHEAF_RASTER_SHADE_FETCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHEAF_RASTER_SHADE_FETCH_INL_H_
#undef SHEAF_RASTER_SHADE_FETCH_INL_H_
#else
#define SHEAF_RASTER_SHADE_FETCH_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace sheaf::raster::HWY_NAMESPACE {

// ShadeTriangle as sixteen 32-bit words.
enum Word : int { kU0 = 0, kUx = 3, kUy = 6, kRef = 9, kVertex = 10, kSurface = 13, kTriangle = 14, kBackFace = 15 };
inline constexpr int kWords = 16;
static_assert(sizeof(ShadeTriangle) == kWords * sizeof(std::uint32_t));
static_assert(offsetof(ShadeTriangle, ux) == kUx * 4 && offsetof(ShadeTriangle, uy) == kUy * 4);
static_assert(offsetof(ShadeTriangle, ref_x) == kRef * 4 && offsetof(ShadeTriangle, vertex) == kVertex * 4);
static_assert(offsetof(ShadeTriangle, surface) == kSurface * 4 && offsetof(ShadeTriangle, back_face) == kBackFace * 4);

/// The triangles of a block's pixels, one per column in the order of tileIndex(). A vector of pixels is a piece of
/// every row. In memory, so that each step over a block is a short loop whose turns overlap in the processor: in one
/// long loop the latencies of loads, decoding and lighting add up.
struct BlockTriangles {
  alignas(64) std::uint32_t word[kWords][kBlockPixels];
  alignas(64) float normal[9][kBlockPixels];  ///< x, y, z of corner 0, 1, 2: unit, object space
  /// At the first pixel of each vector: the one triangle that all its lanes show, or kNoTriangle.
  std::uint32_t uniform[kBlockPixels];
  /// At the first pixel of each vector: lanes to shade now, and whether their triangles are there already.
  std::uint32_t lanes[kBlockPixels];
  bool is_kept[kBlockPixels];

  void forget() { std::fill_n(uniform, kBlockPixels, kNoTriangle); }
};

/// A vector of a block's triangles.
struct TriangleLanes {
  const BlockTriangles& block;
  std::size_t begin;

  VU words(int index) const { return hn::Load(DU(), block.word[index] + begin); }
  VF floats(int index) const { return hn::BitCast(DF(), words(index)); }
  VI vertices(int corner) const { return hn::BitCast(DI(), words(kVertex + corner)); }
  VF normals(int corner, int axis) const { return hn::Load(DF(), block.normal[3 * corner + axis] + begin); }
};

#if HWY_TARGET == HWY_SCALAR || HWY_HAVE_SCALABLE

HWY_INLINE void FetchRecords(const ShadeTriangle* triangles, VU ids, BlockTriangles& block, std::size_t begin) {
  const DI di;
  const auto* base = reinterpret_cast<const std::int32_t*>(triangles);
  const VI first_word = hn::BitCast(di, hn::ShiftLeft<4>(ids));
  for (int w = 0; w < kWords; ++w)
    hn::Store(hn::BitCast(DU(), hn::GatherIndex(di, base + w, first_word)), DU(), block.word[w] + begin);
}

#else

/// Four words at words[16 * ids[0]], four at words[16 * ids[4]], and so on.
template <class D>
HWY_INLINE hn::Vec<D> LoadQuads(D d, const std::uint32_t* words, const std::uint32_t* ids) {
  if constexpr (hn::MaxLanes(D()) == 4) {
    return hn::Load(d, words + std::size_t{kWords} * ids[0]);
  } else {
    const hn::Half<D> half;
    return hn::Combine(d, LoadQuads(half, words, ids + hn::MaxLanes(half)), LoadQuads(half, words, ids));
  }
}

/// A record is one cache line, so that its four quarters are loaded whole and transposed; gathers, one per word and
/// lane, take about three times as long.
HWY_INLINE void FetchRecords(const ShadeTriangle* triangles, VU ids, BlockTriangles& block, std::size_t begin) {
  const DU d;
  const hn::Repartition<std::uint64_t, DU> d64;
  alignas(64) std::uint32_t id[kMaxLanes];
  hn::Store(ids, d, id);
  const auto* words = reinterpret_cast<const std::uint32_t*>(triangles);
  for (int w = 0; w < kWords; w += 4) {
    const VU row0 = LoadQuads(d, words + w, id);
    const VU row1 = LoadQuads(d, words + w, id + 1);
    const VU row2 = LoadQuads(d, words + w, id + 2);
    const VU row3 = LoadQuads(d, words + w, id + 3);
    const auto lower01 = hn::BitCast(d64, hn::InterleaveLower(d, row0, row1));
    const auto upper01 = hn::BitCast(d64, hn::InterleaveUpper(d, row0, row1));
    const auto lower23 = hn::BitCast(d64, hn::InterleaveLower(d, row2, row3));
    const auto upper23 = hn::BitCast(d64, hn::InterleaveUpper(d, row2, row3));
    hn::Store(hn::BitCast(d, hn::InterleaveLower(d64, lower01, lower23)), d, block.word[w] + begin);
    hn::Store(hn::BitCast(d, hn::InterleaveUpper(d64, lower01, lower23)), d, block.word[w + 1] + begin);
    hn::Store(hn::BitCast(d, hn::InterleaveLower(d64, upper01, upper23)), d, block.word[w + 2] + begin);
    hn::Store(hn::BitCast(d, hn::InterleaveUpper(d64, upper01, upper23)), d, block.word[w + 3] + begin);
  }
}

#endif

HWY_INLINE void FetchOneRecord(const ShadeTriangle& triangle, BlockTriangles& block, std::size_t begin) {
  std::uint32_t words[kWords];
  std::memcpy(words, &triangle, sizeof words);
  for (int w = 0; w < kWords; ++w) hn::Store(hn::Set(DU(), words[w]), DU(), block.word[w] + begin);
}

/// Lets the lanes outside `mine_bits`, which belong to another surface's arrays, read the vertices of a lane within.
HWY_INLINE void HideOtherVertices(std::uint64_t mine_bits, BlockTriangles& block, std::size_t begin) {
  const DU du;
  const auto mine = hn::RebindMask(du, MaskOfBits(mine_bits));
  for (int corner = 0; corner < 3; ++corner) {
    std::uint32_t* vertex = block.word[kVertex + corner] + begin;
    const VU shared = hn::Set(du, vertex[std::countr_zero(mine_bits)]);
    hn::Store(hn::IfThenElse(mine, hn::Load(du, vertex), shared), du, vertex);
  }
}

/// Fetches the triangles of those pending pixels that show the surface; returns the pixels.
HWY_INLINE std::uint64_t FetchTriangles(const ShadeTriangle* triangles, const std::uint32_t* ids,
                                        std::uint32_t surface_id, std::uint64_t pending, BlockTriangles& block) {
  const DU du;
  const std::uint64_t lane_mask = (std::uint64_t{1} << hn::Lanes(du)) - 1;
  std::uint64_t all_mine = 0;
  for (std::size_t begin = 0; begin < kBlockPixels; begin += hn::Lanes(du)) {
    block.lanes[begin] = 0;
    const std::uint64_t bits = pending >> begin & lane_mask;
    if (bits == 0) continue;
    // Lanes without a pixel of their own follow the first that has one.
    const std::uint32_t first_id = ids[begin + static_cast<std::size_t>(std::countr_zero(bits))];
    const VU first = hn::Set(du, first_id);
    const VU id = hn::IfThenElse(hn::RebindMask(du, MaskOfBits(bits)), hn::Load(du, ids + begin), first);
    const bool uniform = hn::AllTrue(du, hn::Eq(id, first));
    block.is_kept[begin] = uniform && block.uniform[begin] == first_id;
    if (!block.is_kept[begin]) {
      if (uniform)
        FetchOneRecord(triangles[first_id], block, begin);
      else
        FetchRecords(triangles, id, block, begin);
      block.uniform[begin] = uniform ? first_id : kNoTriangle;
    }
    const auto of_surface = hn::Eq(hn::Load(du, block.word[kSurface] + begin), hn::Set(du, surface_id));
    const std::uint64_t mine = bits & BitsOfMask(hn::RebindMask(DF(), of_surface));
    if (mine != bits) block.uniform[begin] = kNoTriangle;
    if (mine == 0) continue;
    if (mine != bits) HideOtherVertices(mine, block, begin);
    block.lanes[begin] = static_cast<std::uint32_t>(mine);
    all_mine |= mine << begin;
  }
  return all_mine;
}

HWY_INLINE void FetchNormals(const std::uint32_t* normals, BlockTriangles& block) {
  const DF d;
  for (std::size_t begin = 0; begin < kBlockPixels; begin += hn::Lanes(d)) {
    if (block.lanes[begin] == 0 || block.is_kept[begin]) continue;
    for (int corner = 0; corner < 3; ++corner) {
      const VI vertex = TriangleLanes{block, begin}.vertices(corner);
      const VI packed = hn::GatherIndex(DI(), reinterpret_cast<const std::int32_t*>(normals), vertex);
      VF x, y, z;
      UnpackNormals(hn::BitCast(DU(), packed), x, y, z);
      hn::Store(x, d, block.normal[3 * corner] + begin);
      hn::Store(y, d, block.normal[3 * corner + 1] + begin);
      hn::Store(z, d, block.normal[3 * corner + 2] + begin);
    }
  }
}

}  // namespace sheaf::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
