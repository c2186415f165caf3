#include "pipeline/cull.h"

namespace sheaf::pipeline {
namespace {

Vec4 row(const Mat4& m, int i) {
  return {m[0][i], m[1][i], m[2][i], m[3][i]};
}

struct Range {
  float lo, hi;
};

// Of dot(plane, (p, 1)) over the box.
Range rangeOver(const Vec4& plane, const Box3& box) {
  Range range{plane.w, plane.w};
  for (int k = 0; k < 3; ++k) {
    const float a = plane[k] * box.lo[k];
    const float b = plane[k] * box.hi[k];
    range.lo += std::min(a, b);
    range.hi += std::max(a, b);
  }
  return range;
}

// A bound of the rounding in rangeOver and in the vertices' own transform; a patch within it of a plane counts as
// crossing.
float slackOver(const Vec4& plane, const Box3& box) {
  float magnitude = std::abs(plane.w);
  for (int k = 0; k < 3; ++k) magnitude += std::abs(plane[k]) * std::max(std::abs(box.lo[k]), std::abs(box.hi[k]));
  return kCodeSlack * magnitude;
}

bool isOutside(const std::array<Vec4, 6>& planes, const Box3& box) {
  for (const Vec4& plane : planes)
    if (rangeOver(plane, box).hi < -slackOver(plane, box)) return true;
  return false;
}

bool crosses(const Vec4& plane, const Box3& box) {
  return rangeOver(plane, box).lo < slackOver(plane, box);
}

// Every triangle of the patch is seen from behind: the eye lies behind the plane of each, wherever in the patch's
// sphere and whichever normal of the cone.
bool isBackFacing(const grouping::Patch& patch, const Vec4& eye_object) {
  if (patch.cone.sin_angle >= 1.0F) return false;
  if (eye_object.w == 0.0F) {
    const Vec3 from_eye = -Vec3(eye_object);
    return glm::dot(from_eye, patch.cone.axis) >= patch.cone.sin_angle * glm::length(from_eye);
  }
  const Vec3 from_eye = patch.bounds.center() - Vec3(eye_object);
  const float radius = 0.5F * glm::length(patch.bounds.size());
  return glm::dot(from_eye, patch.cone.axis) >= patch.cone.sin_angle * glm::length(from_eye) + radius;
}

}  // namespace

RunPlanes runPlanes(const Mat4& clip_from_space, const Viewport& viewport) {
  RunPlanes planes{};
  for (int k = 0; k < 4; ++k) {
    const Vec4& m = clip_from_space[k];
    const float guard_x = viewport.guard_x * m.w, guard_y = viewport.guard_y * m.w;
    const float tests[] = {m.w + m.x,     m.w - m.x,     m.w + m.y,     m.w - m.y,     m.z, m.w - m.z,
                           guard_x + m.x, guard_x - m.x, guard_y + m.y, guard_y - m.y, m.w};
    static_assert(std::size(tests) == RunPlanes::kCount);
    std::copy(std::begin(tests), std::end(tests), planes.coefficient[k]);
  }
  return planes;
}

InstanceView viewInstance(const scenes::Instance& instance, const Box3& bounds_object, const View& view, bool cull) {
  InstanceView out;
  out.clip_from_object = Mat4(view.clip_from_world * instance.world_from_object);
  const Vec4 x = row(out.clip_from_object, 0);
  const Vec4 y = row(out.clip_from_object, 1);
  const Vec4 z = row(out.clip_from_object, 2);
  const Vec4 w = row(out.clip_from_object, 3);
  out.view_planes = {w + x, w - x, w + y, w - y, z, w - z};
  const Vec4 guard_x = view.viewport.guard_x * w;
  const Vec4 guard_y = view.viewport.guard_y * w;
  out.guard_planes = {guard_x + x, guard_x - x, guard_y + y, guard_y - y};
  out.run_planes = runPlanes(out.clip_from_object, view.viewport);
  const DMat4 object_from_world = glm::inverse(instance.world_from_object);
  out.eye_object = Vec4(object_from_world * view.eye_world);
  out.mirrored = glm::determinant(DMat3(instance.world_from_object)) < 0.0;
  out.visible = !cull || (!bounds_object.empty() && !isOutside(out.view_planes, bounds_object));
  return out;
}

PatchVisibility classifyPatch(const grouping::Patch& patch, const InstanceView& view) {
  if (isOutside(view.view_planes, patch.bounds)) return PatchVisibility::kOutside;
  if (view.culls_back && isBackFacing(patch, view.eye_object)) return PatchVisibility::kBackFacing;
  const Box3& box = patch.bounds;
  bool clips = crosses(view.view_planes[4], box) || crosses(view.view_planes[5], box);
  for (const Vec4& plane : view.guard_planes) clips = clips || crosses(plane, box);
  if (clips) return PatchVisibility::kStraddling;
  for (std::size_t side = 0; side < 4; ++side)
    if (crosses(view.view_planes[side], box)) return PatchVisibility::kAcrossSides;
  return PatchVisibility::kInside;
}

RunCodes codeRun(const grouping::VertexRun& run, const RunPlanes& planes) {
  std::int32_t must = 0;
  std::int32_t may = 0;
  for (std::size_t i = 0; i < RunPlanes::kCount; ++i) {
    const float constant = planes.coefficient[3][i];
    float lo = constant, hi = constant, magnitude = std::abs(constant);
    float at_lo = constant, at_hi = constant;
    for (int k = 0; k < 3; ++k) {
      const float a = planes.coefficient[k][i] * run.corner_lo[k];
      const float b = planes.coefficient[k][i] * run.corner_hi[k];
      lo += std::min(a, b);
      hi += std::max(a, b);
      at_lo += a;
      at_hi += b;
      magnitude += std::max(std::abs(a), std::abs(b));
    }
    if (run.kind == grouping::RunKind::kLine) {
      lo = std::min(at_lo, at_hi);
      hi = std::max(at_lo, at_hi);
    }
    const float slack = kCodeSlack * magnitude;
    const std::int32_t bit = i == RunPlanes::kCount - 1 ? kOutNear : 1 << i;
    if (hi < -slack) must |= bit;
    if (lo <= slack) may |= bit;
  }
  return {must, may};
}

}  // namespace sheaf::pipeline
