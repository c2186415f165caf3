#include "raster/srgb.h"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

namespace sheaf::raster {
namespace {

/// The curve in extended precision, times 255.
long double exactCode(float linear) {
  const long double x = linear;
  return 255.0L * (x <= 0.0031308L ? 12.92L * x : 1.055L * std::pow(x, 1.0L / 2.4L) - 0.055L);
}

}  // namespace

TEST_CASE("raster/srgb: every code decodes to a value that encodes back") {
  for (int code = 0; code < 256; ++code) CHECK(encodeSrgb(srgbDecodeTable()[static_cast<std::size_t>(code)]) == code);
}

TEST_CASE("raster/srgb: encoding rounds to the nearest code, right up to each threshold") {
  for (int code = 1; code < 256; ++code) {
    CAPTURE(code);
    const auto threshold = static_cast<float>(linearFromSrgb((code - 0.5) / 255.0));
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(threshold);
    for (std::uint32_t near = bits - 3; near <= bits + 3; ++near) {
      const float x = std::bit_cast<float>(near);
      const long double exact = exactCode(x);
      // Far enough from a half that the table cannot depend on the maths library.
      CHECK(std::abs(exact - (code - 0.5L)) > 1e-10L);
      CHECK(encodeSrgb(x) == (exact >= code - 0.5L ? code : code - 1));
    }
  }
}

TEST_CASE("raster/srgb: encoding random floats is within half a code of the curve") {
  std::mt19937 rng(1);
  std::uniform_int_distribution<std::uint32_t> bits(0, std::bit_cast<std::uint32_t>(1.0F));
  for (int i = 0; i < 200000; ++i) {
    const float x = std::bit_cast<float>(bits(rng));
    CAPTURE(x);
    REQUIRE(std::abs(exactCode(x) - encodeSrgb(x)) <= 0.5L);
  }
}

TEST_CASE("raster/srgb: values outside [0, 1] are clamped, NaN is black") {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const float x : {-kInfinity, -1.0F, -0.0F, 0.0F, 1e-40F, std::numeric_limits<float>::quiet_NaN()})
    CHECK(encodeSrgb(x) == 0);
  for (const float x : {1.0F, 1.5F, 1e30F, kInfinity}) CHECK(encodeSrgb(x) == 255);
}

}  // namespace sheaf::raster
