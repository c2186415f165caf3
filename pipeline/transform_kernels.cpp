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
const hn::RebindToUnsigned<decltype(df)> du;
using VF = hn::Vec<decltype(df)>;
using VI = hn::Vec<decltype(di)>;
using VU = hn::Vec<decltype(du)>;

// A vector for each row of a column of a matrix, or for each of the clip coordinates of a vector of vertices. Columns
// are spread out before a loop: stores to the result could otherwise be changing the matrix, for all that the compiler
// knows.
struct Rows {
  VF x, y, z, w;
};
HWY_INLINE Rows Spread(const Vec4& column) {
  return {hn::Set(df, column.x), hn::Set(df, column.y), hn::Set(df, column.z), hn::Set(df, column.w)};
}
HWY_INLINE Rows Sum(const Rows& a, const Rows& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z), hn::Add(a.w, b.w)};
}
HWY_INLINE Rows Scaled(const Rows& column, VF by) {
  return {hn::Mul(column.x, by), hn::Mul(column.y, by), hn::Mul(column.z, by), hn::Mul(column.w, by)};
}

#if HWY_MAX_BYTES >= 32
// Interleaving four vectors takes two steps within blocks of four lanes and, if a vector has several blocks, two more
// across them. The latter are spared by giving the lanes that order beforehand in which the first two leave what
// belongs together: lane k of block b is vertex k * blocks + b. That takes a shuffle for each vector that is loaded, of
// which there are one to three.
constexpr bool kReorders = true;
VU LaneOrder() {
  alignas(64) std::uint32_t order[kMaxLanes];
  const auto blocks = static_cast<std::uint32_t>(hn::Lanes(df) / 4);
  for (std::uint32_t lane = 0; lane < 4 * blocks; ++lane) order[lane] = lane % 4 * blocks + lane / 4;
  return hn::Load(du, order);
}
HWY_INLINE void StoreInterleaved(VF x, VF y, VF z, VF w, float* to) {
  const hn::RepartitionToWide<decltype(du)> du64;
  const auto pairs = [&](VF v) HWY_ATTR { return hn::BitCast(du64, v); };
  const auto xy_lo = pairs(hn::InterleaveLower(df, x, y)), xy_hi = pairs(hn::InterleaveUpper(df, x, y));
  const auto zw_lo = pairs(hn::InterleaveLower(df, z, w)), zw_hi = pairs(hn::InterleaveUpper(df, z, w));
  const std::size_t lanes = hn::Lanes(df);
  hn::StoreU(hn::BitCast(df, hn::InterleaveLower(du64, xy_lo, zw_lo)), df, to);
  hn::StoreU(hn::BitCast(df, hn::InterleaveUpper(du64, xy_lo, zw_lo)), df, to + lanes);
  hn::StoreU(hn::BitCast(df, hn::InterleaveLower(du64, xy_hi, zw_hi)), df, to + 2 * lanes);
  hn::StoreU(hn::BitCast(df, hn::InterleaveUpper(du64, xy_hi, zw_hi)), df, to + 3 * lanes);
}
#else
constexpr bool kReorders = false;
VU LaneOrder() {
  return hn::Zero(du);
}
HWY_INLINE void StoreInterleaved(VF x, VF y, VF z, VF w, float* to) {
  hn::StoreInterleaved4(x, y, z, w, df, to);
}
#endif

// Where a vector of transformed vertices goes, and in which order it wants its lanes. ToScreen stores whole vectors:
// what is beyond the end of a run is overwritten by the next one.
struct ToClipSpace {
  ClipVertices& out;
  template <class V>
  V arrange(V v) const {
    return v;
  }
  void store(const Rows& clip, std::uint32_t at, std::uint32_t end) const {
    const auto valid = hn::FirstN(df, std::min<std::size_t>(hn::Lanes(df), end - at));
    hn::BlendedStore(clip.x, valid, df, out.x + at);
    hn::BlendedStore(clip.y, valid, df, out.y + at);
    hn::BlendedStore(clip.z, valid, df, out.z + at);
    hn::BlendedStore(clip.w, valid, df, out.w + at);
  }
};
// Rounds x or y in subpixels to whole numbers, ties to even. Within the guard band they differ from `half`, the middle
// of the target, by less than 2^22. So v + (1.5 * 2^23 - half) is within [2^23, 2^24), where floats are the whole
// numbers and their bits count up one by one; `half` is even, so that ties stay what they are. A conversion takes four
// times as many operations, because it has to give the same on all targets beyond the range of integers too.
struct SubpixelAxis {
  static_assert(raster::kGuardBandPx * raster::kSubpixels <= 1 << 22);
  static_assert(raster::kSubpixels % 4 == 0, "half a width in subpixels is even");
  VF half;
  VF offset;
  VI zero;  // bits of 0 + offset

  explicit SubpixelAxis(float half_px) {
    // Subpixels in place of pixels: scaling by a power of two is exact.
    const auto half_fx = static_cast<std::int32_t>(half_px * raster::kSubpixels);
    half = hn::Set(df, static_cast<float>(half_fx));
    offset = hn::Set(df, static_cast<float>((3 << 22) - half_fx));
    zero = hn::Set(di, 0x4B000000 + (1 << 22) - half_fx);
  }
  HWY_INLINE VF round(VF v) const { return hn::BitCast(df, hn::Sub(hn::BitCast(di, hn::Add(v, offset)), zero)); }
};
struct ToScreen {
  SubpixelAxis x_axis;
  SubpixelAxis y_axis;
  VU order = LaneOrder();
  ProjectedVertices& out;

  ToScreen(const Viewport& viewport, ProjectedVertices& to)
      : x_axis(viewport.half_width_px), y_axis(viewport.half_height_px), out(to) {}

  template <class V>
  V arrange(V v) const {
    if constexpr (kReorders)
      return hn::TableLookupLanes(v, hn::IndicesFromVec(hn::DFromV<V>(), order));
    else
      return v;
  }
  void store(const Rows& clip, std::uint32_t at, std::uint32_t /*end*/) const {
    const VF inv_w = hn::Div(hn::Set(df, 1.0F), clip.w);
    const VF x_fx = hn::Add(hn::Mul(hn::Mul(clip.x, inv_w), x_axis.half), x_axis.half);
    const VF y_fx = hn::Sub(y_axis.half, hn::Mul(hn::Mul(clip.y, inv_w), y_axis.half));
    // Words as they are in memory; only their bits matter.
    StoreInterleaved(x_axis.round(x_fx), y_axis.round(y_fx), hn::Mul(clip.z, inv_w), inv_w,
                     reinterpret_cast<float*>(&out[at]));
  }
};

// Local numbers of the vertices that are written.
struct Slots {
  std::uint32_t first, end;
  explicit Slots(const RunPiece& piece) : first(piece.firstVertex()), end(piece.endVertex()) {}
};

// ((m3 + m0 x) + m1 y) + m2 z.
template <class Target>
HWY_INLINE void TransformFull(const float* x, std::size_t stride, const Mat4& m, Slots to, const Target& target) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(df));
  const Rows m0 = Spread(m[0]), m1 = Spread(m[1]), m2 = Spread(m[2]), m3 = Spread(m[3]);
  for (std::uint32_t v = 0; to.first + v < to.end; v += lanes) {
    const VF vx = target.arrange(hn::LoadU(df, x + v));
    const VF vy = target.arrange(hn::LoadU(df, x + stride + v));
    const VF vz = target.arrange(hn::LoadU(df, x + 2 * stride + v));
    target.store(Sum(Sum(Sum(m3, Scaled(m0, vx)), Scaled(m1, vy)), Scaled(m2, vz)), to.first + v, to.end);
  }
}

// Parameters as floats: stored so, or whole numbers of grid steps. `step` takes them to lengths.
struct FloatParameters {
  const Vec2* st;
  float step = 1.0F;
  template <class Target>
  void load(std::uint32_t v, const Target& target, VF& s, VF& t) const {
    hn::LoadInterleaved2(df, &st[v].x, s, t);
    s = target.arrange(s);
    t = target.arrange(t);
  }
};
struct GridParameters {
  const std::uint32_t* st;
  float step;
  std::int32_t corner_s;
  std::int32_t corner_t;
  template <class Target>
  void load(std::uint32_t v, const Target& target, VF& s, VF& t) const {
    const VU both = target.arrange(hn::LoadU(du, st + v));
    const VI q_s = hn::BitCast(di, hn::And(both, hn::Set(du, 0xFFFFU)));
    const VI q_t = hn::BitCast(di, hn::ShiftRight<16>(both));
    s = hn::ConvertTo(df, hn::Add(q_s, hn::Set(di, corner_s)));
    t = hn::ConvertTo(df, hn::Add(q_t, hn::Set(di, corner_t)));
  }
};

// [PG] eq. 2: base + s S + t T. The constant is added where coordinate kAxis has its place, so that sums round as those
// of TransformFull(): it is part of the base for x and costs one more addition for y and z.
template <std::size_t kAxis, class Parameters, class Target>
HWY_INLINE void TransformPlane(const Parameters& parameters, float plane, const Mat4& m, Slots to,
                               const Target& target) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(df));
  constexpr int kS = kAxis == 0 ? 1 : 0, kT = kAxis == 2 ? 1 : 2;
  const Rows constant = Scaled(Spread(m[static_cast<int>(kAxis)]), hn::Set(df, plane));
  const Rows base = kAxis == 0 ? Sum(Spread(m[3]), constant) : Spread(m[3]);
  // Scaling by a power of two is exact: these give the products of the whole coordinates.
  const VF step = hn::Set(df, parameters.step);
  const Rows s_column = Scaled(Spread(m[kS]), step), t_column = Scaled(Spread(m[kT]), step);
  for (std::uint32_t v = 0; to.first + v < to.end; v += lanes) {
    VF s, t;
    parameters.load(v, target, s, t);
    Rows sum = Sum(base, Scaled(s_column, s));
    if constexpr (kAxis == 1) sum = Sum(sum, constant);
    sum = Sum(sum, Scaled(t_column, t));
    if constexpr (kAxis == 2) sum = Sum(sum, constant);
    target.store(sum, to.first + v, to.end);
  }
}

template <class Parameters, class Target>
HWY_INLINE void TransformPlaneOf(const grouping::VertexRun& run, const Parameters& parameters, const Mat4& m, Slots to,
                                 const Target& target) {
  if (run.axis == 0)
    TransformPlane<0>(parameters, run.plane, m, to, target);
  else if (run.axis == 1)
    TransformPlane<1>(parameters, run.plane, m, to, target);
  else
    TransformPlane<2>(parameters, run.plane, m, to, target);
}

template <class Target>
HWY_INLINE void TransformPlaneRun(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch,
                                  const RunPiece& piece, const Mat4& clip_from_object, const Target& target) {
  const Mat4 m = clipFromPlanes(runs, patch, clip_from_object);
  const std::uint32_t first = piece.start.parameter + piece.begin;
  if (runs.form == grouping::ParameterForm::kFloat) {
    TransformPlaneOf(piece.run, FloatParameters{runs.parameters.data() + first}, m, Slots(piece), target);
  } else {
    const auto [i, j] = grouping::axesBeside(piece.run.axis);
    const GridParameters parameters{runs.quantised.data() + first, runs.step, patch.corner[i], patch.corner[j]};
    TransformPlaneOf(piece.run, parameters, m, Slots(piece), target);
  }
}

// A line in clip space: base + s along, with s = s0 + q ds for the stored q.
struct ClipLine {
  Vec4 base, along;
  float s0, ds;
};

// [PG] eq. 1.
template <class Parameters, class Target>
HWY_INLINE void TransformLine(const Parameters& parameters, const ClipLine& line, Slots to, const Target& target) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(df));
  const Rows origin = Spread(line.base), direction = Spread(line.along);
  const VF s0 = hn::Set(df, line.s0), ds = hn::Set(df, line.ds);
  for (std::uint32_t v = 0; to.first + v < to.end; v += lanes) {
    VF q, unused;
    parameters.load(v, target, q, unused);
    const VF s = hn::Add(s0, hn::Mul(q, ds));
    target.store(Sum(origin, Scaled(direction, s)), to.first + v, to.end);
  }
}

template <class Target>
HWY_INLINE void TransformLineRun(const grouping::VertexRuns& runs, const RunPiece& piece, const Mat4& m,
                                 const Target& target) {
  const grouping::RunLine& line = runs.lines[piece.run.line];
  const Vec4 base = ((m[3] + m[0] * line.base.x) + m[1] * line.base.y) + m[2] * line.base.z;
  const Vec4 along = (m[0] * line.direction.x + m[1] * line.direction.y) + m[2] * line.direction.z;
  const std::uint32_t first = piece.start.parameter + piece.begin;
  if (runs.form == grouping::ParameterForm::kFloat)
    TransformLine(FloatParameters{runs.parameters.data() + first}, {base, along, 0.0F, 1.0F}, Slots(piece), target);
  else
    TransformLine(GridParameters{runs.quantised.data() + first, 1.0F, 0, 0}, {base, along, line.s0, line.ds},
                  Slots(piece), target);
}

template <class Target>
HWY_INLINE void TransformPiece(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch,
                               const RunPiece& piece, const Mat4& m, const Target& target) {
  if (piece.run.kind == grouping::RunKind::kFull)
    TransformFull(runs.full.data() + piece.start.full + piece.begin, runs.full_stride, m, Slots(piece), target);
  else if (piece.run.kind == grouping::RunKind::kPlane)
    TransformPlaneRun(runs, patch, piece, m, target);
  else
    TransformLineRun(runs, piece, m, target);
}

void TransformPatch(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch, const Mat4& m,
                    const Viewport& viewport, ProjectedVertices& out) {
  const ToScreen target(viewport, out);
  RunStart start(patch);
  for (std::uint32_t r = 0; r < patch.run_count; ++r) {
    const grouping::VertexRun& run = runs.runs[patch.first_run + r];
    TransformPiece(runs, patch, {run, start, 0, run.vertex_count}, m, target);
    start.skip(run);
  }
}

void TransformRun(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch, const RunPiece& piece,
                  const Mat4& m, ClipVertices& out) {
  TransformPiece(runs, patch, piece, m, ToClipSpace{out});
}

void ProjectVertices(const ClipVertices& vertices, std::uint32_t begin, std::uint32_t end, const Viewport& viewport,
                     ProjectedVertices& out) {
  const ToScreen target(viewport, out);
  for (std::uint32_t v = begin; v < end; v += static_cast<std::uint32_t>(hn::Lanes(df)))
    target.store({target.arrange(hn::LoadU(df, vertices.x + v)), target.arrange(hn::LoadU(df, vertices.y + v)),
                  target.arrange(hn::LoadU(df, vertices.z + v)), target.arrange(hn::LoadU(df, vertices.w + v))},
                 v, end);
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
void transformRun(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch, const RunPiece& piece,
                  const Mat4& clip_from_object, ClipVertices& out) {
  HWY_DYNAMIC_DISPATCH(TransformRun)(runs, patch, piece, clip_from_object, out);
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
