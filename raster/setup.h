// raster/setup: from projected corners to binned triangles: facing, zero coverage, depth and barycentric planes.
#pragma once

#include <array>
#include <cstdint>

#include "raster/bins.h"
#include "raster/screen.h"

namespace sheaf::raster {

/// A projected vertex; 16 bytes, so that set-up reads it with one load.
struct alignas(16) ScreenVertex {
  std::int32_t x_fx, y_fx;  ///< 24.8, within the guard band
  float depth;              ///< reversed, [0, 1]
  float inv_w;              ///< 1 / w, > 0
};

/// Which side of a triangle is its front, as the sign of (v1 - v0) x (v2 - v0) with y down; and whether backs are
/// drawn.
struct Facing {
  std::int32_t front_sign = -1;  ///< -1: counter-clockwise on screen (y up) is front; +1: mirrored
  bool cull_back = true;
};

/// Triangles of one patch of one instance. Arrays of corners are readable, in whole vectors, up to the next multiple of
/// 16; padding is (0, 0, 0).
struct PatchTriangles {
  std::array<const std::uint8_t*, 3> corner;  ///< #T each: local vertex
  const std::uint32_t* source;                ///< #T: number of the triangle in its mesh
  std::uint32_t count = 0;
  std::uint32_t first_vertex = 0;  ///< local vertex 0 in the surface's attribute arrays
  std::uint32_t surface = 0;
  Facing facing;
};

struct SetupCounts {
  std::uint64_t back_facing = 0;  ///< or without area
  std::uint64_t no_sample = 0;    ///< no pixel centre within the box, or small and none covered
  std::uint64_t binned = 0;
};

/// Sets up and bins whole triangles, a vector of them at a time.
/// vertices  of the patch, by local number
void setupTriangles(const ScreenVertex* vertices, const PatchTriangles& triangles, Binner& binner, SetupCounts& counts);

/// The same, one by one; the plain reference.
void setupTrianglesReference(const ScreenVertex* vertices, const PatchTriangles& triangles, Binner& binner,
                             SetupCounts& counts);

/// One corner of a piece of a clipped triangle.
struct ScreenCorner {
  std::int32_t x_fx, y_fx;
  float depth;
};

/// Bins a piece of a clipped triangle whose ShadeTriangle (`shade`) exists already. Returns the sign of its area: 0
/// means that it was dropped; a back-facing piece is dropped only when culled. counts as for whole triangles.
int setupClippedPiece(const std::array<ScreenCorner, 3>& corners, const Facing& facing, std::uint32_t shade,
                      Binner& binner, SetupCounts& counts);

}  // namespace sheaf::raster
