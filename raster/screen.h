// raster: turns projected triangles into visible pixels and shades them.
//   In     triangles in 24.8 fixed point, x right, y down; pixel (0, 0) is top left, its centre at (0.5, 0.5);
//          clipped to the guard band; float depth, reversed: 1 nearest, 0 farthest
//   Out    per tile: the triangle and depth of every pixel; per frame: colour and the data channels asked for
//   Method bin to 64x64 tiles -> 8x8 block masks from exact edge functions [Pin88], top-left rule -> depth test against
//          a per-block farthest depth [GKM93] -> shade what is visible [BH13]
//   Keeps  same bytes for any SIMD target, thread count and order of triangles: coverage is exact integers, equal
//          depths go to the lower (instance, triangle), no float sum depends on order
//   Knows  no meshes and no scenes
#pragma once

#include <cstdint>

namespace sheaf::raster {

inline constexpr int kSubpixelBits = 8;
inline constexpr int kSubpixels = 1 << kSubpixelBits;
inline constexpr int kTileSize = 64;  ///< pixels per side
inline constexpr int kTilePixels = kTileSize * kTileSize;
inline constexpr int kBlockSize = 8;  ///< pixels per side
inline constexpr int kBlockPixels = kBlockSize * kBlockSize;
inline constexpr int kBlocksPerTileSide = kTileSize / kBlockSize;
inline constexpr int kBlocksPerTile = kBlocksPerTileSide * kBlocksPerTileSide;
inline constexpr int kMaxTargetSize = 16384;  ///< pixels per side
/// Vertices lie within this many pixels of the target's centre; what reaches farther is clipped.
inline constexpr int kGuardBandPx = 16384;

inline constexpr std::uint32_t kNoTriangle = 0xFFFFFFFFU;

/// Index within a tile of the pixel at (x, y) in [0, 64)^2. Blocks are contiguous, so that a vector of pixels is a
/// piece of one block: two rows for 16 lanes, one for 8, half a row for 4.
constexpr int tileIndex(int x, int y) {
  return ((y >> 3) * kBlocksPerTileSide + (x >> 3)) * kBlockPixels + (y & 7) * kBlockSize + (x & 7);
}

/// What shading needs to know of a triangle; one cache line. Pieces of a clipped triangle share one.
///
/// With (dx, dy) whole pixels from (ref_x, ref_y), u_i = u0[i] + ux[i] * dx + uy[i] * dy is the barycentric coordinate
/// of corner i divided by w, up to a factor common to all three [OG97]: the perspective-correct barycentrics at the
/// centre of that pixel are b_i = u_i / (u_0 + u_1 + u_2), their derivatives db_i/dx = (ux[i] - b_i * (ux[0] + ux[1] +
/// ux[2])) / sum.
struct alignas(64) ShadeTriangle {
  float u0[3];
  float ux[3];
  float uy[3];
  std::int16_t ref_x;
  std::int16_t ref_y;
  std::uint32_t
      vertex[3];  ///< into the surface's attribute arrays, in the mesh's order: counter-clockwise from the front
  std::uint32_t surface;    ///< into ShadeScene::surfaces
  std::uint32_t triangle;   ///< number of the triangle in its mesh
  std::uint32_t back_face;  ///< 1: seen from behind, its normal is turned round; 0: from the front
};
static_assert(sizeof(ShadeTriangle) == 64);

/// What is seen in one tile; both arrays are indexed by tileIndex().
struct alignas(64) TileVisibility {
  float depth[kTilePixels];             ///< reversed, 0 where nothing is
  std::uint32_t triangle[kTilePixels];  ///< into the frame's ShadeTriangles, or kNoTriangle
};

}  // namespace sheaf::raster
