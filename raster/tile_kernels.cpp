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
  alignas(64) std::int32_t lane_column[kMaxLanes];  // of the first vector
  alignas(64) std::int32_t lane_row[kMaxLanes];
};
constexpr BlockOffsets MakeBlockOffsets() {
  BlockOffsets offsets{};
  for (int p = 0; p < kBlockPixels; ++p) {
    offsets.column[p] = static_cast<float>(p % kBlockSize);
    offsets.row[p] = static_cast<float>(p / kBlockSize);
  }
  for (int lane = 0; lane < static_cast<int>(kMaxLanes); ++lane) {
    offsets.lane_column[lane] = lane % kBlockSize;
    offsets.lane_row[lane] = lane / kBlockSize;
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
  for (const PixelEdge& edge : triangle.edges) {
    const std::int64_t at_tile = edge.at(x0 - triangle.ref_x, y0 - triangle.ref_y);
    if (at_tile + edge.riseOver(kTileSize) < 0) return false;
    if (at_tile + edge.fallOver(kTileSize) >= 0) continue;  // the whole tile is inside this edge
    edges.a[edges.count] = edge.a;
    edges.b[edges.count] = edge.b;
    edges.c[edges.count] = static_cast<std::int32_t>(at_tile);
    ++edges.count;
  }
  return true;
}

// Pixels of the tile that the triangle may cover, both ends included.
struct TileBox {
  int x_min, y_min, x_max, y_max;
};

TileBox BoxInTile(const LargeTriangle& triangle, int x0, int y0) {
  return {std::max(triangle.ref_x - x0, 0), std::max(triangle.ref_y - y0, 0),
          std::min(triangle.last_x - x0, kTileSize - 1), std::min(triangle.last_y - y0, kTileSize - 1)};
}

// One bit per block, in memory order: the blocks under the box.
std::uint64_t BlocksUnder(const TileBox& box) {
  static_assert(kBlocksPerTileSide == 8);
  const unsigned columns = (0xFFU << (box.x_min / kBlockSize)) & (0xFFU >> (7 - box.x_max / kBlockSize));
  const int first_row = box.y_min / kBlockSize;
  const int last_row = box.y_max / kBlockSize;
  const std::uint64_t rows = (~std::uint64_t{0} << (8 * first_row)) & (~std::uint64_t{0} >> (8 * (7 - last_row)));
  return (columns * 0x0101010101010101U) & rows;
}

// Which blocks some edge leaves wholly out, and which all edges leave wholly in.
struct BlockMasks {
  std::uint64_t touched;
  std::uint64_t full;
};

std::uint64_t SignBits(VI v) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(di, hn::Lt(v, hn::Zero(di)), bits);
  return bits[0] | std::uint64_t{bits[1]} << 8;
}

BlockMasks ClassifyBlocks(const TileEdges& edges) {
  const auto lanes = static_cast<int>(hn::Lanes(di));
  std::uint64_t outside = 0;
  std::uint64_t partial = 0;
  for (int block = 0; block < kBlocksPerTile; block += lanes) {
    const VI index = hn::Iota(di, block);
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
    outside |= SignBits(rejected) << block;
    partial |= SignBits(crossed) << block;
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

// Change of an edge from the first pixel of a vector to its others: the same for every vector of a block.
HWY_INLINE VI EdgeLanes(std::int32_t a, std::int32_t b) {
  // hn::Iota goes through memory, lane by lane: too slow here.
  const VI column = hn::Load(di, kBlockOffsets.lane_column);
  const VI row = hn::Load(di, kBlockOffsets.lane_row);
  return hn::Add(hn::Mul(hn::Set(di, a), column), hn::Mul(hn::Set(di, b), row));
}

// What does not change from block to block. The kernels below write 32-bit words, which might be these as far as the
// compiler knows: loops work on copies in registers.
struct TriangleInTile {
  const LargeTriangle& triangle;
  const TileEdges& edges;
  int x0, y0;  // the tile's first pixel from the triangle's reference pixel
};

// Pixels with numbers [begin, end) of a block, whole vectors of them.
struct BlockPixels {
  int x, y;  // the block's first pixel, from the tile's
  int begin, end;
};

// Draws those of the pixels that N edges (with their EdgeLanes()) leave covered; returns a depth that none of them is
// behind.
template <int N>
HWY_INLINE VF DrawPixels(const TriangleInTile& in, VI lanes0, VI lanes1, VI lanes2, const BlockPixels& pixels,
                         TileState& state) {
  // A vector is a piece of a row or a few whole rows: edges and depths move on by a row, or a few, at a time.
  constexpr int kLanes = static_cast<int>(hn::MaxLanes(di));
  constexpr int kColumns = std::min(kLanes, kBlockSize);
  constexpr int kRows = kLanes / kColumns;
  const TileEdges edges = in.edges;
  const DepthPlane& plane = in.triangle.depth;
  const VF dzdx = hn::Set(df, plane.dzdx);
  const VF dzdy = hn::Set(df, plane.dzdy);
  const VF lo = hn::Set(df, plane.lo);
  const VF hi = hn::Set(df, plane.hi);
  const VF rows = hn::Set(df, static_cast<float>(kRows));
  const VI step0 = hn::Set(di, N > 0 ? edges.b[0] * kRows : 0);
  const VI step1 = hn::Set(di, N > 1 ? edges.b[1] * kRows : 0);
  const VI step2 = hn::Set(di, N > 2 ? edges.b[2] * kRows : 0);
  const std::uint32_t shade = in.triangle.shade;
  const int block = pixels.y * kTileSize + pixels.x * kBlockSize;  // number of the block's first pixel in the tile
  const int first_row = pixels.begin / kBlockSize;

  VF deepest = hn::Set(df, 1.0F);
  for (int column = 0; column < kBlockSize; column += kColumns) {
    const auto edge_at_first = [&](int i, VI lanes) HWY_ATTR {
      const std::int32_t at = edges.c[i] + edges.a[i] * (pixels.x + column) + edges.b[i] * (pixels.y + first_row);
      return hn::Add(hn::Set(di, at), lanes);
    };
    VI e0 = N > 0 ? edge_at_first(0, lanes0) : hn::Zero(di);
    VI e1 = N > 1 ? edge_at_first(1, lanes1) : hn::Zero(di);
    VI e2 = N > 2 ? edge_at_first(2, lanes2) : hn::Zero(di);
    const VF dx =
        hn::Add(hn::Set(df, static_cast<float>(in.x0 + pixels.x + column)), hn::Load(df, kBlockOffsets.column));
    VF dy = hn::Add(hn::Set(df, static_cast<float>(in.y0 + pixels.y + first_row)), hn::Load(df, kBlockOffsets.row));
    const VF z_column = hn::Add(hn::Set(df, plane.z), hn::Mul(dzdx, dx));
    for (int p = pixels.begin + column; p < pixels.end; p += kRows * kBlockSize) {
      VI outside = e0;
      if (N > 1) outside = hn::Or(outside, e1);
      if (N > 2) outside = hn::Or(outside, e2);
      const VF z = hn::Min(hn::Max(hn::Add(z_column, hn::Mul(dzdy, dy)), lo), hi);
      const auto covered = hn::RebindMask(df, hn::Not(hn::Lt(outside, hn::Zero(di))));
      deepest = hn::Min(deepest, WriteVector(z, covered, shade, block + p, state));
      if (N > 0) e0 = hn::Add(e0, step0);
      if (N > 1) e1 = hn::Add(e1, step1);
      if (N > 2) e2 = hn::Add(e2, step2);
      dy = hn::Add(dy, rows);
    }
  }
  return deepest;
}

// Triangles within a few blocks: every vector under the box is tested against all edges.
void DrawMedium(const TriangleInTile& in, const TileBox& box, TileState& state) {
  constexpr int rows = std::max(1, static_cast<int>(hn::MaxLanes(di)) / kBlockSize);
  const VI lanes0 = EdgeLanes(in.edges.a[0], in.edges.b[0]);
  const VI lanes1 = EdgeLanes(in.edges.a[1], in.edges.b[1]);
  const VI lanes2 = EdgeLanes(in.edges.a[2], in.edges.b[2]);
  for (int y = box.y_min & ~7; y <= box.y_max; y += kBlockSize) {
    const int begin = (std::max(box.y_min - y, 0) * kBlockSize) & ~(rows * kBlockSize - 1);
    const int end = (std::min(box.y_max - y, kBlockSize - 1) + 1) * kBlockSize;
    for (int x = box.x_min & ~7; x <= box.x_max; x += kBlockSize)
      if (!(in.triangle.depth.hi < state.farthest[y + x / kBlockSize]))
        DrawPixels<3>(in, lanes0, lanes1, lanes2, {x, y, begin, end}, state);
  }
}

// Triangles over many blocks: blocks are sorted out first.
template <int N>
void DrawBig(const TriangleInTile& in, const TileBox& box, TileState& state) {
  const BlockMasks blocks = ClassifyBlocks(in.edges);
  const VI lanes0 = N > 0 ? EdgeLanes(in.edges.a[0], in.edges.b[0]) : hn::Zero(di);
  const VI lanes1 = N > 1 ? EdgeLanes(in.edges.a[1], in.edges.b[1]) : hn::Zero(di);
  const VI lanes2 = N > 2 ? EdgeLanes(in.edges.a[2], in.edges.b[2]) : hn::Zero(di);
  for (std::uint64_t rest = blocks.touched & BlocksUnder(box); rest != 0; rest &= rest - 1) {
    const int block = std::countr_zero(rest);
    if (in.triangle.depth.hi < state.farthest[block]) continue;
    const BlockPixels pixels{(block % kBlocksPerTileSide) * kBlockSize, (block / kBlocksPerTileSide) * kBlockSize, 0,
                             kBlockPixels};
    const bool full = (blocks.full >> block & 1U) != 0;
    const VF deepest = full ? DrawPixels<0>(in, lanes0, lanes1, lanes2, pixels, state)
                            : DrawPixels<N>(in, lanes0, lanes1, lanes2, pixels, state);
    state.farthest[block] = hn::GetLane(hn::MinOfLanes(df, deepest));
  }
}

// Below 32 pixels per side every vector is tested; beyond, sorting out blocks pays.
constexpr std::int32_t kMediumExtent = 32 * kSubpixels;

// By its edges, not by its pixels: those may be few because the target ends there.
bool IsMedium(const LargeTriangle& triangle) {
  static_assert(std::has_single_bit(static_cast<unsigned>(kMediumExtent)));
  std::uint32_t beyond = 0;
  for (const PixelEdge& edge : triangle.edges)
    beyond |= static_cast<std::uint32_t>(edge.a + kMediumExtent) | static_cast<std::uint32_t>(edge.b + kMediumExtent);
  return beyond < 2 * kMediumExtent;
}

// Edges of a triangle of medium size: 32 bits are enough anywhere in a tile that it touches.
TileEdges EdgesOfMedium(const LargeTriangle& triangle, int x0, int y0) {
  TileEdges edges;
  edges.count = 3;
  for (int i = 0; i < 3; ++i) {
    const PixelEdge& edge = triangle.edges[i];
    edges.a[i] = edge.a;
    edges.b[i] = edge.b;
    edges.c[i] = static_cast<std::int32_t>(edge.c) + edge.a * (x0 - triangle.ref_x) + edge.b * (y0 - triangle.ref_y);
  }
  return edges;
}

void DrawLarge(const LargeTriangle& triangle, int x0, int y0, TileState& state) {
  const TileBox box = BoxInTile(triangle, x0, y0);
  const int x_from_ref = x0 - triangle.ref_x;
  const int y_from_ref = y0 - triangle.ref_y;
  if (IsMedium(triangle)) {
    DrawMedium({triangle, EdgesOfMedium(triangle, x0, y0), x_from_ref, y_from_ref}, box, state);
    return;
  }
  TileEdges edges;
  if (!EdgesInTile(triangle, x0, y0, edges)) return;
  const TriangleInTile in{triangle, edges, x_from_ref, y_from_ref};
  switch (edges.count) {
    case 0:
      return DrawBig<0>(in, box, state);
    case 1:
      return DrawBig<1>(in, box, state);
    case 2:
      return DrawBig<2>(in, box, state);
    default:
      return DrawBig<3>(in, box, state);
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
