// raster/edges: exact edge functions in fixed point [Pin88].
//
// For corners in the order of positive area and edge i opposite corner i, from corner j = i + 1 to k = i + 2,
//   E_i(p) = (v_k - v_j) x (p - v_j) = a_i (p.x - x_j) + b_i (p.y - y_j),  a_i = y_j - y_k,  b_i = x_k - x_j
// is positive inside. A sample on the edge counts when the edge is a left one (a > 0) or a top one (a = 0, b > 0): -1
// is added to E on all others, and inside means E >= 0.
#pragma once

#include <cstdint>

#include "raster/screen.h"

namespace sheaf::raster {

// Corners lie within the guard band around the target's centre, so a difference of two is at most 2^23 and fits a
// float.
inline constexpr std::int64_t kMaxDelta = (2LL * kGuardBandPx) << kSubpixelBits;
static_assert(kMaxDelta <= (1 << 23));

/// An edge at pixel centres, floor-divided by 2^8: E(x, y) >= 0 exactly where at(x, y) = c + a * x + b * y >= 0,
/// because from centre to centre E moves in steps of 2^8 a and 2^8 b. x and y in whole pixels.
struct PixelEdge {
  std::int32_t a;
  std::int32_t b;
  std::int64_t c;

  std::int64_t at(std::int64_t x, std::int64_t y) const { return c + a * x + b * y; }
  /// Largest and smallest change over a square of `size` pixels per side, from its top left pixel.
  std::int64_t riseOver(int size) const {
    return (a > 0 ? std::int64_t{a} * (size - 1) : 0) + (b > 0 ? std::int64_t{b} * (size - 1) : 0);
  }
  std::int64_t fallOver(int size) const {
    return (a < 0 ? std::int64_t{a} * (size - 1) : 0) + (b < 0 ? std::int64_t{b} * (size - 1) : 0);
  }
};

// An edge that crosses a tile is, anywhere in the tile, below its change over the tile: |at| < 64 * (|a| + |b|) < 2^31.
static_assert(2 * kMaxDelta * kTileSize <= (1LL << 30));

/// Edge i of a triangle of positive area, relative to the pixel (ref_x, ref_y).
inline PixelEdge pixelEdge(const std::int32_t (&x_fx)[3], const std::int32_t (&y_fx)[3], int i, int ref_x, int ref_y) {
  const int j = i == 2 ? 0 : i + 1;
  const int k = i == 0 ? 2 : i - 1;
  const std::int32_t a = y_fx[j] - y_fx[k];
  const std::int32_t b = x_fx[k] - x_fx[j];
  const bool top_left = a > 0 || (a == 0 && b > 0);
  const std::int64_t at_ref = std::int64_t{a} * (ref_x * kSubpixels + kSubpixels / 2 - x_fx[j]) +
                              std::int64_t{b} * (ref_y * kSubpixels + kSubpixels / 2 - y_fx[j]);
  return {a, b, (at_ref - (top_left ? 0 : 1)) >> kSubpixelBits};
}

}  // namespace sheaf::raster
