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

const hn::Rebind<std::uint16_t, decltype(df)> du16;

// Where transformed vertices go. Whole vectors: also beyond the end of a run, where the next one overwrites them.
struct WholeVectors {
  ClipVertices& out;
  void store(VF v, float* row, std::uint32_t at, std::uint32_t /*end*/) const { hn::StoreU(v, df, row + at); }
};
struct UpToEnd {
  ClipVertices& out;
  void store(VF v, float* row, std::uint32_t at, std::uint32_t end) const {
    hn::BlendedStore(v, hn::FirstN(df, std::min<std::size_t>(hn::Lanes(df), end - at)), df, row + at);
  }
};

// ((m3 + a x_a) + b x_b) + c x_c with (a, b, c) = (axis, the two others).
template <class Target>
HWY_INLINE void TransformFull(const grouping::VertexRuns& runs, std::size_t axis, std::uint32_t first, std::uint32_t to,
                              std::uint32_t end, const Mat4& m, const Target& target) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(df));
  const auto [second, third] = grouping::axesBeside(axis);
  const float* const xa = runs.full[axis].data() + first;
  const float* const xb = runs.full[second].data() + first;
  const float* const xc = runs.full[third].data() + first;
  const Vec4 ma = m[static_cast<int>(axis)], mb = m[static_cast<int>(second)], mc = m[static_cast<int>(third)];
  float* const rows[4] = {target.out.x, target.out.y, target.out.z, target.out.w};
  for (std::uint32_t v = 0; to + v < end; v += lanes) {
    const VF a = hn::LoadU(df, xa + v);
    const VF b = hn::LoadU(df, xb + v);
    const VF c = hn::LoadU(df, xc + v);
    for (int row = 0; row < 4; ++row) {
      VF sum = hn::Add(hn::Set(df, m[3][row]), hn::Mul(hn::Set(df, ma[row]), a));
      sum = hn::Add(sum, hn::Mul(hn::Set(df, mb[row]), b));
      sum = hn::Add(sum, hn::Mul(hn::Set(df, mc[row]), c));
      target.store(sum, rows[row], to + v, end);
    }
  }
}

// Parameters as floats: stored so, or whole numbers of grid steps.
struct FloatParameters {
  const float* s;
  const float* t;
  VF loadS(std::uint32_t v) const { return hn::LoadU(df, s + v); }
  VF loadT(std::uint32_t v) const { return hn::LoadU(df, t + v); }
};
struct GridParameters {
  const std::uint16_t* s;
  const std::uint16_t* t;
  std::int32_t corner_s;
  std::int32_t corner_t;
  static VF load(const std::uint16_t* q, std::int32_t corner) {
    return hn::ConvertTo(df, hn::Add(hn::PromoteTo(di, hn::LoadU(du16, q)), hn::Set(di, corner)));
  }
  VF loadS(std::uint32_t v) const { return load(s + v, corner_s); }
  VF loadT(std::uint32_t v) const { return load(t + v, corner_t); }
};

// [PG] eq. 2: base + s S + t T.
template <class Parameters, class Target>
HWY_INLINE void TransformPlane(const Parameters& parameters, const Vec4& base, const Vec4& along_s, const Vec4& along_t,
                               std::uint32_t to, std::uint32_t end, const Target& target) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(df));
  float* const rows[4] = {target.out.x, target.out.y, target.out.z, target.out.w};
  for (std::uint32_t v = 0; to + v < end; v += lanes) {
    const VF s = parameters.loadS(v);
    const VF t = parameters.loadT(v);
    for (int row = 0; row < 4; ++row) {
      const VF sum = hn::Add(hn::Set(df, base[row]), hn::Mul(hn::Set(df, along_s[row]), s));
      target.store(hn::Add(sum, hn::Mul(hn::Set(df, along_t[row]), t)), rows[row], to + v, end);
    }
  }
}

// [PG] eq. 1: base + s L.
template <class LoadS, class Target>
HWY_INLINE void TransformLine(const LoadS& load_s, const Vec4& base, const Vec4& along, std::uint32_t to,
                              std::uint32_t end, const Target& target) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(df));
  float* const rows[4] = {target.out.x, target.out.y, target.out.z, target.out.w};
  for (std::uint32_t v = 0; to + v < end; v += lanes) {
    const VF s = load_s(v);
    for (int row = 0; row < 4; ++row)
      target.store(hn::Add(hn::Set(df, base[row]), hn::Mul(hn::Set(df, along[row]), s)), rows[row], to + v, end);
  }
}

template <class Target>
HWY_INLINE void TransformPlaneRun(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch,
                                  const grouping::VertexRun& run, std::uint32_t first, std::uint32_t to,
                                  std::uint32_t end, const Mat4& m, const Target& target) {
  const auto [i, j] = grouping::axesBeside(run.axis);
  const Vec4 base = m[3] + m[run.axis] * run.plane;
  const Vec4 s = m[static_cast<int>(i)], t = m[static_cast<int>(j)];
  if (runs.form == grouping::ParameterForm::kFloat) {
    const FloatParameters parameters{runs.parameters[0].data() + first, runs.parameters[1].data() + first};
    TransformPlane(parameters, base, s, t, to, end, target);
  } else {
    // Scaling by a power of two is exact: these are the products of the whole coordinates.
    const GridParameters parameters{runs.quantised[0].data() + first, runs.quantised[1].data() + first, patch.corner[i],
                                    patch.corner[j]};
    TransformPlane(parameters, base, s * runs.step, t * runs.step, to, end, target);
  }
}

template <class Target>
HWY_INLINE void TransformLineRun(const grouping::VertexRuns& runs, const grouping::VertexRun& run, std::uint32_t first,
                                 std::uint32_t to, std::uint32_t end, const Mat4& m, const Target& target) {
  const grouping::RunLine& line = runs.lines[run.line];
  const Vec4 base = ((m[3] + m[0] * line.base.x) + m[1] * line.base.y) + m[2] * line.base.z;
  const Vec4 along = (m[0] * line.direction.x + m[1] * line.direction.y) + m[2] * line.direction.z;
  if (runs.form == grouping::ParameterForm::kFloat) {
    const float* const s = runs.parameters[0].data() + first;
    TransformLine([&](std::uint32_t v) HWY_ATTR { return hn::LoadU(df, s + v); }, base, along, to, end, target);
  } else {
    const std::uint16_t* const q = runs.quantised[0].data() + first;
    const auto load_s = [&](std::uint32_t v) HWY_ATTR {
      const VF steps = hn::ConvertTo(df, hn::PromoteTo(di, hn::LoadU(du16, q + v)));
      return hn::Add(hn::Set(df, line.s0), hn::Mul(steps, hn::Set(df, line.ds)));
    };
    TransformLine(load_s, base, along, to, end, target);
  }
}

// Vertices [begin, end) of a run.
template <class Target>
HWY_INLINE void TransformAnyRun(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch,
                                const grouping::VertexRun& run, const RunStart& start, std::uint32_t begin,
                                std::uint32_t end, const Mat4& m, const Target& target) {
  const std::uint32_t to = start.vertex + begin;
  const std::uint32_t to_end = start.vertex + end;
  if (run.kind == grouping::RunKind::kFull)
    TransformFull(runs, run.axis, start.full + begin, to, to_end, m, target);
  else if (run.kind == grouping::RunKind::kPlane)
    TransformPlaneRun(runs, patch, run, start.parameter + begin, to, to_end, m, target);
  else
    TransformLineRun(runs, run, start.parameter + begin, to, to_end, m, target);
}

void TransformPatch(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch, const Mat4& m,
                    ClipVertices& out) {
  RunStart start(patch);
  for (std::uint32_t r = 0; r < patch.run_count; ++r) {
    const grouping::VertexRun& run = runs.runs[patch.first_run + r];
    TransformAnyRun(runs, patch, run, start, 0, run.vertex_count, m, WholeVectors{out});
    start.skip(run);
  }
}

void TransformRun(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch, const grouping::VertexRun& run,
                  const RunStart& start, std::uint32_t begin, std::uint32_t end, const Mat4& m, ClipVertices& out) {
  TransformAnyRun(runs, patch, run, start, begin, end, m, UpToEnd{out});
}

void ProjectVertices(const ClipVertices& vertices, std::uint32_t begin, std::uint32_t end, const Viewport& viewport,
                     ProjectedVertices& out) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(df));
  const VF half_width = hn::Set(df, viewport.half_width_px);
  const VF half_height = hn::Set(df, viewport.half_height_px);
  const VF subpixels = hn::Set(df, static_cast<float>(raster::kSubpixels));
  for (std::uint32_t v = begin; v < end; v += lanes) {
    const VF inv_w = hn::Div(hn::Set(df, 1.0F), hn::LoadU(df, vertices.w + v));
    const VF ndc_x = hn::Mul(hn::LoadU(df, vertices.x + v), inv_w);
    const VF ndc_y = hn::Mul(hn::LoadU(df, vertices.y + v), inv_w);
    const VF x_px = hn::Add(hn::Mul(ndc_x, half_width), half_width);
    const VF y_px = hn::Sub(half_height, hn::Mul(ndc_y, half_height));
    const VF x_fx = hn::BitCast(df, hn::NearestInt(hn::Mul(x_px, subpixels)));
    const VF y_fx = hn::BitCast(df, hn::NearestInt(hn::Mul(y_px, subpixels)));
    const VF depth = hn::Mul(hn::LoadU(df, vertices.z + v), inv_w);
    // Words as they are in memory; only their bits matter.
    hn::StoreInterleaved4(x_fx, y_fx, depth, inv_w, df, reinterpret_cast<float*>(&out[v]));
  }
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
                    ClipVertices& out) {
  HWY_DYNAMIC_DISPATCH(TransformPatch)(runs, patch, clip_from_object, out);
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
