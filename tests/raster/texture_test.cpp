#include "raster/texture.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

#include "raster/srgb.h"

namespace sheaf::raster {
namespace {

constexpr double kStep = 0.5 / 65535.0 + 1e-7;  // rounding of a texel

float linear(int code) {
  return srgbDecodeTable()[static_cast<std::size_t>(code)];
}

Rgba8 gray(int code, int alpha = 255) {
  const auto c = static_cast<std::uint8_t>(code);
  return {c, c, c, static_cast<std::uint8_t>(alpha)};
}

Image8 randomGrays(int width, int height) {
  std::mt19937 rng(3);
  Image8 image(width, height);
  for (Rgba8& p : image.pixels()) p = gray(static_cast<int>(rng() & 255U));
  return image;
}

}  // namespace

TEST_CASE("raster/texture: levels halve down to one texel") {
  const MipTexture texture(Image8(37, 5));
  REQUIRE(texture.levelCount() == 6);
  const int widths[] = {37, 18, 9, 4, 2, 1};
  const int heights[] = {5, 2, 1, 1, 1, 1};
  std::int32_t texels = 0;
  for (int k = 0; k < 6; ++k) {
    CHECK(texture.level(k).width == widths[k]);
    CHECK(texture.level(k).height == heights[k]);
    CHECK(texture.level(k).first_texel == texels);
    texels += widths[k] * heights[k];
  }
  CHECK(texture.texels().size() == static_cast<std::size_t>(texels));
  CHECK(MipTexture(Image8(1, 1)).levelCount() == 1);
}

TEST_CASE("raster/texture: coarse levels of a checker are its mean in linear light") {
  Image8 image(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) image.at(x, y) = gray((x + y) % 2 == 0 ? 255 : 20);
  const MipTexture texture(image);
  const double mean = 0.5 * (1.0 + double{linear(20)});
  for (const float footprint : {2.0F, 3.0F, 64.0F, 1e9F}) {
    const Vec4 color = sampleReference(texture, {}, Vec2(0.3F, 0.8F), footprint);
    CHECK(std::abs(color.x - mean) < 2.0 * kStep);
    CHECK(color.w == 1.0F);
  }
}

TEST_CASE("raster/texture: levels of odd sizes keep the mean") {
  const Image8 image = randomGrays(37, 23);
  double mean = 0.0;
  for (const Rgba8& p : image.pixels()) mean += double{linear(p.r)} / (37.0 * 23.0);
  const Vec4 color = sampleReference(MipTexture(image), {}, Vec2(0.5F), 1e6F);
  CHECK(std::abs(color.x - mean) < 6.0 * kStep);
}

TEST_CASE("raster/texture: transparent texels do not bleed into coarser levels") {
  Image8 image(2, 1);
  image.at(0, 0) = gray(200);
  image.at(1, 0) = gray(0, 0);
  const Vec4 color = sampleReference(MipTexture(image), {}, Vec2(0.5F), 100.0F);
  CHECK(std::abs(color.x - linear(200)) < 2.0 * kStep);
  CHECK(std::abs(color.w - 0.5) < 2.0 * kStep);
}

TEST_CASE("raster/texture: texel centres return the texel, points between mix linearly") {
  Image8 image(8, 1);
  for (int x = 0; x < 8; ++x) image.at(x, 0) = gray(30 * x);
  const MipTexture texture(image);
  for (const FilterMode filter : {FilterMode::kTrilinear, FilterMode::kNearest}) {
    const TextureSampler sampler{WrapMode::kRepeat, WrapMode::kRepeat, filter};
    for (int x = 0; x < 8; ++x) {
      const Vec2 uv((static_cast<float>(x) + 0.5F) / 8.0F, 0.5F);
      CHECK(std::abs(sampleReference(texture, sampler, uv, 0.5F).x - linear(30 * x)) < kStep);
    }
  }
  const double between = 0.75 * double{linear(30)} + 0.25 * double{linear(60)};
  CHECK(std::abs(sampleReference(texture, {}, Vec2(1.75F / 8.0F, 0.5F), 1.0F).x - between) < kStep);
}

TEST_CASE("raster/texture: wrap modes repeat, clamp and mirror") {
  const MipTexture texture(randomGrays(16, 8));
  const auto sample = [&](WrapMode wrap, float u, float v) {
    return sampleReference(texture, {wrap, wrap, FilterMode::kTrilinear}, Vec2(u, v), 1.7F);
  };
  std::mt19937 rng(4);
  for (int i = 0; i < 200; ++i) {
    // Multiples of 1/256, so that shifts are exact.
    const float u = static_cast<float>(rng() % 256) / 256.0F;
    const float v = static_cast<float>(rng() % 256) / 256.0F;
    CAPTURE(u);
    CAPTURE(v);
    CHECK(sample(WrapMode::kRepeat, u, v) == sample(WrapMode::kRepeat, u - 3.0F, v + 5.0F));
    CHECK(sample(WrapMode::kMirror, u, v) == sample(WrapMode::kMirror, -u, 2.0F - v));
    CHECK(sample(WrapMode::kMirror, u, v) == sample(WrapMode::kMirror, u + 4.0F, v - 2.0F));
    CHECK(sample(WrapMode::kMirror, u, v) == sample(WrapMode::kClamp, u, v));
    CHECK(sample(WrapMode::kClamp, u + 1.0F, v) == sample(WrapMode::kClamp, 7.0F, v));
    CHECK(sample(WrapMode::kClamp, u - 1.0F, v) == sample(WrapMode::kClamp, -7.0F, v));
  }
}

TEST_CASE("raster/texture: coordinates that are huge or not numbers still give a colour") {
  const MipTexture texture(randomGrays(5, 3));
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const WrapMode wrap : {WrapMode::kRepeat, WrapMode::kClamp, WrapMode::kMirror})
    for (const FilterMode filter : {FilterMode::kTrilinear, FilterMode::kNearest})
      for (const float bad : {kInfinity, -kInfinity, std::numeric_limits<float>::quiet_NaN(), 1e30F, -1e30F})
        for (const float footprint : {1.0F, bad}) {
          const Vec4 color = sampleReference(texture, {wrap, wrap, filter}, Vec2(bad, 0.5F), footprint);
          CHECK((color.x >= 0.0F && color.x <= 1.0F));
        }
}

}  // namespace sheaf::raster
