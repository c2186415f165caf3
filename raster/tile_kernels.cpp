#include <algorithm>
#include <bit>

#include "raster/edges.h"
#include "raster/tile.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/tile_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sheaf::raster::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kMaxLanes = 16;
const hn::CappedTag<std::int32_t, kMaxLanes> di;
const hn::RebindToFloat<decltype(di)> df;
const hn::RebindToUnsigned<decltype(di)> du;
using VI = hn::Vec<decltype(di)>;
using VF = hn::Vec<decltype(df)>;

// Column and row of the pixels of a block in memory order.
struct BlockOffsets {
  alignas(64) float column[kBlockPixels];
  alignas(64) float row[kBlockPixels];
};
constexpr BlockOffsets MakeBlockOffsets() {
  BlockOffsets offsets{};
  for (int p = 0; p < kBlockPixels; ++p) {
    offsets.column[p] = static_cast<float>(p % kBlockSize);
    offsets.row[p] = static_cast<float>(p / kBlockSize);
  }
  return offsets;
}
constexpr BlockOffsets kBlockOffsets = MakeBlockOffsets();

// The tile being drawn: visibility, and per block a depth that nothing in the block is behind.
struct TileState {
  TileVisibility* visibility;
  const ShadeTriangle* triangles;
  float farthest[kBlocksPerTile];
};

// Of two triangles at equal depth the lower (surface, triangle) is seen.
bool WinsTie(const ShadeTriangle* triangles, std::uint32_t candidate, std::uint32_t present) {
  if (present == kNoTriangle) return true;
  const ShadeTriangle& a = triangles[candidate];
  const ShadeTriangle& b = triangles[present];
  return a.surface != b.surface ? a.surface < b.surface : a.triangle < b.triangle;
}

void DrawSmall(const BinEntry& entry, int x0, int y0, TileState& state) {
  float* depth = state.visibility->depth;
  std::uint32_t* triangle = state.visibility->triangle;
  const int x = entry.x - x0;
  const int y = entry.y - y0;
  for (unsigned rest = entry.mask; rest != 0; rest &= rest - 1) {
    const int bit = std::countr_zero(rest);
    const int dx = bit & 3;
    const int dy = bit >> 2;
    float z = (entry.depth.z + entry.depth.dzdx * static_cast<float>(dx)) + entry.depth.dzdy * static_cast<float>(dy);
    z = std::min(std::max(z, entry.depth.lo), entry.depth.hi);
    const int p = tileIndex(x + dx, y + dy);
    if (z < depth[p] || (z == depth[p] && !WinsTie(state.triangles, entry.index, triangle[p]))) continue;
    depth[p] = z;
    triangle[p] = entry.index;
  }
}

// Edges of a large triangle that cross the tile, at the tile's first pixel centre.
struct TileEdges {
  int count = 0;
  std::int32_t a[3], b[3], c[3];
};

// False: the triangle misses the tile.
bool EdgesInTile(const LargeTriangle& triangle, int x0, int y0, TileEdges& edges) {
  for (int i = 0; i < 3; ++i) {
    const PixelEdge edge = pixelEdge(triangle.x_fx, triangle.y_fx, i);
    const std::int64_t at_tile = edge.at(x0, y0);
    if (at_tile + edge.riseOver(kTileSize) < 0) return false;
    if (at_tile + edge.fallOver(kTileSize) >= 0) continue;  // the whole tile is inside this edge
    edges.a[edges.count] = edge.a;
    edges.b[edges.count] = edge.b;
    edges.c[edges.count] = static_cast<std::int32_t>(at_tile);
    ++edges.count;
  }
  return true;
}

// One bit per block, in memory order: which blocks some edge leaves wholly out, and which all edges leave wholly in.
struct BlockMasks {
  std::uint64_t touched;
  std::uint64_t full;
};

BlockMasks ClassifyBlocks(const TileEdges& edges) {
  const auto lanes = static_cast<int>(hn::Lanes(di));
  std::uint64_t outside = 0;
  std::uint64_t partial = 0;
  for (int block = 0; block < kBlocksPerTile; block += lanes) {
    const VI index = hn::Add(hn::Iota(di, block), hn::Zero(di));
    const VI x = hn::ShiftLeft<3>(hn::And(index, hn::Set(di, kBlocksPerTileSide - 1)));
    const VI y = hn::ShiftLeft<3>(hn::ShiftRight<3>(index));
    VI rejected = hn::Zero(di);
    VI crossed = hn::Zero(di);
    for (int i = 0; i < edges.count; ++i) {
      const std::int32_t rise = (std::max(edges.a[i], 0) + std::max(edges.b[i], 0)) * (kBlockSize - 1);
      const std::int32_t fall = (std::min(edges.a[i], 0) + std::min(edges.b[i], 0)) * (kBlockSize - 1);
      const VI e = hn::Add(hn::Set(di, edges.c[i]),
                           hn::Add(hn::Mul(hn::Set(di, edges.a[i]), x), hn::Mul(hn::Set(di, edges.b[i]), y)));
      rejected = hn::Or(rejected, hn::Add(e, hn::Set(di, rise)));
      crossed = hn::Or(crossed, hn::Add(e, hn::Set(di, fall)));
    }
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(di, hn::Lt(rejected, hn::Zero(di)), bits);
    outside |= (bits[0] | std::uint64_t{bits[1]} << 8) << block;
    std::uint8_t crossed_bits[8] = {};
    hn::StoreMaskBits(di, hn::Lt(crossed, hn::Zero(di)), crossed_bits);
    partial |= (crossed_bits[0] | std::uint64_t{crossed_bits[1]} << 8) << block;
  }
  return {~outside, ~outside & ~partial};
}

// Depth-tests and writes the pixels of a vector for which `covered` holds; returns the depths afterwards.
template <class M>
HWY_INLINE VF WriteVector(VF z, M covered, std::uint32_t index, int p, TileState& state) {
  float* depth = state.visibility->depth + p;
  std::uint32_t* triangle = state.visibility->triangle + p;
  const VF old = hn::Load(df, depth);
  auto wins = hn::And(covered, hn::Gt(z, old));
  const auto tied = hn::And(covered, hn::Eq(z, old));
  if (HWY_UNLIKELY(!hn::AllFalse(df, tied))) {
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(df, tied, bits);
    alignas(64) float lane_wins[kMaxLanes] = {};
    for (unsigned rest = bits[0] | static_cast<unsigned>(bits[1]) << 8; rest != 0; rest &= rest - 1) {
      const int lane = std::countr_zero(rest);
      if (WinsTie(state.triangles, index, triangle[lane])) lane_wins[lane] = 1.0F;
    }
    wins = hn::Or(wins, hn::Gt(hn::Load(df, lane_wins), hn::Zero(df)));
  }
  const VF now = hn::IfThenElse(wins, z, old);
  hn::Store(now, df, depth);
  const auto wins_u = hn::RebindMask(du, wins);
  hn::Store(hn::IfThenElse(wins_u, hn::Set(du, index), hn::Load(du, triangle)), du, triangle);
  return now;
}

void DrawLarge(const LargeTriangle& triangle, int x0, int y0, TileState& state) {
  TileEdges edges;
  if (!EdgesInTile(triangle, x0, y0, edges)) return;
  const BlockMasks blocks = ClassifyBlocks(edges);
  const auto lanes = static_cast<int>(hn::Lanes(di));

  // Change of each crossing edge from a block's first pixel to each of its pixels.
  alignas(64) std::int32_t edge_offsets[3][kBlockPixels];
  for (int i = 0; blocks.touched != blocks.full && i < edges.count; ++i)
    for (int p = 0; p < kBlockPixels; p += lanes) {
      const VI column = hn::ConvertTo(di, hn::Load(df, kBlockOffsets.column + p));
      const VI row = hn::ConvertTo(di, hn::Load(df, kBlockOffsets.row + p));
      hn::Store(hn::Add(hn::Mul(hn::Set(di, edges.a[i]), column), hn::Mul(hn::Set(di, edges.b[i]), row)), di,
                edge_offsets[i] + p);
    }

  const DepthPlane& plane = triangle.depth;
  const VF z_ref = hn::Set(df, plane.z);
  const VF dzdx = hn::Set(df, plane.dzdx);
  const VF dzdy = hn::Set(df, plane.dzdy);
  const VF lo = hn::Set(df, plane.lo);
  const VF hi = hn::Set(df, plane.hi);

  for (std::uint64_t rest = blocks.touched; rest != 0; rest &= rest - 1) {
    const int block = std::countr_zero(rest);
    const float farthest = state.farthest[block];
    if (plane.hi < farthest) continue;
    const int bx = (block % kBlocksPerTileSide) * kBlockSize;
    const int by = (block / kBlocksPerTileSide) * kBlockSize;
    const VF dx0 = hn::Set(df, static_cast<float>(x0 + bx - triangle.ref_x));
    const VF dy0 = hn::Set(df, static_cast<float>(y0 + by - triangle.ref_y));
    const auto depthOf = [&](int p) HWY_ATTR {
      const VF dx = hn::Add(dx0, hn::Load(df, kBlockOffsets.column + p));
      const VF dy = hn::Add(dy0, hn::Load(df, kBlockOffsets.row + p));
      const VF z = hn::Add(hn::Add(z_ref, hn::Mul(dzdx, dx)), hn::Mul(dzdy, dy));
      return hn::Min(hn::Max(z, lo), hi);
    };
    VF deepest = hn::Set(df, 1.0F);
    const int first = block * kBlockPixels;
    if ((blocks.full >> block & 1U) != 0) {
      const auto all = hn::Eq(z_ref, z_ref);
      for (int p = 0; p < kBlockPixels; p += lanes)
        deepest = hn::Min(deepest, WriteVector(depthOf(p), all, triangle.shade, first + p, state));
    } else {
      std::int32_t at_block[3];
      for (int i = 0; i < edges.count; ++i) at_block[i] = edges.c[i] + edges.a[i] * bx + edges.b[i] * by;
      for (int p = 0; p < kBlockPixels; p += lanes) {
        VI outside = hn::Zero(di);
        for (int i = 0; i < edges.count; ++i)
          outside = hn::Or(outside, hn::Add(hn::Set(di, at_block[i]), hn::Load(di, edge_offsets[i] + p)));
        const auto covered = hn::RebindMask(df, hn::Not(hn::Lt(outside, hn::Zero(di))));
        deepest = hn::Min(deepest, WriteVector(depthOf(p), covered, triangle.shade, first + p, state));
      }
    }
    state.farthest[block] = hn::GetLane(hn::MinOfLanes(df, deepest));
  }
}

void Clear(TileVisibility& tile) {
  const auto lanes = static_cast<int>(hn::Lanes(df));
  for (int p = 0; p < kTilePixels; p += lanes) {
    hn::Store(hn::Zero(df), df, tile.depth + p);
    hn::Store(hn::Set(du, kNoTriangle), du, tile.triangle + p);
  }
}

void RasterTile(std::span<const TileEntries> entries, const ShadeTriangle* triangles, int x0, int y0,
                TileVisibility& out) {
  Clear(out);
  TileState state{&out, triangles, {}};
  for (const TileEntries& list : entries)
    for (const Binner::Chunk* chunk = list.chunks; chunk != nullptr; chunk = chunk->next)
      for (int i = 0; i < chunk->count; ++i) {
        const BinEntry& entry = chunk->entries[i];
        if (entry.mask != 0)
          DrawSmall(entry, x0, y0, state);
        else
          DrawLarge(list.large[entry.index], x0, y0, state);
      }
}

}  // namespace sheaf::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sheaf::raster {
HWY_EXPORT(RasterTile);
void rasterTile(std::span<const TileEntries> entries, const ShadeTriangle* triangles, int x0, int y0,
                TileVisibility& out) {
  HWY_DYNAMIC_DISPATCH(RasterTile)(entries, triangles, x0, y0, out);
}
}  // namespace sheaf::raster
#endif
