// Set-up, binning and coverage by triangle size, one thread. A note on what to expect stands with each benchmark.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <vector>

#include "bench/memory_bandwidth.h"
#include "raster/bins.h"
#include "raster/setup.h"
#include "raster/tile.h"

namespace sheaf::raster {
namespace {

constexpr int kWidth = 1920;
constexpr int kHeight = 1080;
constexpr std::uint32_t kPatchTriangles = 80;

/// Front-facing triangles with legs of `size` pixels, turned at random, in patches that lie together as in a mesh.
struct Workload {
  std::vector<ScreenVertex> vertices;
  std::array<std::vector<std::uint8_t>, 3> corner;
  std::vector<std::uint32_t> source;
  std::uint32_t patches;

  Workload(double size, std::uint32_t patch_count) : patches(patch_count) {
    std::mt19937 rng(1);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (std::uint32_t p = 0; p < patches; ++p) {
      const double cx = unit(rng) * kWidth;
      const double cy = unit(rng) * kHeight;
      for (std::uint32_t t = 0; t < kPatchTriangles; ++t) addTriangle(rng, cx, cy, size);
    }
    for (std::uint32_t t = 0; t < kPatchTriangles; ++t) {
      source.push_back(t);
      for (std::uint32_t k = 0; k < 3; ++k) corner[k].push_back(static_cast<std::uint8_t>(3 * t + k));
    }
    for (auto& c : corner) c.resize(kPatchTriangles + 16, 0);
  }

  void addTriangle(std::mt19937& rng, double cx, double cy, double size) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double spread = size * 8.0;
    const double x = cx + spread * (unit(rng) - 0.5);
    const double y = cy + spread * (unit(rng) - 0.5);
    const double turn = 6.28 * unit(rng);
    const auto z = static_cast<float>(unit(rng));
    for (const double angle : {turn, turn - 1.5708})
      addVertex(x + size * std::cos(angle), y + size * std::sin(angle), z);
    addVertex(x, y, z);
  }
  void addVertex(double x, double y, float z) {
    vertices.push_back({static_cast<std::int32_t>(x * kSubpixels), static_cast<std::int32_t>(y * kSubpixels), z, 1.0F});
  }

  SetupCounts setUp(Binner& binner) const {
    SetupCounts counts;
    PatchTriangles triangles;
    triangles.corner = {corner[0].data(), corner[1].data(), corner[2].data()};
    triangles.source = source.data();
    triangles.count = kPatchTriangles;
    for (std::uint32_t p = 0; p < patches; ++p) {
      const std::size_t first = std::size_t{p} * 3 * kPatchTriangles;
      triangles.first_vertex = static_cast<std::uint32_t>(first);
      setupTriangles(&vertices[first], triangles, binner, counts);
    }
    return counts;
  }
};

double sizeOf(const benchmark::State& state) {
  return static_cast<double>(state.range(0)) / 10.0;
}

std::uint32_t patchesFor(double size) {
  return size > 50.0 ? 20 : size > 10.0 ? 200 : 2000;
}

/// Bytes of a binned triangle: its record, its entries, and its edges if it is large.
double binnedBytes(const Binner& binner, const SetupCounts& counts, double size) {
  const double large = size > 4.0 ? sizeof(LargeTriangle) : 0.0;
  const double entries = static_cast<double>(binner.entryCount()) / static_cast<double>(counts.binned);
  return sizeof(ShadeTriangle) + large + entries * sizeof(BinEntry);
}

// Up to 4x4 pixels: bound by the instructions of the kernel (1100 for AVX-512, for 16 triangles) and not by the 96
// bytes that a binned one takes, as memory_triangles/s shows; beyond, by the bins of every tile that it touches.
void setUpAndBin(benchmark::State& state) {
  const Workload work(sizeOf(state), patchesFor(sizeOf(state)));
  ShadeTriangleArena arena;
  Binner binner;
  SetupCounts counts;
  for (auto _ : state) {
    arena.reset(std::uint64_t{work.patches} * kPatchTriangles, 1);
    binner.reset(kWidth, kHeight, arena);
    counts = work.setUp(binner);
  }
  const std::uint64_t triangles = std::uint64_t{work.patches} * kPatchTriangles;
  if (counts.binned + counts.no_sample + counts.back_facing != triangles) throw std::logic_error("triangles got lost");
  state.counters["triangles/s"] =
      benchmark::Counter(static_cast<double>(triangles), benchmark::Counter::kIsIterationInvariantRate);
  const double binned = static_cast<double>(counts.binned) / static_cast<double>(triangles);
  state.counters["binned"] = binned;
  countMemoryBound(state, "triangles/s", {.write = binned * binnedBytes(binner, counts, sizeOf(state))});
}

// Small triangles: their pixels, one by one, and the entry comes from memory. Large ones: 8 bytes read and up to 8
// written per pixel, all within a tile of 32 KB in the first-level cache.
void rasterize(benchmark::State& state) {
  const Workload work(sizeOf(state), patchesFor(sizeOf(state)));
  ShadeTriangleArena arena;
  Binner binner;
  arena.reset(std::uint64_t{work.patches} * kPatchTriangles, 1);
  binner.reset(kWidth, kHeight, arena);
  const SetupCounts counts = work.setUp(binner);
  static TileVisibility tile;
  for (auto _ : state)
    for (int i = 0; i < binner.tilesX() * binner.tilesY(); ++i) {
      const TileEntries entries[] = {{binner.tile(i), binner.largeTriangles()}};
      rasterTile(entries, arena.data(), i % binner.tilesX() * kTileSize, i / binner.tilesX() * kTileSize, tile);
      benchmark::DoNotOptimize(tile);
    }
  const double size = sizeOf(state);
  const double pixels = static_cast<double>(counts.binned) * size * size / 2.0;
  state.counters["triangles/s"] =
      benchmark::Counter(static_cast<double>(counts.binned), benchmark::Counter::kIsIterationInvariantRate);
  state.counters["pixels/s"] = benchmark::Counter(pixels, benchmark::Counter::kIsIterationInvariantRate);
  countMemoryBound(state, "triangles/s", {.read = binnedBytes(binner, counts, size) - sizeof(ShadeTriangle)});
}

void sizes(benchmark::internal::Benchmark* b) {
  for (const int tenth_px : {5, 10, 20, 40, 80, 160, 500, 1500, 5000}) b->Arg(tenth_px);
  b->ArgName("tenth_px")->Unit(benchmark::kMillisecond);
}
BENCHMARK(setUpAndBin)->Name("raster/setUpAndBin")->Apply(sizes);
BENCHMARK(rasterize)->Name("raster/rasterTile")->Apply(sizes);

}  // namespace
}  // namespace sheaf::raster
