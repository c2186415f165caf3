#include "pipeline/transform.h"

#include <algorithm>

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

// Where a vector of transformed vertices goes. ToScreen stores whole vectors: what is beyond the end of a run is
// overwritten by the next one.
struct ToClipSpace {
  ClipVertices& out;
  void store(VF x, VF y, VF z, VF w, std::uint32_t at, std::uint32_t end) const {
    const auto valid = hn::FirstN(df, std::min<std::size_t>(hn::Lanes(df), end - at));
    hn::BlendedStore(x, valid, df, out.x + at);
    hn::BlendedStore(y, valid, df, out.y + at);
    hn::BlendedStore(z, valid, df, out.z + at);
    hn::BlendedStore(w, valid, df, out.w + at);
  }
};
struct ToScreen {
  VF half_width;
  VF half_height;
  ProjectedVertices& out;

  ToScreen(const Viewport& viewport, ProjectedVertices& to)
      : half_width(hn::Set(df, viewport.half_width_px)), half_height(hn::Set(df, viewport.half_height_px)), out(to) {}

  void store(VF x, VF y, VF z, VF w, std::uint32_t at, std::uint32_t /*end*/) const {
    const VF inv_w = hn::Div(hn::Set(df, 1.0F), w);
    const VF subpixels = hn::Set(df, static_cast<float>(raster::kSubpixels));
    const VF x_px = hn::Add(hn::Mul(hn::Mul(x, inv_w), half_width), half_width);
    const VF y_px = hn::Sub(half_height, hn::Mul(hn::Mul(y, inv_w), half_height));
    const VF x_fx = hn::BitCast(df, hn::NearestInt(hn::Mul(x_px, subpixels)));
    const VF y_fx = hn::BitCast(df, hn::NearestInt(hn::Mul(y_px, subpixels)));
    // Words as they are in memory; only their bits matter.
    hn::StoreInterleaved4(x_fx, y_fx, hn::Mul(z, inv_w), inv_w, df, reinterpret_cast<float*>(&out[at]));
  }
};

// ((m3 + m0 x) + m1 y) + m2 z.
template <class Target>
HWY_INLINE void TransformFull(const float* x, std::size_t stride, std::uint32_t to, std::uint32_t end, const Mat4& m,
                              const Target& target) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(df));
  for (std::uint32_t v = 0; to + v < end; v += lanes) {
    const VF vx = hn::LoadU(df, x + v);
    const VF vy = hn::LoadU(df, x + stride + v);
    const VF vz = hn::LoadU(df, x + 2 * stride + v);
    const auto row = [&](int i) HWY_ATTR {
      const VF sum = hn::Add(hn::Set(df, m[3][i]), hn::Mul(hn::Set(df, m[0][i]), vx));
      return hn::Add(hn::Add(sum, hn::Mul(hn::Set(df, m[1][i]), vy)), hn::Mul(hn::Set(df, m[2][i]), vz));
    };
    target.store(row(0), row(1), row(2), row(3), to + v, end);
  }
}

// Parameters as floats: stored so, or whole numbers of grid steps.
struct FloatParameters {
  const Vec2* st;
  void load(std::uint32_t v, VF& s, VF& t) const { hn::LoadInterleaved2(df, &st[v].x, s, t); }
};
struct GridParameters {
  const std::uint32_t* st;
  std::int32_t corner_s;
  std::int32_t corner_t;
  void load(std::uint32_t v, VF& s, VF& t) const {
    const hn::RebindToUnsigned<decltype(df)> du;
    const auto both = hn::LoadU(du, st + v);
    const VI q_s = hn::BitCast(di, hn::And(both, hn::Set(du, 0xFFFFU)));
    const VI q_t = hn::BitCast(di, hn::ShiftRight<16>(both));
    s = hn::ConvertTo(df, hn::Add(q_s, hn::Set(di, corner_s)));
    t = hn::ConvertTo(df, hn::Add(q_t, hn::Set(di, corner_t)));
  }
};

// [PG] eq. 2: base + s S + t T. The constant is added where coordinate kAxis has its place, so that sums round as those
// of TransformFull(): it is part of the base for x and costs one more addition for y and z.
template <std::size_t kAxis, class Parameters, class Target>
HWY_INLINE void TransformPlane(const Parameters& parameters, const Vec4& origin, const Vec4& constant,
                               const Vec4& along_s, const Vec4& along_t, std::uint32_t to, std::uint32_t end,
                               const Target& target) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(df));
  const Vec4 base = kAxis == 0 ? origin + constant : origin;
  for (std::uint32_t v = 0; to + v < end; v += lanes) {
    VF s, t;
    parameters.load(v, s, t);
    const auto row = [&](int i) HWY_ATTR {
      VF sum = hn::Add(hn::Set(df, base[i]), hn::Mul(hn::Set(df, along_s[i]), s));
      if constexpr (kAxis == 1) sum = hn::Add(sum, hn::Set(df, constant[i]));
      sum = hn::Add(sum, hn::Mul(hn::Set(df, along_t[i]), t));
      if constexpr (kAxis == 2) sum = hn::Add(sum, hn::Set(df, constant[i]));
      return sum;
    };
    target.store(row(0), row(1), row(2), row(3), to + v, end);
  }
}

template <class Parameters, class Target>
HWY_INLINE void TransformPlaneOn(std::size_t axis, const Parameters& parameters, float plane, float step, const Mat4& m,
                                 std::uint32_t to, std::uint32_t end, const Target& target) {
  const auto [i, j] = grouping::axesBeside(axis);
  const Vec4 constant = m[static_cast<int>(axis)] * plane;
  // Scaling by a power of two is exact: these give the products of the whole coordinates.
  const Vec4 s = m[static_cast<int>(i)] * step, t = m[static_cast<int>(j)] * step;
  if (axis == 0)
    TransformPlane<0>(parameters, m[3], constant, s, t, to, end, target);
  else if (axis == 1)
    TransformPlane<1>(parameters, m[3], constant, s, t, to, end, target);
  else
    TransformPlane<2>(parameters, m[3], constant, s, t, to, end, target);
}

// [PG] eq. 1: base + s L, with s = s0 + q ds for the stored q.
template <class Parameters, class Target>
HWY_INLINE void TransformLine(const Parameters& parameters, float s0, float ds, const Vec4& base, const Vec4& along,
                              std::uint32_t to, std::uint32_t end, const Target& target) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(df));
  for (std::uint32_t v = 0; to + v < end; v += lanes) {
    VF s, unused;
    parameters.load(v, s, unused);
    s = hn::Add(hn::Set(df, s0), hn::Mul(s, hn::Set(df, ds)));
    const auto row = [&](int i) HWY_ATTR { return hn::Add(hn::Set(df, base[i]), hn::Mul(hn::Set(df, along[i]), s)); };
    target.store(row(0), row(1), row(2), row(3), to + v, end);
  }
}

template <class Target>
HWY_INLINE void TransformPlaneRun(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch,
                                  const grouping::VertexRun& run, std::uint32_t first, std::uint32_t to,
                                  std::uint32_t end, const Mat4& m, const Target& target) {
  if (runs.form == grouping::ParameterForm::kFloat) {
    const FloatParameters parameters{runs.parameters.data() + first};
    TransformPlaneOn(run.axis, parameters, run.plane, 1.0F, m, to, end, target);
  } else {
    const auto [i, j] = grouping::axesBeside(run.axis);
    const GridParameters parameters{runs.quantised.data() + first, patch.corner[i], patch.corner[j]};
    TransformPlaneOn(run.axis, parameters, run.plane, runs.step, m, to, end, target);
  }
}

template <class Target>
HWY_INLINE void TransformLineRun(const grouping::VertexRuns& runs, const grouping::VertexRun& run, std::uint32_t first,
                                 std::uint32_t to, std::uint32_t end, const Mat4& m, const Target& target) {
  const grouping::RunLine& line = runs.lines[run.line];
  const Vec4 base = ((m[3] + m[0] * line.base.x) + m[1] * line.base.y) + m[2] * line.base.z;
  const Vec4 along = (m[0] * line.direction.x + m[1] * line.direction.y) + m[2] * line.direction.z;
  if (runs.form == grouping::ParameterForm::kFloat)
    TransformLine(FloatParameters{runs.parameters.data() + first}, 0.0F, 1.0F, base, along, to, end, target);
  else
    TransformLine(GridParameters{runs.quantised.data() + first, 0, 0}, line.s0, line.ds, base, along, to, end, target);
}

// Vertices [begin, end) of a run.
template <class Target>
HWY_INLINE void TransformAnyRun(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch,
                                const grouping::VertexRun& run, const RunStart& start, std::uint32_t begin,
                                std::uint32_t end, const Mat4& m, const Target& target) {
  const std::uint32_t to = start.vertex + begin;
  const std::uint32_t to_end = start.vertex + end;
  if (run.kind == grouping::RunKind::kFull)
    TransformFull(runs.full.data() + start.full + begin, runs.full_stride, to, to_end, m, target);
  else if (run.kind == grouping::RunKind::kPlane)
    TransformPlaneRun(runs, patch, run, start.parameter + begin, to, to_end, clipFromPlanes(runs, patch, m), target);
  else
    TransformLineRun(runs, run, start.parameter + begin, to, to_end, m, target);
}

void TransformPatch(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch, const Mat4& m,
                    const Viewport& viewport, ProjectedVertices& out) {
  const ToScreen target(viewport, out);
  RunStart start(patch);
  for (std::uint32_t r = 0; r < patch.run_count; ++r) {
    const grouping::VertexRun& run = runs.runs[patch.first_run + r];
    TransformAnyRun(runs, patch, run, start, 0, run.vertex_count, m, target);
    start.skip(run);
  }
}

void TransformRun(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch, const grouping::VertexRun& run,
                  const RunStart& start, std::uint32_t begin, std::uint32_t end, const Mat4& m, ClipVertices& out) {
  TransformAnyRun(runs, patch, run, start, begin, end, m, ToClipSpace{out});
}

void ProjectVertices(const ClipVertices& vertices, std::uint32_t begin, std::uint32_t end, const Viewport& viewport,
                     ProjectedVertices& out) {
  const ToScreen target(viewport, out);
  for (std::uint32_t v = begin; v < end; v += static_cast<std::uint32_t>(hn::Lanes(df)))
    target.store(hn::LoadU(df, vertices.x + v), hn::LoadU(df, vertices.y + v), hn::LoadU(df, vertices.z + v),
                 hn::LoadU(df, vertices.w + v), v, end);
}

VI BitWhere(hn::Mask<decltype(df)> mask, std::int32_t bit) {
  return hn::And(hn::VecFromMask(di, hn::RebindMask(di, mask)), hn::Set(di, bit));
}

OutcodeSummary OutcodeVertices(const ClipVertices& vertices, std::uint32_t begin, std::uint32_t end,
                               const Viewport& viewport, std::int32_t* codes) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(df));
  const VF zero = hn::Zero(df);
  VI all = hn::Set(di, -1);
  VI any = hn::Zero(di);
  for (std::uint32_t v = begin; v < end; v += lanes) {
    const VF x = hn::LoadU(df, vertices.x + v);
    const VF y = hn::LoadU(df, vertices.y + v);
    const VF z = hn::LoadU(df, vertices.z + v);
    const VF w = hn::LoadU(df, vertices.w + v);
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
    const auto valid = hn::FirstN(di, std::min(lanes, end - v));
    hn::BlendedStore(code, valid, di, codes + v);
    all = hn::IfThenElse(valid, hn::And(all, code), all);
    any = hn::IfThenElse(valid, hn::Or(any, code), any);
  }
  alignas(64) std::int32_t all_lanes[kMaxLanes];
  alignas(64) std::int32_t any_lanes[kMaxLanes];
  hn::Store(all, di, all_lanes);
  hn::Store(any, di, any_lanes);
  OutcodeSummary summary{-1, 0};
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
HWY_EXPORT(TransformPatch);
HWY_EXPORT(TransformRun);
HWY_EXPORT(ProjectVertices);
HWY_EXPORT(OutcodeVertices);

void transformPatch(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch, const Mat4& clip_from_object,
                    const Viewport& viewport, ProjectedVertices& out) {
  HWY_DYNAMIC_DISPATCH(TransformPatch)(runs, patch, clip_from_object, viewport, out);
}
void transformRun(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch, const grouping::VertexRun& run,
                  const RunStart& start, std::uint32_t begin, std::uint32_t end, const Mat4& clip_from_object,
                  ClipVertices& out) {
  HWY_DYNAMIC_DISPATCH(TransformRun)(runs, patch, run, start, begin, end, clip_from_object, out);
}
void projectVertices(const ClipVertices& vertices, std::uint32_t begin, std::uint32_t end, const Viewport& viewport,
                     ProjectedVertices& out) {
  HWY_DYNAMIC_DISPATCH(ProjectVertices)(vertices, begin, end, viewport, out);
}
OutcodeSummary outcodeVertices(const ClipVertices& vertices, std::uint32_t begin, std::uint32_t end,
                               const Viewport& viewport, std::int32_t* codes) {
  return HWY_DYNAMIC_DISPATCH(OutcodeVertices)(vertices, begin, end, viewport, codes);
}
}  // namespace sheaf::pipeline
#endif
