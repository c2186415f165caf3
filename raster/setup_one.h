// raster/setup_one: what the plain and the vectorised set-up share: the pixels of a box, and the set-up of one
// triangle, to which kernels leave what does not fit their 32 bits.
#pragma once

#include <cstdint>

#include "raster/setup.h"

namespace sheaf::raster {

/// Pixels whose centres may be covered, both ends included, within the target; empty when min > max.
struct PixelBox {
  int x_min, y_min, x_max, y_max;
};

/// Triangles within this many pixels per side carry their coverage as a mask.
inline constexpr int kSmallSize = 4;

inline bool isSmall(const PixelBox& box) {
  return box.x_max - box.x_min < kSmallSize && box.y_max - box.y_min < kSmallSize;
}

PixelBox pixelBox(const std::int32_t (&x_fx)[3], const std::int32_t (&y_fx)[3], int width, int height);

/// (v1 - v0) x (v2 - v0): twice the signed area, in squares of a subpixel.
std::int64_t doubleArea(const std::int32_t (&x_fx)[3], const std::int32_t (&y_fx)[3]);

/// Sets up and bins triangle `t` of the patch.
void setupOne(const ScreenVertex* vertices, const PatchTriangles& triangles, std::uint32_t t, Binner& binner,
              SetupCounts& counts);

}  // namespace sheaf::raster
