#include "raster/image_compare.h"

#include <doctest/doctest.h>

#include <cmath>

namespace sheaf::raster {
namespace {

int luma(Rgba8 p) {
  return 54 * p.r + 183 * p.g + 19 * p.b;
}

}  // namespace

TEST_CASE("raster/image_compare: a picture equals itself, with infinite PSNR") {
  const Image8 a(7, 5, {10, 20, 30, 255});
  const ImageDifference d = compareImages(a, a);
  CHECK(d.differing_pixels == 0);
  CHECK(d.max_error == 0);
  CHECK(d.rms == 0.0);
  CHECK(std::isinf(d.psnr_db));
  CHECK(!d.first.has_value());
  CHECK(d.differingFraction() == 0.0);
}

TEST_CASE("raster/image_compare: an empty picture equals an empty picture") {
  const ImageDifference d = compareImages(Image8(), Image8());
  CHECK(d.differing_pixels == 0);
  CHECK(d.differingFraction() == 0.0);
  CHECK(std::isinf(d.psnr_db));
}

TEST_CASE("raster/image_compare: figures of two differing pixels are those worked out by hand") {
  const Image8 a(10, 10, {100, 100, 100, 255});
  Image8 b = a;
  b.at(7, 2) = {103, 100, 100, 255};
  b.at(3, 6) = {100, 96, 100, 255};
  const ImageDifference d = compareImages(a, b);
  CHECK(d.differing_pixels == 2);
  CHECK(d.differingFraction() == doctest::Approx(0.02));
  CHECK(d.max_error == 4);
  CHECK(d.max_error_channel == std::array<int, 4>{3, 4, 0, 0});
  CHECK(d.channels == 3);
  const double rms = std::sqrt((9.0 + 16.0) / 300.0);
  CHECK(d.rms == doctest::Approx(rms));
  CHECK(d.psnr_db == doctest::Approx(20.0 * std::log10(255.0 / rms)));
  CHECK(d.first == PixelPosition{7, 2});
  CHECK(d.box_min == PixelPosition{3, 2});
  CHECK(d.box_max == PixelPosition{8, 7});
}

TEST_CASE("raster/image_compare: black against white is the greatest error, 0 dB") {
  const ImageDifference d = compareImages(Image8(4, 4, {0, 0, 0, 255}), Image8(4, 4, {255, 255, 255, 255}));
  CHECK(d.differing_pixels == 16);
  CHECK(d.max_error == 255);
  CHECK(d.rms == doctest::Approx(255.0));
  CHECK(d.psnr_db == doctest::Approx(0.0));
}

TEST_CASE("raster/image_compare: alpha counts as soon as a pixel is not opaque") {
  const Image8 a(2, 2, {0, 0, 0, 255});
  const Image8 b(2, 2, {0, 0, 0, 55});
  const ImageDifference d = compareImages(a, b);
  CHECK(d.channels == 4);
  CHECK(d.max_error_channel == std::array<int, 4>{0, 0, 0, 200});
  CHECK(d.rms == doctest::Approx(100.0));  // 200 in one of four channels
}

TEST_CASE("raster/image_compare: the figures do not depend on which picture comes first") {
  Image8 a(9, 3, {5, 6, 7, 255});
  Image8 b = a;
  b.at(8, 2) = {1, 2, 3, 4};
  const ImageDifference ab = compareImages(a, b);
  const ImageDifference ba = compareImages(b, a);
  CHECK(ab.rms == ba.rms);
  CHECK(ab.max_error_channel == ba.max_error_channel);
  CHECK(ab.first == ba.first);
}

TEST_CASE("raster/image_compare: in the heat map a greater error is lighter, and no error is grey") {
  const Image8 a(256, 1, {0, 0, 0, 255});
  Image8 b = a;
  for (int x = 0; x < 256; ++x) b.at(x, 0).g = static_cast<std::uint8_t>(x);
  const Image8 map = heatMap(a, b);
  REQUIRE(map.width() == 256);
  REQUIRE(map.height() == 1);
  CHECK(map.at(0, 0) == Rgba8{0, 0, 0, 255});
  CHECK(luma(map.at(1, 0)) > luma(map.at(0, 0)));
  CHECK(luma(map.at(255, 0)) > 2 * luma(map.at(16, 0)));
  // From purple on every step is lighter; the blue at the low end keeps its lightness.
  for (int x = 8; x < 256; ++x) CHECK(luma(map.at(x, 0)) >= luma(map.at(x - 1, 0)) - 200);
}

}  // namespace sheaf::raster
