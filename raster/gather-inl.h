// raster/gather-inl: gathers of 32-bit words that do not wait for what is not theirs, and the transposition that takes
// their place where whole records can be loaded. Compiled per SIMD target.
#if defined(SHEAF_RASTER_GATHER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHEAF_RASTER_GATHER_INL_H_
#undef SHEAF_RASTER_GATHER_INL_H_
#else
#define SHEAF_RASTER_GATHER_INL_H_
#endif

#include <hwy/highway.h>

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace sheaf::raster::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using VF = hn::Vec<hn::CappedTag<float, 16>>;
using VI = hn::Vec<hn::CappedTag<std::int32_t, 16>>;

// base[index], as hn::GatherIndex. The gather instructions of x86 leave masked-off lanes of the destination as they
// were. GCC sees that the mask of a plain gather is full and gives it any register to write to; the processor does not,
// and waits for what that register held before, often the end of a long chain. Here the destination is zero and the
// mask opaque to the compiler: frames of small triangles shade a fifth faster.
#if HWY_COMPILER_GCC_ACTUAL && (HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL)

HWY_INLINE __mmask16 OpaqueFullMask() {
  __mmask16 full = 0xFFFF;
  asm("" : "+Yk"(full));
  return full;
}

HWY_INLINE VI Gather(const std::int32_t* base, VI index) {
  return VI{_mm512_mask_i32gather_epi32(_mm512_setzero_si512(), OpaqueFullMask(), index.raw, base, 4)};
}

HWY_INLINE VF Gather(const float* base, VI index) {
  return VF{_mm512_mask_i32gather_ps(_mm512_setzero_ps(), OpaqueFullMask(), index.raw, base, 4)};
}

#elif HWY_COMPILER_GCC_ACTUAL && HWY_TARGET == HWY_AVX2

HWY_INLINE __m256i OpaqueFullMask() {
  __m256i full = _mm256_set1_epi32(-1);
  asm("" : "+x"(full));
  return full;
}

HWY_INLINE VI Gather(const std::int32_t* base, VI index) {
  return VI{_mm256_mask_i32gather_epi32(_mm256_setzero_si256(), base, index.raw, OpaqueFullMask(), 4)};
}

HWY_INLINE VF Gather(const float* base, VI index) {
  const __m256 mask = _mm256_castsi256_ps(OpaqueFullMask());
  return VF{_mm256_mask_i32gather_ps(_mm256_setzero_ps(), base, index.raw, mask, 4)};
}

#else

HWY_INLINE VI Gather(const std::int32_t* base, VI index) {
  return hn::GatherIndex(hn::DFromV<VI>(), base, index);
}

HWY_INLINE VF Gather(const float* base, VI index) {
  return hn::GatherIndex(hn::DFromV<VF>(), base, index);
}

#endif

#if HWY_TARGET != HWY_SCALAR && !HWY_HAVE_SCALABLE

// Rows of four 32-bit words to columns, in each 128-bit block.
template <class V>
HWY_INLINE void TransposeBlocks(V row0, V row1, V row2, V row3, V& a, V& b, V& c, V& d) {
  const hn::DFromV<V> d32;
  const hn::Repartition<std::uint64_t, hn::DFromV<V>> d64;
  const auto lower01 = hn::BitCast(d64, hn::InterleaveLower(d32, row0, row1));
  const auto upper01 = hn::BitCast(d64, hn::InterleaveUpper(d32, row0, row1));
  const auto lower23 = hn::BitCast(d64, hn::InterleaveLower(d32, row2, row3));
  const auto upper23 = hn::BitCast(d64, hn::InterleaveUpper(d32, row2, row3));
  a = hn::BitCast(d32, hn::InterleaveLower(d64, lower01, lower23));
  b = hn::BitCast(d32, hn::InterleaveUpper(d64, lower01, lower23));
  c = hn::BitCast(d32, hn::InterleaveLower(d64, upper01, upper23));
  d = hn::BitCast(d32, hn::InterleaveUpper(d64, upper01, upper23));
}

#endif

}  // namespace sheaf::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
