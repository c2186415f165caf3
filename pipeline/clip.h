// pipeline/clip: triangles that cross the near or far plane or the guard band, in homogeneous clip space [BN78].
#pragma once

#include <algorithm>
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

/// Outcodes of the vertices of a patch as far as they are known: `must` has bits that a vertex has for certain, `may`
/// those that it can have. Equal: that is its outcode.
struct VertexCodes {
  std::array<std::int32_t, kVertexSlots> must;
  std::array<std::int32_t, kVertexSlots> may;

  bool isExact(std::uint32_t v) const { return must[v] == may[v]; }
};

/// Beside the bits of Outcode, in `may` of vertices that have not been transformed.
inline constexpr std::int32_t kUntransformed = 1 << 16;

/// Triangles picked from a patch, in the form that set-up reads.
struct TriangleRun {
  alignas(64) std::array<std::array<std::uint8_t, 512 + 16>, 3> corner;
  std::array<std::uint32_t, 512> source;
  std::uint32_t count = 0;

  void add(const std::array<const std::uint8_t*, 3>& from, const std::uint32_t* from_source, std::uint32_t t) {
    for (std::size_t i = 0; i < 3; ++i) corner[i][count] = from[i][t];
    source[count++] = from_source[t];
  }
  /// Padding, so that whole vectors may be read.
  void finish() {
    for (auto& corners : corner) std::fill_n(corners.begin() + count, 16, std::uint8_t{0});
  }
};

}  // namespace sheaf::pipeline
