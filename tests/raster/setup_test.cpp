#include "raster/setup.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "tests/raster/coverage_fixture.h"
#include "tests/simd_targets.h"

namespace sheaf::raster {
namespace {

// Everything that set-up leaves behind, as bytes, in an order that does not depend on the order of binning.
std::vector<std::string> contents(BinnedFrame& frame) {
  std::vector<std::string> out;
  const auto bytes = [](const auto& value) {
    return std::string(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  for (int tile = 0; tile < frame.binner.tilesX() * frame.binner.tilesY(); ++tile)
    for (const Binner::Chunk* chunk = frame.binner.tile(tile); chunk != nullptr; chunk = chunk->next)
      for (int i = 0; i < chunk->count; ++i) {
        BinEntry entry = chunk->entries[i];
        std::string item = bytes(tile);
        std::uint32_t shade = entry.index;
        if (entry.mask == 0) {
          LargeTriangle large = frame.binner.largeTriangles()[entry.index];
          shade = large.shade;
          large.shade = 0;
          item += bytes(large);
        }
        entry.index = 0;
        out.push_back(item + bytes(entry) + bytes(frame.arena.data()[shade]));
      }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

TEST_CASE("raster/setup: every SIMD target equals the reference, bit for bit") {
  std::mt19937 rng(0x5eed);
  for (const double spread : {1.0, 3.0, 8.0, 40.0, 300.0, 20000.0})
    for (const Facing facing : {Facing{-1, true}, Facing{1, true}, Facing{-1, false}})
      for (int round = 0; round < 20; ++round) {
        CAPTURE(spread);
        CAPTURE(round);
        const TriangleSoup soup = randomSoup(rng, 131, 97, spread, 80, false);
        BinnedFrame expected(131, 97, soup.size());
        expected.draw(soup, setupTrianglesReference, facing);
        const auto expected_contents = contents(expected);
        forEachTarget([&] {
          BinnedFrame actual(131, 97, soup.size());
          actual.draw(soup, setupTriangles, facing);
          CHECK(contents(actual) == expected_contents);
          CHECK(actual.counts.back_facing == expected.counts.back_facing);
          CHECK(actual.counts.no_sample == expected.counts.no_sample);
          CHECK(actual.counts.binned == expected.counts.binned);
        });
      }
}

TEST_CASE("raster/setup: every triangle is counted once") {
  std::mt19937 rng(7);
  for (int round = 0; round < 50; ++round) {
    const TriangleSoup soup = randomSoup(rng, 64, 64, 4.0, 77, false);
    BinnedFrame frame(64, 64, soup.size());
    frame.draw(soup, setupTriangles, {-1, true});
    CHECK(frame.counts.back_facing + frame.counts.no_sample + frame.counts.binned == 77);
  }
}

TEST_CASE("raster/setup: facing follows the winding on screen, and mirroring turns it round") {
  TriangleSoup soup;
  // Counter-clockwise with y up is clockwise in these coordinates (y down): this one is a front.
  soup.addVertex(10 * 256, 50 * 256, 0.5F);
  soup.addVertex(50 * 256, 50 * 256, 0.5F);
  soup.addVertex(30 * 256, 10 * 256, 0.5F);
  soup.addTriangle(0, 1, 2);
  const auto binned = [&](Facing facing) {
    BinnedFrame frame(64, 64, 1);
    frame.draw(soup, setupTriangles, facing);
    return frame.counts.binned;
  };
  CHECK(binned({-1, true}) == 1);
  CHECK(binned({1, true}) == 0);
  CHECK(binned({1, false}) == 1);
}

TEST_CASE("raster/setup: barycentrics and depth at pixel centres agree with interpolation in double precision") {
  std::mt19937 rng(3);
  for (int round = 0; round < 200; ++round) {
    const TriangleSoup soup = randomSoup(rng, 200, 200, 60.0, 10, false);
    BinnedFrame frame(200, 200, soup.size());
    frame.draw(soup, setupTriangles);
    for (std::uint32_t i = 0; i < frame.counts.binned; ++i) {
      const ShadeTriangle& shade = frame.arena.data()[i];
      const std::size_t v[3] = {shade.vertex[0], shade.vertex[1], shade.vertex[2]};
      // At every corner of the triangle its own barycentric is 1 and the others are 0.
      for (int corner = 0; corner < 3; ++corner) {
        const double dx = soup.x_fx[v[corner]] / 256.0 - 0.5 - shade.ref_x;
        const double dy = soup.y_fx[v[corner]] / 256.0 - 0.5 - shade.ref_y;
        double u[3];
        for (int k = 0; k < 3; ++k) u[k] = double{shade.u0[k]} + double{shade.ux[k]} * dx + double{shade.uy[k]} * dy;
        // Slivers have steep planes: the bound is relative to how steep.
        double steep = 0.0;
        for (int k = 0; k < 3; ++k)
          steep =
              std::max({steep, std::abs(double{shade.u0[k]}), std::abs(shade.ux[k] * dx), std::abs(shade.uy[k] * dy)});
        const double inv_w = soup.inv_w[v[corner]];
        for (int k = 0; k < 3; ++k) CHECK(std::abs(u[k] - (k == corner ? inv_w : 0.0)) <= 1e-6 * (steep + inv_w));
      }
    }
  }
}

}  // namespace sheaf::raster
