#include "pipeline/transform.h"

#include "raster/screen.h"

namespace sheaf::pipeline {
namespace {
// A pixel less than the raster's band: clipping rounds.
constexpr float kGuardPx = raster::kGuardBandPx - 1;
}  // namespace

Viewport::Viewport(int width, int height)
    : half_width_px(0.5F * static_cast<float>(width)),
      half_height_px(0.5F * static_cast<float>(height)),
      guard_x(kGuardPx / half_width_px),
      guard_y(kGuardPx / half_height_px) {}

Vec4 transformVertex(const Vec3& p, const Mat4& m) {
  Vec4 clip;
  for (int row = 0; row < 4; ++row) clip[row] = ((m[3][row] + m[0][row] * p.x) + m[1][row] * p.y) + m[2][row] * p.z;
  return clip;
}

Mat4 clipFromPlanes(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch, const Mat4& clip_from_object) {
  if (patch.frame == grouping::kNoIndex) return clip_from_object;
  const grouping::PatchFrame& frame = runs.frames[patch.frame];
  const Mat4 object_from_patch(Vec4(frame.axes.axis_s, 0.0F), Vec4(frame.axes.axis_t, 0.0F),
                               Vec4(frame.axes.normal, 0.0F), Vec4(frame.origin, 1.0F));
  return clip_from_object * object_from_patch;
}

Vec4 transformGrouped(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch,
                      const grouping::VertexRun& run, const StoredParameters& parameters, const Mat4& m) {
  const bool quantised = runs.form == grouping::ParameterForm::k16Bit;
  if (run.kind == grouping::RunKind::kLine) {
    const grouping::RunLine& line = runs.lines[run.line];
    const Vec4 base = transformVertex(line.base, m);
    const float s = quantised ? line.s0 + parameters.s * line.ds : parameters.s;
    Vec4 clip;
    for (int row = 0; row < 4; ++row) {
      const float direction =
          (m[0][row] * line.direction.x + m[1][row] * line.direction.y) + m[2][row] * line.direction.z;
      clip[row] = base[row] + direction * s;
    }
    return clip;
  }
  const auto [i, j] = grouping::axesBeside(run.axis);
  Vec3 position;
  position[run.axis] = run.plane;
  position[static_cast<int>(i)] =
      quantised ? static_cast<float>(patch.corner[i] + static_cast<std::int32_t>(parameters.s)) * runs.step
                : parameters.s;
  position[static_cast<int>(j)] =
      quantised ? static_cast<float>(patch.corner[j] + static_cast<std::int32_t>(parameters.t)) * runs.step
                : parameters.t;
  return transformVertex(position, clipFromPlanes(runs, patch, m));
}

raster::ScreenVertex projectVertex(const Vec4& clip, const Viewport& viewport) {
  const float inv_w = 1.0F / clip.w;
  const float x_px = (clip.x * inv_w) * viewport.half_width_px + viewport.half_width_px;
  const float y_px = viewport.half_height_px - (clip.y * inv_w) * viewport.half_height_px;
  return {static_cast<std::int32_t>(std::nearbyint(x_px * raster::kSubpixels)),
          static_cast<std::int32_t>(std::nearbyint(y_px * raster::kSubpixels)), clip.z * inv_w, inv_w};
}

std::int32_t outcodeVertex(const Vec4& c, const Viewport& viewport) {
  const float guard_x = viewport.guard_x * c.w;
  const float guard_y = viewport.guard_y * c.w;
  std::int32_t code = 0;
  if (c.x < -c.w) code |= kOutLeft;
  if (c.x > c.w) code |= kOutRight;
  if (c.y < -c.w) code |= kOutBottom;
  if (c.y > c.w) code |= kOutTop;
  if (c.z < 0.0F) code |= kOutFar;
  if (c.z > c.w || c.w <= 0.0F) code |= kOutNear;
  if (c.x < -guard_x) code |= kGuardLeft;
  if (c.x > guard_x) code |= kGuardRight;
  if (c.y < -guard_y) code |= kGuardBottom;
  if (c.y > guard_y) code |= kGuardTop;
  return code;
}

}  // namespace sheaf::pipeline
