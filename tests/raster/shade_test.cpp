#include "raster/shade.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <memory>

#include "raster/shade_reference.h"
#include "raster/srgb.h"
#include "tests/raster/shading_scene.h"
#include "tests/simd_targets.h"

namespace sheaf::raster {
namespace {

constexpr int kWidth = 131;
constexpr int kHeight = 97;

/// Ids of a whole frame by pixel, cut into tiles as shadeTile() wants them.
struct Frame {
  ImageU32 ids{kWidth, kHeight, kNoTriangle};
  Image8 srgb{kWidth, kHeight, Rgba8{1, 2, 3, 4}};
  ImageF4 linear{kWidth, kHeight, Vec4(-1.0F)};
  ShadeCounts counts;

  void shade(const ShadeScene& scene) {
    counts = {};
    const auto tile = std::make_unique<TileVisibility>();
    for (int y0 = 0; y0 < kHeight; y0 += kTileSize)
      for (int x0 = 0; x0 < kWidth; x0 += kTileSize) {
        for (int y = 0; y < kTileSize; ++y)
          for (int x = 0; x < kTileSize; ++x) {
            const bool inside = x0 + x < kWidth && y0 + y < kHeight;
            tile->triangle[tileIndex(x, y)] = inside ? ids.at(x0 + x, y0 + y) : kNoTriangle;
          }
        const ShadeCounts of_tile = shadeTile(scene, *tile, x0, y0, {&srgb, &linear});
        counts.pixels_shaded += of_tile.pixels_shaded;
        counts.pixels_background += of_tile.pixels_background;
      }
  }
};

/// Runs of pixels of random lengths: each shows one triangle, or nothing.
void coverRandomly(Frame& frame, ShadingScene& world, std::uint32_t longest_run) {
  std::uint32_t left = 0;
  std::uint32_t id = kNoTriangle;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      if (left == 0) {
        left = 1 + world.below(longest_run);
        id = world.below(8) == 0
                 ? kNoTriangle
                 : world.addTriangle(world.below(static_cast<std::uint32_t>(world.surfaces.size())), x, y);
      }
      --left;
      frame.ids.at(x, y) = id;
    }
}

/// Compares every pixel with the reference, and every SIMD target with the first.
void checkFrame(Frame& frame, const ShadeScene& scene, double tolerance) {
  Image8 first_srgb;
  ImageF4 first_linear;
  forEachTarget([&] {
    frame.shade(scene);
    if (first_srgb.empty()) {
      first_srgb = frame.srgb;
      first_linear = frame.linear;
    }
    CHECK(frame.srgb == first_srgb);
    CHECK(std::memcmp(frame.linear.pixels().data(), first_linear.pixels().data(), frame.linear.pixels().size_bytes()) ==
          0);
  });
  double worst = 0.0;
  int miscoded = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const std::uint32_t id = frame.ids.at(x, y);
      if (id == kNoTriangle) continue;
      const Vec4 drawn = frame.linear.at(x, y);
      const DVec3 expected = shadePixelReference(scene, id, x, y);
      for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(double{drawn[c]} - expected[c]));
      const Rgba8 code = frame.srgb.at(x, y);
      if (code != Rgba8{encodeSrgb(drawn.x), encodeSrgb(drawn.y), encodeSrgb(drawn.z), 255}) ++miscoded;
      if (drawn.w != 1.0F) ++miscoded;
    }
  CHECK(worst <= tolerance);
  CHECK(miscoded == 0);
}

ShadeMaterial plainMaterial(ShadeModel model) {
  ShadeMaterial material;
  material.base_color = Vec4(0.8F, 0.6F, 0.3F, 1.0F);
  material.model = model;
  return material;
}

}  // namespace

TEST_CASE("raster/shade: plain materials equal the reference on every SIMD target") {
  for (const ShadeModel model : {ShadeModel::kSmooth, ShadeModel::kFlat, ShadeModel::kUnlit}) {
    for (const std::uint32_t longest_run : {1U, 5U, 200U}) {
      CAPTURE(static_cast<int>(model));
      CAPTURE(longest_run);
      ShadingScene world;
      world.addSurface(plainMaterial(model), Vec3(0.0F, 0.6F, 0.8F));
      Frame frame;
      coverRandomly(frame, world, longest_run);
      checkFrame(frame, world.view(), 3e-4);
    }
  }
}

TEST_CASE("raster/shade: surfaces of several materials in one block keep to their own pixels and arrays") {
  ShadingScene world;
  for (const ShadeModel model : {ShadeModel::kSmooth, ShadeModel::kFlat, ShadeModel::kUnlit, ShadeModel::kSmooth})
    world.addSurface(plainMaterial(model), world.direction());
  Frame frame;
  coverRandomly(frame, world, 3);
  checkFrame(frame, world.view(), 3e-4);
}

}  // namespace sheaf::raster
