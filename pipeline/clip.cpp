#include "pipeline/clip.h"

#include <algorithm>

namespace sheaf::pipeline {
namespace {

struct ClipPlane {
  std::int32_t bit;
  Vec4 functional;  // inside where dot(functional, clip) >= 0
};

void clipBy(const Vec4& plane, ClippedPolygon& polygon) {
  ClippedPolygon out;
  for (int i = 0; i < polygon.count; ++i) {
    const Vec4& a = polygon.corners[static_cast<std::size_t>(i)];
    const Vec4& b = polygon.corners[static_cast<std::size_t>((i + 1) % polygon.count)];
    const float ha = glm::dot(plane, a);
    const float hb = glm::dot(plane, b);
    if (ha >= 0.0F) out.corners[static_cast<std::size_t>(out.count++)] = a;
    if ((ha >= 0.0F) == (hb >= 0.0F)) continue;
    const bool a_inside = ha >= 0.0F;
    const Vec4& inner = a_inside ? a : b;
    const Vec4& outer = a_inside ? b : a;
    const float h_inner = a_inside ? ha : hb;
    const float h_outer = a_inside ? hb : ha;
    const float t = h_inner / (h_inner - h_outer);
    out.corners[static_cast<std::size_t>(out.count++)] = inner + t * (outer - inner);
  }
  polygon = out;
}

}  // namespace

ClippedPolygon clipTriangle(const std::array<Vec4, 3>& triangle, std::int32_t planes, const Viewport& viewport) {
  // Near first: what is left has w > 0.
  const ClipPlane all[6] = {
      {kOutNear, {0.0F, 0.0F, -1.0F, 1.0F}},
      {kOutFar, {0.0F, 0.0F, 1.0F, 0.0F}},
      {kGuardLeft, {1.0F, 0.0F, 0.0F, viewport.guard_x}},
      {kGuardRight, {-1.0F, 0.0F, 0.0F, viewport.guard_x}},
      {kGuardBottom, {0.0F, 1.0F, 0.0F, viewport.guard_y}},
      {kGuardTop, {0.0F, -1.0F, 0.0F, viewport.guard_y}},
  };
  // A point cut by the near plane may lie beyond a guard plane that no corner of the triangle is beyond.
  if ((planes & kOutNear) != 0) planes = kClipBits;
  ClippedPolygon polygon;
  std::copy(triangle.begin(), triangle.end(), polygon.corners.begin());
  polygon.count = 3;
  for (const ClipPlane& plane : all)
    if ((planes & plane.bit) != 0 && polygon.count > 0) clipBy(plane.functional, polygon);
  return polygon;
}

}  // namespace sheaf::pipeline
