#include "raster/silhouette.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "raster/screen.h"

namespace sheaf::raster {
namespace {

/// A square of `size` pixels with its corner at (x, y), showing instance `id`.
void drawSquare(ImageU32& ids, int x, int y, int size, std::uint32_t id) {
  for (int v = y; v < y + size; ++v)
    for (int u = x; u < x + size; ++u) ids.at(u, v) = id;
}

ImageU32 squareAt(int x, int y, int size) {
  ImageU32 ids(60, 50, kNoTriangle);
  drawSquare(ids, x, y, size, 0);
  return ids;
}

std::uint32_t nearestByLooking(const Image<std::uint8_t>& mask, int x, int y) {
  int nearest = -1;
  for (int v = 0; v < mask.height(); ++v)
    for (int u = 0; u < mask.width(); ++u) {
      const int squared = (u - x) * (u - x) + (v - y) * (v - y);
      if (mask.at(u, v) != 0 && (nearest < 0 || squared < nearest)) nearest = squared;
    }
  return static_cast<std::uint32_t>(nearest);
}

}  // namespace

TEST_CASE("raster/silhouette: distances are those of looking at every pixel, in any shape of picture") {
  std::mt19937 rng(0x5eed);
  for (const auto& [width, height, one_in] :
       {std::array{37, 23, 3}, {37, 23, 200}, {1, 40, 20}, {40, 1, 20}, {1, 1, 1}, {64, 64, 1000}}) {
    CAPTURE(width);
    CAPTURE(one_in);
    Image<std::uint8_t> mask(width, height, 0);
    for (std::uint8_t& m : mask.pixels()) m = rng() % static_cast<unsigned>(one_in) == 0 ? 255 : 0;
    mask.at(width / 2, height / 2) = 1;
    const ImageU32 squared = squaredDistances(mask);
    bool same = true;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) same = same && squared.at(x, y) == nearestByLooking(mask, x, y);
    CHECK(same);
  }
}

TEST_CASE("raster/silhouette: where the mask is empty everything is farther than the picture is large") {
  const ImageU32 squared = squaredDistances(Image<std::uint8_t>(30, 40, 0));
  for (const std::uint32_t s : squared.pixels()) CHECK(s > 50 * 50);
  CHECK(squaredDistances({}).empty());
}

TEST_CASE("raster/silhouette: a square that moved by 3 pixels has moved by 3") {
  for (const auto& [dx, dy] : {std::pair{3, 0}, {-3, 0}, {0, 3}, {0, -3}}) {
    const SilhouetteShift shift = silhouetteShift(squareAt(20, 20, 12), squareAt(20 + dx, 20 + dy, 12));
    CHECK(shift.max_px == 3.0);
    CHECK(shift.edge_pixels_a == 44);
    CHECK(shift.mean_px > 0.5);
    CHECK(shift.mean_px < 3.0);
  }
  CHECK(silhouetteShift(squareAt(20, 20, 12), squareAt(23, 24, 12)).max_px == 5.0);
}

TEST_CASE("raster/silhouette: a square that grew by 2 pixels on each side has moved by 2, by the diagonal at corners") {
  const SilhouetteShift shift = silhouetteShift(squareAt(20, 20, 10), squareAt(18, 18, 14));
  CHECK(shift.max_px == doctest::Approx(std::sqrt(8.0)));
  // Outlines of 36 and 52 pixels. From within: all 36 are 2 away. From without: of each side the 10 pixels opposite the
  // inner one are 2 away, the corners sqrt(8), those beside them sqrt(5).
  const double sum = 36 * 2.0 + 40 * 2.0 + 4 * std::sqrt(8.0) + 8 * std::sqrt(5.0);
  CHECK(shift.mean_px == doctest::Approx(sum / 88));
}

TEST_CASE("raster/silhouette: equal pictures, and empty ones, have not moved") {
  const SilhouetteShift shift = silhouetteShift(squareAt(7, 9, 12), squareAt(7, 9, 12));
  CHECK(shift.max_px == 0.0);
  CHECK(shift.mean_px == 0.0);
  CHECK(silhouetteShift(ImageU32(9, 9, kNoTriangle), ImageU32(9, 9, kNoTriangle)).max_px == 0.0);
  CHECK(silhouetteShift({}, {}).max_px == 0.0);
}

TEST_CASE("raster/silhouette: an outline that is gone has moved infinitely far") {
  const SilhouetteShift shift = silhouetteShift(squareAt(20, 20, 12), ImageU32(60, 50, kNoTriangle));
  CHECK(std::isinf(shift.max_px));
  CHECK(std::isinf(shift.mean_px));
  CHECK(shift.edge_pixels_b == 0);
}

TEST_CASE("raster/silhouette: the order of the pictures does not matter") {
  const SilhouetteShift ab = silhouetteShift(squareAt(20, 20, 12), squareAt(22, 25, 9));
  const SilhouetteShift ba = silhouetteShift(squareAt(22, 25, 9), squareAt(20, 20, 12));
  CHECK(ab.max_px == ba.max_px);
  CHECK(ab.mean_px == doctest::Approx(ba.mean_px));
}

TEST_CASE("raster/silhouette: the border between two instances is an outline, the picture's border is none") {
  ImageU32 a(40, 30, 0);
  ImageU32 b(40, 30, 0);
  CHECK(silhouetteShift(a, b).edge_pixels_a == 0);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) {
      a.at(x, y) = x < 20 ? 0 : 1;
      b.at(x, y) = x < 24 ? 0 : 1;
    }
  const SilhouetteShift shift = silhouetteShift(a, b);
  CHECK(shift.edge_pixels_a == 30);
  CHECK(shift.max_px == 4.0);
  CHECK(shift.mean_px == 4.0);
}

}  // namespace sheaf::raster
