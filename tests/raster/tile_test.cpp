#include "raster/tile.h"

#include <doctest/doctest.h>

#include "tests/raster/coverage_fixture.h"
#include "tests/simd_targets.h"

namespace sheaf::raster {
namespace {

// At equal depth everywhere within a triangle, the nearest covering one is seen, of equals the lowest number.
ImageU32 resolveReference(const TriangleSoup& soup, int width, int height) {
  ImageU32 image(width, height, kNoTriangle);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float nearest = -1.0F;
      for (std::size_t t = 0; t < soup.size(); ++t) {
        const float z = soup.depth[soup.corner[0][t]];
        if (z > nearest && coversReference(soup, t, x, y)) {
          nearest = z;
          image.at(x, y) = static_cast<std::uint32_t>(t);
        }
      }
    }
  return image;
}

std::size_t differing(const ImageU32& a, const ImageU32& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.pixels().size(); ++i) count += a.pixels()[i] != b.pixels()[i];
  return count;
}

}  // namespace

TEST_CASE("raster/tile: coverage, depth order and ties equal the plain rasterizer on every SIMD target") {
  std::mt19937 rng(0xc0de);
  for (const double spread : {0.7, 2.0, 5.0, 9.0, 30.0, 150.0, 1000.0, 20000.0})
    for (int round = 0; round < 6; ++round) {
      CAPTURE(spread);
      CAPTURE(round);
      const TriangleSoup soup = randomSoup(rng, 131, 97, spread, 80, true);
      const ImageU32 expected = resolveReference(soup, 131, 97);
      forEachTarget([&] {
        BinnedFrame frame(131, 97, soup.size());
        frame.draw(soup, setupTriangles);
        CHECK(differing(frame.resolve(), expected) == 0);
      });
    }
}

TEST_CASE("raster/tile: single slivers are covered exactly") {
  std::mt19937 rng(11);
  std::uniform_int_distribution<std::int32_t> anywhere(-2000 * 256, 2000 * 256);
  std::uniform_int_distribution<std::int32_t> hair(-40, 40);
  for (int round = 0; round < 400; ++round) {
    TriangleSoup soup;
    const std::int32_t x0 = anywhere(rng), y0 = anywhere(rng), x1 = anywhere(rng), y1 = anywhere(rng);
    soup.addVertex(x0, y0, 0.5F);
    soup.addVertex(x1, y1, 0.5F);
    soup.addVertex((x0 + x1) / 2 + hair(rng), (y0 + y1) / 2 + hair(rng), 0.5F);
    soup.addTriangle(0, 1, 2);
    BinnedFrame frame(131, 97, 1);
    frame.draw(soup, setupTriangles);
    CAPTURE(round);
    CHECK(differing(frame.resolve(), resolveReference(soup, 131, 97)) == 0);
  }
}

TEST_CASE("raster/tile: triangles of a grid cover every pixel exactly once") {
  std::mt19937 rng(5);
  for (const int cell_px : {1, 3, 7, 20}) {
    CAPTURE(cell_px);
    // A jittered grid of 15x15 cells whose border lies outside the target.
    constexpr int kCells = 15;
    const int size = (kCells - 2) * cell_px;
    TriangleSoup soup;
    std::uniform_int_distribution<std::int32_t> jitter(-cell_px * 256 / 3, cell_px * 256 / 3);
    for (int y = 0; y <= kCells; ++y)
      for (int x = 0; x <= kCells; ++x)
        soup.addVertex((x - 1) * cell_px * 256 + jitter(rng), (y - 1) * cell_px * 256 + jitter(rng), 0.5F);
    for (int y = 0; y < kCells; ++y)
      for (int x = 0; x < kCells; ++x) {
        const auto a = static_cast<std::uint8_t>(y * (kCells + 1) + x);
        const auto b = static_cast<std::uint8_t>(a + 1);
        const auto c = static_cast<std::uint8_t>(a + kCells + 1);
        const auto d = static_cast<std::uint8_t>(c + 1);
        soup.addTriangle(a, b, c);
        soup.addTriangle(b, d, c);
      }
    Image<int> times(size, size, 0);
    for (std::size_t t = 0; t < soup.size(); ++t) {
      TriangleSoup one = soup;
      for (auto& corner : one.corner) corner = {corner[t]};
      one.source = {0};
      BinnedFrame frame(size, size, 1);
      frame.draw(one, setupTriangles);
      const ImageU32 seen = frame.resolve();
      for (std::size_t i = 0; i < seen.pixels().size(); ++i) times.pixels()[i] += seen.pixels()[i] != kNoTriangle;
    }
    for (const int n : times.pixels()) CHECK(n == 1);
  }
}

TEST_CASE("raster/tile: the picture does not depend on the order of triangles") {
  std::mt19937 rng(23);
  for (int round = 0; round < 20; ++round) {
    const TriangleSoup soup = randomSoup(rng, 100, 80, 40.0, 85, round % 2 == 0);
    BinnedFrame forward(100, 80, soup.size());
    forward.draw(soup, setupTriangles);
    TriangleSoup reversed = soup;
    for (auto& corner : reversed.corner) std::reverse(corner.begin(), corner.end());
    std::reverse(reversed.source.begin(), reversed.source.end());
    BinnedFrame backward(100, 80, soup.size());
    backward.draw(reversed, setupTriangles);
    CHECK(differing(forward.resolve(), backward.resolve()) == 0);
  }
}

TEST_CASE("raster/tile: a triangle that spans the whole guard band of the largest target is exact") {
  TriangleSoup soup;
  constexpr std::int32_t kCenter = kMaxTargetSize / 2 * kSubpixels;
  constexpr std::int32_t kReach = (kGuardBandPx - 1) * kSubpixels;
  soup.addVertex(kCenter - kReach, kCenter - kReach, 0.25F);
  soup.addVertex(kCenter + kReach, kCenter - kReach + 77, 0.25F);
  soup.addVertex(kCenter - kReach + 55, kCenter + kReach, 0.25F);
  soup.addTriangle(0, 1, 2);
  BinnedFrame frame(kMaxTargetSize, kMaxTargetSize, 1);
  frame.draw(soup, setupTriangles);
  static TileVisibility tile;
  for (const int i : {0, 255, 128 * 256 + 127, 127 * 256 + 128, 128 * 256 + 128, 256 * 256 - 1}) {
    CAPTURE(i);
    const int x0 = i % 256 * kTileSize;
    const int y0 = i / 256 * kTileSize;
    const TileEntries entries[] = {{frame.binner.tile(i), frame.binner.largeTriangles()}};
    rasterTile(entries, frame.arena.data(), x0, y0, tile);
    int wrong = 0;
    for (int y = 0; y < kTileSize; ++y)
      for (int x = 0; x < kTileSize; ++x)
        wrong += (tile.triangle[tileIndex(x, y)] != kNoTriangle) != coversReference(soup, 0, x0 + x, y0 + y);
    CHECK(wrong == 0);
  }
}

TEST_CASE("raster/tile: depths that are not numbers hide nothing") {
  TriangleSoup soup;
  for (const float z : {0.5F, std::numeric_limits<float>::quiet_NaN()}) {
    const std::uint8_t a = soup.addVertex(-100 * 256, -100 * 256, z);
    const std::uint8_t b = soup.addVertex(300 * 256, -100 * 256, z);
    const std::uint8_t c = soup.addVertex(-100 * 256, 300 * 256, z);
    soup.addTriangle(a, b, c);
  }
  BinnedFrame frame(64, 64, 2);
  frame.draw(soup, setupTriangles);
  CHECK(frame.resolve().at(3, 3) == 0);
}

}  // namespace sheaf::raster
