// raster/tile: resolves which triangle is seen at every pixel of a tile.
#pragma once

#include <cstdint>
#include <span>

#include "raster/bins.h"
#include "raster/screen.h"

namespace sheaf::raster {

/// The entries of one tile: for each worker the head of its list and the large triangles that they refer to.
struct TileEntries {
  const Binner::Chunk* chunks;  ///< may be null
  const LargeTriangle* large;
};

/// Draws all entries into `out`, which is cleared first, for the tile whose top left pixel is (x0, y0). The result does
/// not depend on the order of entries: the nearest wins, and of equal depths the lower (surface, triangle). triangles
/// the frame's ShadeTriangles, read only to settle equal depths Pixels beyond the target's edge (the tile may reach
/// over it) may be drawn or not.
void rasterTile(std::span<const TileEntries> entries, const ShadeTriangle* triangles, int x0, int y0,
                TileVisibility& out);

}  // namespace sheaf::raster
