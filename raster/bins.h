// raster/bins: which triangles touch which tile. Every worker has a Binner of its own, so nothing is locked.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "raster/edges.h"
#include "raster/screen.h"

namespace sheaf::raster {

/// Depth over the screen: clamp((z + dzdx * dx) + dzdy * dy, lo, hi), dx and dy whole pixels from a reference pixel.
/// Every path evaluates it in this order of operations, so depths are equal to the bit. The clamp keeps the rounding of
/// steep slivers within the range of the triangle's corners.
struct DepthPlane {
  float z, dzdx, dzdy;
  float lo, hi;
};

/// A triangle as one tile sees it. Small ones, within 4x4 pixels, carry their exact coverage.
struct BinEntry {
  std::int16_t x, y;   ///< reference pixel: top left of the 4x4 pixels
  std::uint16_t mask;  ///< bit 4 * row + column; 0: `index` names a LargeTriangle instead
  std::uint16_t unused;
  DepthPlane depth;
  std::uint32_t index;  ///< a ShadeTriangle, or a LargeTriangle of the same worker
};
static_assert(sizeof(BinEntry) == 32);

/// A triangle that needs its edges, which are relative to the reference pixel.
struct LargeTriangle {
  PixelEdge edges[3];
  std::int16_t ref_x, ref_y;    ///< reference pixel: top left of the pixels that it may cover
  std::int16_t last_x, last_y;  ///< bottom right of them, included; within the target
  DepthPlane depth;
  std::uint32_t shade;  ///< ShadeTriangle
};

/// The frame's ShadeTriangles: one array, so that kernels can gather from it; workers claim runs of it.
class ShadeTriangleArena {
 public:
  static constexpr std::uint32_t kRun = 1024;
  /// Kernels gather with signed 32-bit offsets of 4-byte words, 16 to a triangle.
  static constexpr std::uint32_t kMaxTriangles = 1U << 27;

  /// Makes room for `triangles` spread over `workers`; what was there is lost. Memory is kept for the next frame and
  /// touched only as far as it is used. Returns false when there would be more than kMaxTriangles.
  bool reset(std::uint64_t triangles, int workers);

  std::uint32_t claimRun() { return next_.fetch_add(kRun, std::memory_order_relaxed); }
  ShadeTriangle* data() { return triangles_.get(); }
  const ShadeTriangle* data() const { return triangles_.get(); }
  std::size_t capacity() const { return capacity_; }

 private:
  struct Free {
    void operator()(ShadeTriangle* p) const;
  };
  std::unique_ptr<ShadeTriangle[], Free> triangles_;
  std::size_t capacity_ = 0;
  std::atomic<std::uint32_t> next_{0};
};

/// One worker's bins: per tile a list of entries in blocks.
class Binner {
 public:
  struct Chunk {
    static constexpr int kEntries = 31;
    Chunk* next;
    int count;
    BinEntry entries[kEntries];
  };

  /// Empties all bins for a frame of width x height pixels.
  void reset(int width, int height, ShadeTriangleArena& arena);

  int width() const { return width_; }
  int height() const { return height_; }
  int tilesX() const { return tiles_x_; }
  int tilesY() const { return tiles_y_; }

  /// A slot for a triangle that will be binned.
  std::uint32_t newShadeTriangle() {
    if (run_next_ == run_end_) {
      run_next_ = arena_->claimRun();
      run_end_ = run_next_ + ShadeTriangleArena::kRun;
    }
    return run_next_++;
  }
  ShadeTriangle& shadeTriangle(std::uint32_t index) { return arena_->data()[index]; }

  /// entry.mask is not 0 and covers no pixel beyond the target.
  void addSmall(const BinEntry& entry) {
    const int tile_x = entry.x / kTileSize;
    const int tile_y = entry.y / kTileSize;
    const bool straddles = (entry.x + 3) / kTileSize != tile_x || (entry.y + 3) / kTileSize != tile_y;
    if (straddles) {
      addStraddling(entry);
    } else {
      append(tile_y * tiles_x_ + tile_x) = entry;
    }
  }

  /// Adds the triangle to every tile that it may touch.
  void addLarge(const LargeTriangle& triangle);

  const Chunk* tile(int index) const { return heads_[static_cast<std::size_t>(index)]; }
  const LargeTriangle* largeTriangles() const { return large_.data(); }
  std::uint64_t entryCount() const { return entry_count_; }

 private:
  void addStraddling(const BinEntry& entry);
  Chunk* newChunk();
  BinEntry& append(int tile) {
    ++entry_count_;
    Chunk*& tail = tails_[static_cast<std::size_t>(tile)];
    if (tail == nullptr || tail->count == Chunk::kEntries) {
      Chunk* chunk = newChunk();
      (tail == nullptr ? heads_[static_cast<std::size_t>(tile)] : tail->next) = chunk;
      tail = chunk;
    }
    return tail->entries[tail->count++];
  }

  static constexpr std::size_t kChunksPerSlab = 256;

  ShadeTriangleArena* arena_ = nullptr;
  std::uint32_t run_next_ = 0;
  std::uint32_t run_end_ = 0;
  std::vector<Chunk*> heads_;  // by tile; null = empty
  std::vector<Chunk*> tails_;
  std::vector<LargeTriangle> large_;
  std::vector<std::unique_ptr<Chunk[]>> slabs_;
  std::size_t chunks_used_ = 0;
  std::uint64_t entry_count_ = 0;
  int width_ = 0;
  int height_ = 0;
  int tiles_x_ = 0;
  int tiles_y_ = 0;
};

}  // namespace sheaf::raster
