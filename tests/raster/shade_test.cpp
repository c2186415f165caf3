#include "raster/shade.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
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
/// Where a look has steps (nearest texels, checkers), `outliers` pixels may lie on the other side of one.
void checkFrame(Frame& frame, const ShadeScene& scene, double tolerance, int outliers = 0) {
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
  int beyond = 0;
  int miscoded = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const std::uint32_t id = frame.ids.at(x, y);
      if (id == kNoTriangle) continue;
      const Vec4 drawn = frame.linear.at(x, y);
      const DVec3 expected = shadePixelReference(scene, id, x, y);
      const DVec3 difference = glm::abs(DVec3(drawn) - expected);
      if (!(std::max({difference.x, difference.y, difference.z}) <= tolerance)) {
        ++beyond;
        INFO("pixel ", x, " ", y, ": drawn ", drawn.x, " ", drawn.y, " ", drawn.z, ", expected ", expected.x, " ",
             expected.y, " ", expected.z);
        CHECK(beyond <= outliers);
      }
      const Rgba8 code = frame.srgb.at(x, y);
      if (code != Rgba8{encodeSrgb(drawn.x), encodeSrgb(drawn.y), encodeSrgb(drawn.z), 255}) ++miscoded;
      if (drawn.w != 1.0F) ++miscoded;
    }
  CHECK(miscoded == 0);
}

ShadeMaterial plainMaterial(ShadeModel model) {
  ShadeMaterial material;
  material.base_color = Vec4(0.8F, 0.6F, 0.3F, 1.0F);
  material.model = model;
  return material;
}

Image8 randomImage(ShadingScene& world, int width, int height) {
  Image8 image(width, height);
  for (Rgba8& p : image.pixels()) {
    const auto bits = static_cast<std::uint32_t>(world.rng());
    p = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8), static_cast<std::uint8_t>(bits >> 16),
         255};
  }
  return image;
}

}  // namespace

TEST_CASE("raster/shade: plain materials equal the reference on every SIMD target") {
  for (const ShadeModel model : {ShadeModel::kSmooth, ShadeModel::kFlat, ShadeModel::kUnlit}) {
    for (const std::uint32_t longest_run : {1U, 5U, 200U}) {
      CAPTURE(static_cast<int>(model));
      CAPTURE(longest_run);
      ShadingScene world;
      world.surfaces[world.addSurface(plainMaterial(model), Vec3(0.0F, 0.6F, 0.8F))].color = {};
      Frame frame;
      coverRandomly(frame, world, longest_run);
      checkFrame(frame, world.view(), 3e-4);
    }
  }
}

TEST_CASE("raster/shade: textures equal the reference on every SIMD target") {
  for (const FilterMode filter : {FilterMode::kTrilinear, FilterMode::kNearest})
    for (const WrapMode wrap : {WrapMode::kRepeat, WrapMode::kClamp, WrapMode::kMirror}) {
      CAPTURE(static_cast<int>(filter));
      CAPTURE(static_cast<int>(wrap));
      ShadingScene world;
      const MipTexture texture(randomImage(world, 37, 23));
      ShadeMaterial material = plainMaterial(ShadeModel::kUnlit);
      material.texture = &texture;
      material.sampler = {wrap, wrap, filter};
      material.uv_linear = {1.1F, 0.2F, -0.3F, 0.8F};
      material.uv_offset = {0.3F, -0.7F};
      const std::uint32_t surface = world.addSurface(material, Vec3(0.0F, 0.0F, 1.0F));
      world.surfaces[surface].color = {};
      Frame frame;
      coverRandomly(frame, world, 9);
      checkFrame(frame, world.view(), 2e-4, filter == FilterMode::kNearest ? 3 : 0);
    }
}

TEST_CASE("raster/shade: vertex colours, highlights and solids equal the reference on every SIMD target") {
  for (const SolidTexture solid :
       {SolidTexture::kNone, SolidTexture::kMarble, SolidTexture::kWood, SolidTexture::kChecker})
    for (const ShadeModel model : {ShadeModel::kSmooth, ShadeModel::kFlat, ShadeModel::kUnlit}) {
      CAPTURE(static_cast<int>(solid));
      CAPTURE(static_cast<int>(model));
      ShadingScene world;
      ShadeMaterial material = plainMaterial(model);
      material.solid = solid;
      material.solid_colors = {Vec3(0.9F, 0.8F, 0.7F), Vec3(0.1F, 0.2F, 0.3F)};
      material.solid_frequency = 2.5F;
      material.specular = 0.1F;
      material.shininess = 40.0F;
      world.addSurface(material, Vec3(0.3F, 0.3F, 0.9F));
      Frame frame;
      coverRandomly(frame, world, 7);
      checkFrame(frame, world.view(), 6e-4, solid == SolidTexture::kChecker ? 2 : 0);
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

TEST_CASE("raster/shade: pixels without a triangle get the background, straight in sRGB and premultiplied in linear") {
  ShadingScene world;
  const ShadeScene scene = world.view();
  forEachTarget([&] {
    Frame frame;
    frame.shade(scene);
    CHECK(frame.counts.pixels_shaded == 0);
    CHECK(frame.counts.pixels_background == kWidth * kHeight);
    const Rgba8 code{encodeSrgb(0.25F), encodeSrgb(0.5F), encodeSrgb(0.75F), 102};
    const Vec4 premultiplied(Vec3(0.25F, 0.5F, 0.75F) * 0.4F, 0.4F);
    for (const Rgba8& p : frame.srgb.pixels()) REQUIRE(p == code);
    for (const Vec4& p : frame.linear.pixels()) REQUIRE(p == premultiplied);

    Frame filled;
    for (int y0 = 0; y0 < kHeight; y0 += kTileSize)
      for (int x0 = 0; x0 < kWidth; x0 += kTileSize) {
        const ShadeCounts of_tile = fillTile(scene, x0, y0, {&filled.srgb, &filled.linear});
        filled.counts.pixels_background += of_tile.pixels_background;
      }
    CHECK(filled.counts.pixels_background == kWidth * kHeight);
    CHECK(filled.srgb == frame.srgb);
    CHECK(filled.linear == frame.linear);
  });
}

TEST_CASE("raster/shade: background and surface share blocks, each pixel counts once") {
  ShadingScene world;
  world.addSurface(plainMaterial(ShadeModel::kUnlit), Vec3(0.0F, 0.0F, 1.0F));
  world.surfaces[0].color = {};
  Frame frame;
  coverRandomly(frame, world, 4);
  std::uint64_t covered = 0;
  for (const std::uint32_t id : frame.ids.pixels()) covered += id != kNoTriangle ? 1 : 0;
  REQUIRE(covered > 0);
  REQUIRE(covered < kWidth * kHeight);
  const ShadeScene scene = world.view();
  forEachTarget([&] {
    frame.shade(scene);
    CHECK(frame.counts.pixels_shaded == covered);
    CHECK(frame.counts.pixels_background == kWidth * kHeight - covered);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        REQUIRE(frame.srgb.at(x, y).a == (frame.ids.at(x, y) == kNoTriangle ? 102 : 255));
  });
}

TEST_CASE("raster/shade: either image may be left out") {
  ShadingScene world;
  world.addSurface(plainMaterial(ShadeModel::kSmooth), Vec3(0.0F, 0.0F, 1.0F));
  const auto tile = std::make_unique<TileVisibility>();
  std::fill(std::begin(tile->triangle), std::end(tile->triangle), world.addTriangle(0, 10, 10));
  const ShadeScene scene = world.view();
  Image8 srgb(70, 40);
  Image8 srgb_alone(70, 40);
  ImageF4 linear(70, 40);
  ImageF4 linear_alone(70, 40);
  shadeTile(scene, *tile, 0, 0, {&srgb, &linear});
  shadeTile(scene, *tile, 0, 0, {&srgb_alone, nullptr});
  shadeTile(scene, *tile, 0, 0, {nullptr, &linear_alone});
  CHECK(srgb == srgb_alone);
  CHECK(linear == linear_alone);
}

TEST_CASE("raster/shade: attributes are interpolated with perspective") {
  // Along a row of 101 pixels w goes from 1 at the left (black) to 3 at the right (white): at screen fraction s the
  // share of the right corner is (s / 3) / ((1 - s) / 1 + s / 3).
  ShadingScene world;
  ShadeMaterial material = plainMaterial(ShadeModel::kUnlit);
  material.base_color = Vec4(1.0F);
  world.addSurface(material, Vec3(0.0F, 0.0F, 1.0F));
  const std::uint32_t rg[] = {packColor(Vec4(0.0F))[0], packColor(Vec4(1.0F))[0]};
  const std::uint32_t ba[] = {packColor(Vec4(0.0F))[1], packColor(Vec4(1.0F))[1]};
  world.surfaces[0].color = {rg, ba};
  ShadeTriangle t{};
  t.u0[0] = 1.0F;
  t.ux[0] = -0.01F;
  t.ux[1] = 0.01F / 3.0F;
  t.vertex[1] = 1;
  world.triangles.push_back(t);
  Frame frame;
  for (int x = 0; x <= 100; ++x) frame.ids.at(x, 0) = 0;
  const ShadeScene scene = world.view();
  forEachTarget([&] {
    frame.shade(scene);
    for (int x = 0; x <= 100; ++x) {
      CAPTURE(x);
      const double s = x / 100.0;
      CHECK(std::abs(frame.linear.at(x, 0).x - (s / 3.0) / (1.0 - s + s / 3.0)) < 1e-5);
    }
  });
}

TEST_CASE("raster/shade: what is not a number or has no direction gives finite colours") {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const ShadeModel model : {ShadeModel::kSmooth, ShadeModel::kFlat, ShadeModel::kUnlit})
    for (const SolidTexture solid :
         {SolidTexture::kNone, SolidTexture::kMarble, SolidTexture::kWood, SolidTexture::kChecker})
      for (const WrapMode wrap : {WrapMode::kRepeat, WrapMode::kClamp, WrapMode::kMirror}) {
        ShadingScene world;
        const MipTexture texture(randomImage(world, 5, 7));
        ShadeMaterial material = plainMaterial(model);
        material.texture = &texture;
        material.sampler = {wrap, wrap, solid == SolidTexture::kWood ? FilterMode::kNearest : FilterMode::kTrilinear};
        material.solid = solid;
        material.specular = 0.5F;
        world.addSurface(material, Vec3(0.0F, 0.0F, 1.0F));
        const float bad[] = {kNan, kInfinity, -kInfinity, 1e38F, -1e38F, 0.0F, 1e-42F, 3e9F};
        ShadingScene::Attributes& a = world.attributes[0];
        for (std::size_t i = 0; i < ShadingScene::kVertices; ++i) {
          if (i % 3 == 0) a.texcoord[0][i] = bad[i / 3 % 8];
          if (i % 5 == 0) a.position[i % 3][i] = bad[i / 5 % 8];
          if (i % 2 == 0) a.normal[i] = vertexNormal(Vec3(i % 4 == 0 ? 1.0F : -1.0F, 0.0F, 0.0F));
        }
        Frame frame;
        coverRandomly(frame, world, 3);
        for (std::size_t i = 0; i < world.triangles.size(); i += 7) world.triangles[i].u0[i % 3] = bad[i / 7 % 8];
        Image8 first;
        const ShadeScene scene = world.view();
        forEachTarget([&] {
          frame.shade(scene);
          for (const Vec4& p : frame.linear.pixels())
            REQUIRE((std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && p.x >= 0.0F));
          if (first.empty()) first = frame.srgb;
          CHECK(frame.srgb == first);
        });
      }
}

TEST_CASE("raster/shade: normals have unit length, whatever they are made of") {
  ShadingScene world;
  for (const float scale : {1e-30F, 1e-3F, 1.0F, 1e30F}) {
    const Vec3 direction = world.direction();
    const VertexNormal n = vertexNormal(scale * direction);
    CHECK(glm::length(Vec3(n.x, n.y, n.z) - direction) < 1e-6F);
  }
  for (const float bad : {0.0F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    const VertexNormal n = vertexNormal(Vec3(bad));
    CHECK(Vec3(n.x, n.y, n.z) == Vec3(0.0F, 0.0F, 1.0F));
  }
}

TEST_CASE("raster/shade: colours are packed as clamped 16-bit fractions") {
  CHECK(packColor(Vec4(0.0F, 1.0F, 0.5F, 2.0F)) == std::array<std::uint32_t, 2>{0xFFFF0000U, 0xFFFF8000U});
  CHECK(packColor(Vec4(-1.0F, std::numeric_limits<float>::quiet_NaN(), 0.0F, 1.0F)) ==
        std::array<std::uint32_t, 2>{0U, 0xFFFF0000U});
}

}  // namespace sheaf::raster
