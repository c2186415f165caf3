// Random triangles, drawn by the raster, and a plain rasterizer to compare with that shares nothing with it but the
// conventions of raster/screen.h.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "core/image.h"
#include "raster/bins.h"
#include "raster/setup.h"
#include "raster/tile.h"

namespace sheaf::raster {

/// Up to 256 vertices and any number of triangles, in the arrays that the raster takes.
struct TriangleSoup {
  std::vector<std::int32_t> x_fx, y_fx;
  std::vector<float> depth, inv_w;
  std::array<std::vector<std::uint8_t>, 3> corner;
  std::vector<std::uint32_t> source;

  std::uint8_t addVertex(std::int32_t x, std::int32_t y, float z, float vertex_inv_w = 1.0F) {
    x_fx.push_back(x);
    y_fx.push_back(y);
    depth.push_back(z);
    inv_w.push_back(vertex_inv_w);
    return static_cast<std::uint8_t>(x_fx.size() - 1);
  }
  void addTriangle(std::uint8_t a, std::uint8_t b, std::uint8_t c) {
    source.push_back(static_cast<std::uint32_t>(source.size()));
    corner[0].push_back(a);
    corner[1].push_back(b);
    corner[2].push_back(c);
  }
  std::size_t size() const { return source.size(); }

  std::vector<ScreenVertex> vertices() const {
    std::vector<ScreenVertex> out;
    for (std::size_t i = 0; i < x_fx.size(); ++i) out.push_back({x_fx[i], y_fx[i], depth[i], inv_w[i]});
    return out;
  }
};

using SetupFunction = void (*)(const ScreenVertex*, const PatchTriangles&, Binner&, SetupCounts&);

/// A frame of bins.
struct BinnedFrame {
  ShadeTriangleArena arena;
  Binner binner;
  SetupCounts counts;

  BinnedFrame(int width, int height, std::size_t max_triangles) {
    arena.reset(max_triangles, 1);
    binner.reset(width, height, arena);
  }

  void draw(TriangleSoup soup, SetupFunction setup, Facing facing = {-1, false}, std::uint32_t surface = 0) {
    PatchTriangles triangles;
    triangles.count = static_cast<std::uint32_t>(soup.size());
    triangles.source = soup.source.data();
    triangles.surface = surface;
    triangles.facing = facing;
    for (std::size_t i = 0; i < 3; ++i) {
      soup.corner[i].resize((soup.size() + 15) / 16 * 16 + 16, 0);
      triangles.corner[i] = soup.corner[i].data();
    }
    setup(soup.vertices().data(), triangles, binner, counts);
  }

  /// Number of the triangle seen at each pixel, kNoTriangle where none is.
  ImageU32 resolve() {
    ImageU32 image(binner.width(), binner.height(), kNoTriangle);
    static TileVisibility tile;
    for (int i = 0; i < binner.tilesX() * binner.tilesY(); ++i) {
      const int x0 = i % binner.tilesX() * kTileSize;
      const int y0 = i / binner.tilesX() * kTileSize;
      const TileEntries entries[] = {{binner.tile(i), binner.largeTriangles()}};
      rasterTile(entries, arena.data(), x0, y0, tile);
      for (int y = y0; y < std::min(y0 + kTileSize, image.height()); ++y)
        for (int x = x0; x < std::min(x0 + kTileSize, image.width()); ++x) {
          const std::uint32_t seen = tile.triangle[tileIndex(x - x0, y - y0)];
          if (seen != kNoTriangle) image.at(x, y) = arena.data()[seen].triangle;
        }
    }
    return image;
  }
};

/// A sample on an edge belongs to the triangle into which it falls when it moves a little to the right and very much
/// less down: that is the top-left rule.
inline bool coversReference(const TriangleSoup& soup, std::size_t t, int px, int py) {
  using Wide = std::int64_t;
  const std::size_t v[3] = {soup.corner[0][t], soup.corner[1][t], soup.corner[2][t]};
  const auto cross = [](Wide ax, Wide ay, Wide bx, Wide by) { return ax * by - ay * bx; };
  const Wide area = cross(soup.x_fx[v[1]] - soup.x_fx[v[0]], soup.y_fx[v[1]] - soup.y_fx[v[0]],
                          soup.x_fx[v[2]] - soup.x_fx[v[0]], soup.y_fx[v[2]] - soup.y_fx[v[0]]);
  if (area == 0) return false;
  for (int i = 0; i < 3; ++i) {
    const std::size_t from = v[i];
    const std::size_t to = v[(i + 1) % 3];
    const Wide ex = soup.x_fx[to] - soup.x_fx[from];
    const Wide ey = soup.y_fx[to] - soup.y_fx[from];
    const Wide side = cross(ex, ey, Wide{px} * kSubpixels + kSubpixels / 2 - soup.x_fx[from],
                            Wide{py} * kSubpixels + kSubpixels / 2 - soup.y_fx[from]);
    // Moving right changes the side by -ey, moving down by ex.
    const Wide decisive = side != 0 ? side : ey != 0 ? -ey : ex;
    if ((decisive > 0) != (area > 0)) return false;
  }
  return true;
}

/// Vertices spread over the target and beyond, at `spread` pixels around random places.
inline TriangleSoup randomSoup(std::mt19937& rng, int width, int height, double spread_px, int triangles,
                               bool flat_depth) {
  TriangleSoup soup;
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int t = 0; t < triangles; ++t) {
    const double cx = (unit(rng) * 1.2 - 0.1) * width;
    const double cy = (unit(rng) * 1.2 - 0.1) * height;
    const auto z = static_cast<float>(static_cast<int>(unit(rng) * 8.0)) / 8.0F;
    std::uint8_t v[3];
    for (std::uint8_t& corner : v) {
      // Half of the corners lie exactly on sample positions or pixel borders, where the rules matter.
      double x = (cx + (unit(rng) - 0.5) * spread_px) * kSubpixels;
      double y = (cy + (unit(rng) - 0.5) * spread_px) * kSubpixels;
      if (unit(rng) < 0.5) {
        x = std::floor(x / 128.0) * 128.0;
        y = std::floor(y / 128.0) * 128.0;
      }
      corner = soup.addVertex(static_cast<std::int32_t>(x), static_cast<std::int32_t>(y),
                              flat_depth ? z : static_cast<float>(unit(rng)), static_cast<float>(0.1 + unit(rng)));
    }
    soup.addTriangle(v[0], v[1], v[2]);
  }
  return soup;
}

}  // namespace sheaf::raster
