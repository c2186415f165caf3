#include "raster/bins.h"

#include <algorithm>
#include <cstdlib>
#include <new>

namespace sheaf::raster {

void ShadeTriangleArena::Free::operator()(ShadeTriangle* p) const {
  std::free(p);
}

bool ShadeTriangleArena::reset(std::uint64_t triangles, int workers) {
  // Each worker may leave one run unfinished.
  const std::uint64_t needed = triangles + std::uint64_t{kRun} * static_cast<std::uint64_t>(workers);
  if (needed > kMaxTriangles) return false;
  next_ = 0;
  if (needed <= capacity_) return true;
  capacity_ = std::max<std::size_t>(needed, capacity_ + capacity_ / 2);
  triangles_.reset();
  triangles_.reset(
      static_cast<ShadeTriangle*>(std::aligned_alloc(alignof(ShadeTriangle), capacity_ * sizeof(ShadeTriangle))));
  if (!triangles_) throw std::bad_alloc();
  return true;
}

void Binner::reset(int width, int height, ShadeTriangleArena& arena) {
  arena_ = &arena;
  run_next_ = run_end_ = 0;
  width_ = width;
  height_ = height;
  tiles_x_ = (width + kTileSize - 1) / kTileSize;
  tiles_y_ = (height + kTileSize - 1) / kTileSize;
  const auto tiles = static_cast<std::size_t>(tiles_x_) * static_cast<std::size_t>(tiles_y_);
  heads_.assign(tiles, nullptr);
  tails_.assign(tiles, nullptr);
  large_.clear();
  chunks_used_ = 0;
  entry_count_ = 0;
}

Binner::Chunk* Binner::newChunk() {
  const std::size_t slab = chunks_used_ / kChunksPerSlab;
  if (slab == slabs_.size()) slabs_.push_back(std::make_unique_for_overwrite<Chunk[]>(kChunksPerSlab));
  Chunk* chunk = &slabs_[slab][chunks_used_++ % kChunksPerSlab];
  chunk->next = nullptr;
  chunk->count = 0;
  return chunk;
}

void Binner::addStraddling(const BinEntry& entry) {
  // Columns and rows of the 4x4 that lie before the tile border; the border may lie at 1..4 of them.
  const int tile_x = entry.x / kTileSize;
  const int tile_y = entry.y / kTileSize;
  const int columns = std::min(4, (tile_x + 1) * kTileSize - entry.x);
  const int rows = std::min(4, (tile_y + 1) * kTileSize - entry.y);
  const unsigned left = ((1U << columns) - 1U) * 0x1111U;
  const unsigned top = (1U << (4 * rows)) - 1U;
  for (int part = 0; part < 4; ++part) {
    const unsigned mask = entry.mask & ((part & 1) ? ~left : left) & ((part & 2) ? ~top : top);
    if (mask == 0) continue;
    BinEntry& e = append((tile_y + (part >> 1)) * tiles_x_ + tile_x + (part & 1));
    e = entry;
    e.mask = static_cast<std::uint16_t>(mask);
  }
}

void Binner::addLarge(const LargeTriangle& triangle) {
  BinEntry entry{};
  entry.index = static_cast<std::uint32_t>(large_.size());
  large_.push_back(triangle);
  const int tx0 = triangle.ref_x / kTileSize;
  const int tx1 = triangle.last_x / kTileSize;
  const int ty0 = triangle.ref_y / kTileSize;
  const int ty1 = triangle.last_y / kTileSize;
  if (tx0 == tx1 && ty0 == ty1) {
    append(ty0 * tiles_x_ + tx0) = entry;
    return;
  }
  for (int ty = ty0; ty <= ty1; ++ty)
    for (int tx = tx0; tx <= tx1; ++tx) {
      const int x = tx * kTileSize - triangle.ref_x;
      const int y = ty * kTileSize - triangle.ref_y;
      bool outside = false;
      for (const PixelEdge& edge : triangle.edges) outside |= edge.at(x, y) + edge.riseOver(kTileSize) < 0;
      if (!outside) append(ty * tiles_x_ + tx) = entry;
    }
}

}  // namespace sheaf::raster
