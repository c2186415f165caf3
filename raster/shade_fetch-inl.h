// raster/shade_fetch-inl: brings what a vector of pixels needs from its triangles into rows of lanes.
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

/// One lane's triangle per column; in memory, so that kernels take as operands what they need of it.
struct TriangleLanes {
  alignas(64) std::uint32_t word[kWords][kMaxLanes];
  alignas(64) float normal[9][kMaxLanes];  ///< x, y, z of corner 0, 1, 2: unit, object space
  /// All lanes show this triangle, or kNoTriangle.
  std::uint32_t uniform = kNoTriangle;

  VF floats(int index) const { return hn::BitCast(DF(), words(index)); }
  VU words(int index) const { return hn::Load(DU(), word[index]); }
};

#if HWY_TARGET == HWY_SCALAR || HWY_HAVE_SCALABLE

HWY_INLINE void FetchRecords(const ShadeTriangle* triangles, VU ids, TriangleLanes& lanes) {
  const DI di;
  const auto* base = reinterpret_cast<const std::int32_t*>(triangles);
  const VI first_word = hn::BitCast(di, hn::ShiftLeft<4>(ids));
  for (int w = 0; w < kWords; ++w)
    hn::Store(hn::BitCast(DU(), hn::GatherIndex(di, base + w, first_word)), DU(), lanes.word[w]);
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
HWY_INLINE void FetchRecords(const ShadeTriangle* triangles, VU ids, TriangleLanes& lanes) {
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
    hn::Store(hn::BitCast(d, hn::InterleaveLower(d64, lower01, lower23)), d, lanes.word[w]);
    hn::Store(hn::BitCast(d, hn::InterleaveUpper(d64, lower01, lower23)), d, lanes.word[w + 1]);
    hn::Store(hn::BitCast(d, hn::InterleaveLower(d64, upper01, upper23)), d, lanes.word[w + 2]);
    hn::Store(hn::BitCast(d, hn::InterleaveUpper(d64, upper01, upper23)), d, lanes.word[w + 3]);
  }
}

#endif

HWY_INLINE void FetchOneRecord(const ShadeTriangle& triangle, TriangleLanes& lanes) {
  std::uint32_t words[kWords];
  std::memcpy(words, &triangle, sizeof words);
  for (int w = 0; w < kWords; ++w) hn::Store(hn::Set(DU(), words[w]), DU(), lanes.word[w]);
}

/// Lets the lanes outside `mine_bits`, which belong to another surface's arrays, read the vertices of a lane within.
HWY_INLINE void HideOtherVertices(TriangleLanes& lanes, std::uint64_t mine_bits) {
  const DU du;
  const auto mine = hn::RebindMask(du, MaskOfBits(mine_bits));
  for (int corner = 0; corner < 3; ++corner) {
    std::uint32_t* vertex = lanes.word[kVertex + corner];
    const VU shared = hn::Set(du, vertex[std::countr_zero(mine_bits)]);
    hn::Store(hn::IfThenElse(mine, hn::Load(du, vertex), shared), du, vertex);
  }
}

HWY_INLINE void FetchNormals(const std::uint32_t* normals, TriangleLanes& lanes) {
  const DF d;
  const DI di;
  for (int corner = 0; corner < 3; ++corner) {
    const VI vertex = hn::BitCast(di, lanes.words(kVertex + corner));
    const VI packed = hn::GatherIndex(di, reinterpret_cast<const std::int32_t*>(normals), vertex);
    VF x, y, z;
    UnpackNormals(hn::BitCast(DU(), packed), x, y, z);
    hn::Store(x, d, lanes.normal[3 * corner]);
    hn::Store(y, d, lanes.normal[3 * corner + 1]);
    hn::Store(z, d, lanes.normal[3 * corner + 2]);
  }
}

}  // namespace sheaf::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
