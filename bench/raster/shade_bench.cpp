// Shading of a covered 1920x1080 frame by one thread, by the size of its triangles and what its surface asks for.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/memory_bandwidth.h"
#include "raster/shade.h"

namespace sheaf::raster {
namespace {

constexpr int kWidth = 1920;
constexpr int kHeight = 1080;
constexpr int kPatchTriangles = 512;
constexpr int kPatchVertices = 256;

enum Look : std::int64_t { kPlain, kSpecular, kFlat, kTextured, kMarble, kWood };

Image8 noiseImage(int size) {
  std::mt19937 rng(7);
  Image8 image(size, size);
  for (Rgba8& p : image.pixels()) {
    const auto bits = static_cast<std::uint32_t>(rng());
    p = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8), static_cast<std::uint8_t>(bits >> 16),
         255};
  }
  return image;
}

/// A frame of square "triangles" of side x side pixels. Numbers of triangles are shuffled within patches, as a mesh
/// would have them; each patch has vertices of its own.
struct Workload {
  std::vector<float> position[3];
  std::vector<float> texcoord[2];
  std::vector<VertexNormal> normal;
  std::vector<ShadeTriangle> triangles;
  std::vector<TileVisibility> tiles;
  std::vector<Surface> surfaces{1};
  std::vector<ShadeMaterial> materials{1};
  MipTexture texture{noiseImage(1024)};
  ShadeScene scene;

  Workload(int side, Look look) {
    const int columns = (kWidth + side - 1) / side;
    const int rows = (kHeight + side - 1) / side;
    std::vector<std::uint32_t> number(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    for (std::size_t i = 0; i < number.size(); ++i) number[i] = static_cast<std::uint32_t>(i);
    std::mt19937 rng(42);
    for (std::size_t i = 0; i < number.size(); i += kPatchTriangles)
      std::shuffle(number.begin() + static_cast<std::ptrdiff_t>(i),
                   number.begin() + static_cast<std::ptrdiff_t>(std::min(i + kPatchTriangles, number.size())), rng);
    makeTriangles(number, columns, side, rng);
    makeTiles(number, columns, side);
    makeSurface(look);
  }

  void makeTriangles(const std::vector<std::uint32_t>& number, int columns, int side, std::mt19937& rng) {
    std::uniform_real_distribution<float> signed_unit(-1.0F, 1.0F);
    triangles.resize(number.size());
    for (std::size_t i = 0; i < number.size(); ++i) {
      ShadeTriangle& t = triangles[number[i]];
      for (int c = 0; c < 3; ++c) {
        t.u0[c] = 1.0F + 0.2F * signed_unit(rng);
        t.ux[c] = 0.3F / static_cast<float>(side) * signed_unit(rng);
        t.uy[c] = 0.3F / static_cast<float>(side) * signed_unit(rng);
        t.vertex[c] = number[i] / kPatchTriangles * kPatchVertices + static_cast<std::uint32_t>(rng() % kPatchVertices);
      }
      t.ref_x = static_cast<std::int16_t>(static_cast<int>(i) % columns * side);
      t.ref_y = static_cast<std::int16_t>(static_cast<int>(i) / columns * side);
    }
    const std::size_t vertices = (triangles.size() / kPatchTriangles + 1) * kPatchVertices;
    for (std::size_t i = 0; i < vertices; ++i) {
      for (auto& axis : position) axis.push_back(signed_unit(rng));
      for (auto& axis : texcoord) axis.push_back(0.05F * signed_unit(rng));
      const Vec3 n = {signed_unit(rng), signed_unit(rng), 1.2F};
      normal.push_back(vertexNormal(n));
    }
  }

  void makeTiles(const std::vector<std::uint32_t>& number, int columns, int side) {
    for (int y0 = 0; y0 < kHeight; y0 += kTileSize)
      for (int x0 = 0; x0 < kWidth; x0 += kTileSize) {
        TileVisibility& tile = tiles.emplace_back();
        for (int y = 0; y < kTileSize; ++y)
          for (int x = 0; x < kTileSize; ++x) {
            const bool inside = x0 + x < kWidth && y0 + y < kHeight;
            const int index = (y0 + y) / side * columns + (x0 + x) / side;
            tile.triangle[tileIndex(x, y)] = inside ? number[static_cast<std::size_t>(index)] : kNoTriangle;
          }
      }
  }

  void makeSurface(Look look) {
    Surface& s = surfaces[0];
    for (std::size_t axis = 0; axis < 3; ++axis) s.position_object[axis] = position[axis].data();
    s.normal = normal.data();
    ShadeMaterial& m = materials[0];
    if (look == kSpecular) m.specular = 0.3F;
    if (look == kFlat) m.model = ShadeModel::kFlat;
    if (look == kTextured) {
      for (std::size_t axis = 0; axis < 2; ++axis) s.texcoord[axis] = texcoord[axis].data();
      m.texture = &texture;
    }
    m.solid_colors = {Vec3(0.9F), Vec3(0.2F)};
    if (look == kMarble) m.solid = SolidTexture::kMarble;
    if (look == kWood) m.solid = SolidTexture::kWood;
    scene.triangles = triangles;
    scene.surfaces = surfaces;
    scene.materials = materials;
    scene.lights[0] = {glm::normalize(Vec3(0.4F, 0.7F, 0.6F)), Vec3(0.7F)};
    scene.lights[1] = {glm::normalize(Vec3(-0.8F, 0.1F, 0.3F)), Vec3(0.2F)};
    scene.light_count = 2;
    scene.ambient_sky = Vec3(0.2F);
    scene.ambient_ground = Vec3(0.1F);
  }
};

// Memory would allow memory_ns_per_pixel: a record per triangle, its pixels' numbers, and the colours. The rest is
// instructions (700 for AVX-512 and 16 pixels, smooth, with highlights and several triangles).
void shadeFrame(benchmark::State& state) {
  const Workload work(static_cast<int>(state.range(1)), static_cast<Look>(state.range(0)));
  Image8 image(kWidth, kHeight);
  std::uint64_t pixels = 0;
  for (auto _ : state) {
    std::size_t tile = 0;
    for (int y0 = 0; y0 < kHeight; y0 += kTileSize)
      for (int x0 = 0; x0 < kWidth; x0 += kTileSize)
        pixels += shadeTile(work.scene, work.tiles[tile++], x0, y0, {&image, nullptr}).pixels_shaded;
  }
  if (pixels != state.iterations() * std::uint64_t{kWidth} * kHeight) throw std::logic_error("pixels are missing");
  state.counters["ns_per_pixel"] =
      benchmark::Counter(static_cast<double>(pixels) * 1e-9, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  const double triangles_per_pixel = static_cast<double>(work.triangles.size()) / (kWidth * kHeight);
  state.counters["memory_ns_per_pixel"] =
      1e9 * memorySeconds(
                {.read = sizeof(ShadeTriangle) * triangles_per_pixel + sizeof(std::uint32_t), .write = sizeof(Rgba8)});
}

void looksAndSizes(benchmark::internal::Benchmark* b) {
  b->ArgNames({"look", "side_px"})->Unit(benchmark::kMillisecond);
  for (const Look look : {kPlain, kSpecular, kFlat, kTextured, kMarble, kWood})
    for (const int side : {1, 2, 4, 64}) b->Args({look, side});
}
BENCHMARK(shadeFrame)->Name("raster/shadeTile")->Apply(looksAndSizes);

}  // namespace
}  // namespace sheaf::raster
