#include "pipeline/cull.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/cull_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sheaf::pipeline::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

const hn::CappedTag<float, 16> df;
using VF = hn::Vec<decltype(df)>;

unsigned MaskBits(hn::Mask<decltype(df)> mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(df, mask, bits);
  return bits[0] | static_cast<unsigned>(bits[1]) << 8;
}

// A lane per plane.
void CodeRuns(const grouping::VertexRun* runs, std::size_t count, const RunPlanes& planes, RunCodes* out) {
  const auto lanes = hn::Lanes(df);
  constexpr unsigned kPlanes = (1U << RunPlanes::kCount) - 1;
  constexpr unsigned kWBit = 1U << (RunPlanes::kCount - 1);
  for (std::size_t r = 0; r < count; ++r) {
    const grouping::VertexRun& run = runs[r];
    unsigned must = 0;
    unsigned may = 0;
    for (std::size_t i = 0; i < RunPlanes::kCount; i += lanes) {
      const VF constant = hn::Load(df, planes.coefficient[3] + i);
      VF lo = constant, hi = constant, at_lo = constant, at_hi = constant;
      VF magnitude = hn::Abs(constant);
      for (int k = 0; k < 3; ++k) {
        const VF coefficient = hn::Load(df, planes.coefficient[k] + i);
        const VF a = hn::Mul(coefficient, hn::Set(df, run.corner_lo[k]));
        const VF b = hn::Mul(coefficient, hn::Set(df, run.corner_hi[k]));
        lo = hn::Add(lo, hn::Min(a, b));
        hi = hn::Add(hi, hn::Max(a, b));
        at_lo = hn::Add(at_lo, a);
        at_hi = hn::Add(at_hi, b);
        magnitude = hn::Add(magnitude, hn::Max(hn::Abs(a), hn::Abs(b)));
      }
      if (run.kind == grouping::RunKind::kLine) {
        lo = hn::Min(at_lo, at_hi);
        hi = hn::Max(at_lo, at_hi);
      }
      const VF slack = hn::Mul(hn::Set(df, kCodeSlack), magnitude);
      must |= MaskBits(hn::Lt(hi, hn::Neg(slack))) << i;
      may |= MaskBits(hn::Le(lo, slack)) << i;
    }
    const auto code = [&](unsigned bits) {
      bits &= kPlanes;
      if ((bits & kWBit) != 0) bits |= kOutNear;
      return static_cast<std::int32_t>(bits & ~kWBit);
    };
    out[r] = {code(must), code(may)};
  }
}

}  // namespace sheaf::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sheaf::pipeline {
HWY_EXPORT(CodeRuns);

void codeRuns(std::span<const grouping::VertexRun> runs, const RunPlanes& planes, RunCodes* out) {
  HWY_DYNAMIC_DISPATCH(CodeRuns)(runs.data(), runs.size(), planes, out);
}
}  // namespace sheaf::pipeline
#endif
