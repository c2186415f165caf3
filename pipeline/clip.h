// pipeline/clip: triangles that cross the near or far plane or the guard band, in homogeneous clip space [BN78].
#pragma once

#include <array>
#include <cstdint>

#include "core/math.h"
#include "pipeline/transform.h"

namespace sheaf::pipeline {

/// A convex polygon; three corners cut by six planes have at most nine.
struct ClippedPolygon {
  std::array<Vec4, 9> corners;
  int count = 0;
};

/// Cuts the triangle by those planes whose bits (of kClipBits) are set in `planes`, the OR of its corners' outcodes. A
/// cut point is computed from the inner to the outer end of its edge, so that neighbours get the same one.
ClippedPolygon clipTriangle(const std::array<Vec4, 3>& triangle, std::int32_t planes, const Viewport& viewport);

/// Splits the patch's triangles by outcode: those that need no clipping are copied to `inside`, numbers of those that
/// do go to `clipped`, the rest is outside.
struct TriangleRun {
  alignas(64) std::array<std::array<std::uint8_t, 512 + 16>, 3> corner;
  std::array<std::uint32_t, 512> source;
  std::uint32_t count = 0;
};
struct ClassifiedTriangles {
  TriangleRun inside;
  std::array<std::uint32_t, 512> clipped;
  std::uint32_t clipped_count = 0;
  std::uint32_t outside_count = 0;
};
void classifyTriangles(const std::array<const std::uint8_t*, 3>& corner, const std::uint32_t* source,
                       std::uint32_t count, const std::int32_t* codes, ClassifiedTriangles& out);

}  // namespace sheaf::pipeline
