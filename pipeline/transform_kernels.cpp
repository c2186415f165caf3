#include "pipeline/transform.h"
#include "raster/screen.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/transform_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sheaf::pipeline::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kMaxLanes = 16;
const hn::CappedTag<float, kMaxLanes> df;
const hn::RebindToSigned<decltype(df)> di;
using VF = hn::Vec<decltype(df)>;
using VI = hn::Vec<decltype(di)>;

void TransformVertices(const std::array<const float*, 3>& position, std::uint32_t count, const Mat4& m,
                       ClipVertices& out) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(df));
  float* const rows[4] = {out.x, out.y, out.z, out.w};
  for (std::uint32_t v = 0; v < count; v += lanes) {
    const VF x = hn::LoadU(df, position[0] + v);
    const VF y = hn::LoadU(df, position[1] + v);
    const VF z = hn::LoadU(df, position[2] + v);
    for (int row = 0; row < 4; ++row) {
      VF sum = hn::Add(hn::Set(df, m[3][row]), hn::Mul(hn::Set(df, m[0][row]), x));
      sum = hn::Add(sum, hn::Mul(hn::Set(df, m[1][row]), y));
      sum = hn::Add(sum, hn::Mul(hn::Set(df, m[2][row]), z));
      hn::Store(sum, df, rows[row] + v);
    }
  }
}

void ProjectVertices(const ClipVertices& vertices, std::uint32_t count, const Viewport& viewport,
                     ProjectedVertices& out) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(df));
  const VF half_width = hn::Set(df, viewport.half_width_px);
  const VF half_height = hn::Set(df, viewport.half_height_px);
  const VF subpixels = hn::Set(df, static_cast<float>(raster::kSubpixels));
  for (std::uint32_t v = 0; v < count; v += lanes) {
    const VF inv_w = hn::Div(hn::Set(df, 1.0F), hn::Load(df, vertices.w + v));
    const VF ndc_x = hn::Mul(hn::Load(df, vertices.x + v), inv_w);
    const VF ndc_y = hn::Mul(hn::Load(df, vertices.y + v), inv_w);
    const VF x_px = hn::Add(hn::Mul(ndc_x, half_width), half_width);
    const VF y_px = hn::Sub(half_height, hn::Mul(ndc_y, half_height));
    hn::Store(hn::NearestInt(hn::Mul(x_px, subpixels)), di, out.x_fx + v);
    hn::Store(hn::NearestInt(hn::Mul(y_px, subpixels)), di, out.y_fx + v);
    hn::Store(hn::Mul(hn::Load(df, vertices.z + v), inv_w), df, out.depth + v);
    hn::Store(inv_w, df, out.inv_w + v);
  }
}

VI BitWhere(hn::Mask<decltype(df)> mask, std::int32_t bit) {
  return hn::And(hn::VecFromMask(di, hn::RebindMask(di, mask)), hn::Set(di, bit));
}

OutcodeSummary OutcodeVertices(const ClipVertices& vertices, std::uint32_t count, const Viewport& viewport,
                               std::int32_t* codes) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(df));
  const VF zero = hn::Zero(df);
  OutcodeSummary summary{-1, 0};
  VI all = hn::Set(di, -1);
  VI any = hn::Zero(di);
  for (std::uint32_t v = 0; v < count; v += lanes) {
    const VF x = hn::Load(df, vertices.x + v);
    const VF y = hn::Load(df, vertices.y + v);
    const VF z = hn::Load(df, vertices.z + v);
    const VF w = hn::Load(df, vertices.w + v);
    const VF guard_x = hn::Mul(hn::Set(df, viewport.guard_x), w);
    const VF guard_y = hn::Mul(hn::Set(df, viewport.guard_y), w);
    VI code = hn::Or(BitWhere(hn::Lt(x, hn::Neg(w)), kOutLeft), BitWhere(hn::Gt(x, w), kOutRight));
    code = hn::Or(code, hn::Or(BitWhere(hn::Lt(y, hn::Neg(w)), kOutBottom), BitWhere(hn::Gt(y, w), kOutTop)));
    code = hn::Or(code, BitWhere(hn::Lt(z, zero), kOutFar));
    code = hn::Or(code, BitWhere(hn::Or(hn::Gt(z, w), hn::Le(w, zero)), kOutNear));
    code = hn::Or(code,
                  hn::Or(BitWhere(hn::Lt(x, hn::Neg(guard_x)), kGuardLeft), BitWhere(hn::Gt(x, guard_x), kGuardRight)));
    code = hn::Or(code,
                  hn::Or(BitWhere(hn::Lt(y, hn::Neg(guard_y)), kGuardBottom), BitWhere(hn::Gt(y, guard_y), kGuardTop)));
    hn::Store(code, di, codes + v);
    // Padding repeats a vertex, so that whole vectors may be summed up.
    all = hn::And(all, code);
    any = hn::Or(any, code);
  }
  alignas(64) std::int32_t all_lanes[kMaxLanes];
  alignas(64) std::int32_t any_lanes[kMaxLanes];
  hn::Store(all, di, all_lanes);
  hn::Store(any, di, any_lanes);
  for (std::uint32_t i = 0; i < lanes; ++i) {
    summary.all &= all_lanes[i];
    summary.any |= any_lanes[i];
  }
  return summary;
}

}  // namespace sheaf::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sheaf::pipeline {
HWY_EXPORT(TransformVertices);
HWY_EXPORT(ProjectVertices);
HWY_EXPORT(OutcodeVertices);

void transformVertices(const std::array<const float*, 3>& position, std::uint32_t count, const Mat4& clip_from_object,
                       ClipVertices& out) {
  HWY_DYNAMIC_DISPATCH(TransformVertices)(position, count, clip_from_object, out);
}
void projectVertices(const ClipVertices& vertices, std::uint32_t count, const Viewport& viewport,
                     ProjectedVertices& out) {
  HWY_DYNAMIC_DISPATCH(ProjectVertices)(vertices, count, viewport, out);
}
OutcodeSummary outcodeVertices(const ClipVertices& vertices, std::uint32_t count, const Viewport& viewport,
                               std::int32_t* codes) {
  return HWY_DYNAMIC_DISPATCH(OutcodeVertices)(vertices, count, viewport, codes);
}
}  // namespace sheaf::pipeline
#endif
