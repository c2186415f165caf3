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

// A lane per box, as isOutside() and crosses() have it.
BoxBits ClassifyBoxes(const grouping::BoxBlock& boxes, const InstanceView& view) {
  const auto lanes = hn::Lanes(df);
  BoxBits bits;
  for (std::size_t i = 0; i < grouping::kTreeFanOut; i += lanes) {
    const VF lo_x = hn::Load(df, boxes.lo[0] + i), hi_x = hn::Load(df, boxes.hi[0] + i);
    const VF lo_y = hn::Load(df, boxes.lo[1] + i), hi_y = hn::Load(df, boxes.hi[1] + i);
    const VF lo_z = hn::Load(df, boxes.lo[2] + i), hi_z = hn::Load(df, boxes.hi[2] + i);
    const VF far_x = hn::Max(hn::Abs(lo_x), hn::Abs(hi_x));
    const VF far_y = hn::Max(hn::Abs(lo_y), hn::Abs(hi_y));
    const VF far_z = hn::Max(hn::Abs(lo_z), hn::Abs(hi_z));
    // Adds the lanes that are wholly beyond the plane, and those that are not wholly on its inner side.
    const auto test = [&](const Vec4& plane, unsigned& beyond, unsigned& not_within) {
      const VF x = hn::Set(df, plane.x), y = hn::Set(df, plane.y), z = hn::Set(df, plane.z), w = hn::Set(df, plane.w);
      const VF ax = hn::Mul(x, lo_x), bx = hn::Mul(x, hi_x);
      const VF ay = hn::Mul(y, lo_y), by = hn::Mul(y, hi_y);
      const VF az = hn::Mul(z, lo_z), bz = hn::Mul(z, hi_z);
      const VF least = hn::Add(hn::Add(hn::Add(w, hn::Min(ax, bx)), hn::Min(ay, by)), hn::Min(az, bz));
      const VF most = hn::Add(hn::Add(hn::Add(w, hn::Max(ax, bx)), hn::Max(ay, by)), hn::Max(az, bz));
      VF magnitude = hn::Add(hn::Abs(w), hn::Mul(hn::Abs(x), far_x));
      magnitude = hn::Add(magnitude, hn::Mul(hn::Abs(y), far_y));
      magnitude = hn::Add(magnitude, hn::Mul(hn::Abs(z), far_z));
      const VF slack = hn::Mul(hn::Set(df, kCodeSlack), magnitude);
      beyond |= MaskBits(hn::Lt(most, hn::Neg(slack)));
      not_within |= MaskBits(hn::Lt(least, slack));
    };
    unsigned outside = 0, clips = 0, crosses = 0, none = 0;
    for (std::size_t side = 0; side < 4; ++side) test(view.view_planes[side], outside, crosses);
    for (std::size_t depth = 4; depth < 6; ++depth) test(view.view_planes[depth], outside, clips);
    if (outside != (1U << lanes) - 1)
      for (const Vec4& plane : view.guard_planes) test(plane, none, clips);
    bits.outside |= outside << i;
    bits.clips |= clips << i;
    bits.crosses |= crosses << i;
  }
  return bits;
}

VF Dot(VF ax, VF ay, VF az, VF bx, VF by, VF bz) {
  return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
}

// A lane per patch, as isBackFacing() has it.
std::uint32_t FindBackFacing(const grouping::BoxBlock& boxes, const grouping::ConeBlock& cones,
                             const InstanceView& view) {
  const auto lanes = hn::Lanes(df);
  const Vec4& eye = view.eye_object;
  const VF half = hn::Set(df, 0.5F);
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < grouping::kTreeFanOut; i += lanes) {
    VF from_x = hn::Set(df, -eye.x), from_y = hn::Set(df, -eye.y), from_z = hn::Set(df, -eye.z);
    VF radius = hn::Zero(df);
    if (eye.w != 0.0F) {
      const VF lo_x = hn::Load(df, boxes.lo[0] + i), size_x = hn::Sub(hn::Load(df, boxes.hi[0] + i), lo_x);
      const VF lo_y = hn::Load(df, boxes.lo[1] + i), size_y = hn::Sub(hn::Load(df, boxes.hi[1] + i), lo_y);
      const VF lo_z = hn::Load(df, boxes.lo[2] + i), size_z = hn::Sub(hn::Load(df, boxes.hi[2] + i), lo_z);
      from_x = hn::Sub(hn::Add(lo_x, hn::Mul(half, size_x)), hn::Set(df, eye.x));
      from_y = hn::Sub(hn::Add(lo_y, hn::Mul(half, size_y)), hn::Set(df, eye.y));
      from_z = hn::Sub(hn::Add(lo_z, hn::Mul(half, size_z)), hn::Set(df, eye.z));
      radius = hn::Mul(half, hn::Sqrt(Dot(size_x, size_y, size_z, size_x, size_y, size_z)));
    }
    const VF sine = hn::Load(df, cones.sin_angle + i);
    const VF along = Dot(from_x, from_y, from_z, hn::Load(df, cones.axis[0] + i), hn::Load(df, cones.axis[1] + i),
                         hn::Load(df, cones.axis[2] + i));
    const VF distance = hn::Sqrt(Dot(from_x, from_y, from_z, from_x, from_y, from_z));
    const auto facing_away = hn::Ge(along, hn::Add(hn::Mul(sine, distance), radius));
    const auto has_cone = hn::Lt(sine, hn::Set(df, 1.0F));
    bits |= MaskBits(hn::And(facing_away, has_cone)) << i;
  }
  return bits;
}

}  // namespace sheaf::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sheaf::pipeline {
HWY_EXPORT(CodeRuns);
HWY_EXPORT(ClassifyBoxes);
HWY_EXPORT(FindBackFacing);

void codeRuns(std::span<const grouping::VertexRun> runs, const RunPlanes& planes, RunCodes* out) {
  HWY_DYNAMIC_DISPATCH(CodeRuns)(runs.data(), runs.size(), planes, out);
}

BoxBits classifyBoxes(const grouping::BoxBlock& boxes, const InstanceView& view) {
  return HWY_DYNAMIC_DISPATCH(ClassifyBoxes)(boxes, view);
}

std::uint32_t findBackFacing(const grouping::BoxBlock& boxes, const grouping::ConeBlock& cones,
                             const InstanceView& view) {
  return HWY_DYNAMIC_DISPATCH(FindBackFacing)(boxes, cones, view);
}
}  // namespace sheaf::pipeline
#endif
