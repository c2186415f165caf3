// The geometry stage's kernels, culling, preparing, and whole frames of built-in scenes stage by stage.
#include <benchmark/benchmark.h>

#include <array>
#include <string>
#include <vector>

#include "bench/memory_bandwidth.h"
#include "bench/pipeline/frame_loop.h"
#include "core/task_pool.h"
#include "pipeline/cull.h"
#include "pipeline/prepare.h"
#include "pipeline/transform.h"
#include "scenes/builtin.h"
#include "scenes/camera.h"

namespace sheaf::pipeline {
namespace {

// 12 bytes read per vertex, the rest stays in the first-level cache: about 35 vector instructions per vector of
// vertices, so that it is bound by instructions up to some 10 GB/s.
void transformAndProject(benchmark::State& state) {
  const auto patches = static_cast<std::size_t>(state.range(0));
  grouping::VertexRuns vertices;
  vertices.full_stride = patches * kMaxPatchVertices;
  vertices.full.assign(3 * vertices.full_stride + grouping::kRunAlignment, 0.25F);
  for (std::uint32_t p = 0; p < patches; ++p) {
    vertices.patches.push_back({.first_run = p, .run_count = 1, .first_full = p * kMaxPatchVertices});
    vertices.runs.push_back({.vertex_count = kMaxPatchVertices});
  }
  Mat4 clip_from_object(1.0F);
  clip_from_object[3] = {0.1F, 0.2F, 0.3F, 2.0F};
  const Viewport viewport(kBenchWidth, kBenchHeight);
  static ProjectedVertices projected;
  for (auto _ : state)
    for (const grouping::PatchRuns& patch : vertices.patches) {
      transformPatch(vertices, patch, clip_from_object, viewport, projected);
      benchmark::DoNotOptimize(projected);
    }
  state.counters["vertices/s"] = benchmark::Counter(static_cast<double>(patches * kMaxPatchVertices),
                                                    benchmark::Counter::kIsIterationInvariantRate);
  countMemoryBound(state, "vertices/s", {.read = 3 * sizeof(float)});
}
BENCHMARK(transformAndProject)->Name("pipeline/transform")->ArgName("patches")->Arg(16)->Arg(16384);

struct Load {
  const char* name;
  const char* spec;
  Culling culling = Culling::kTree;
};

constexpr std::array<Load, 8> kLoads = {{{"sphere-1M", "sphere?n=289"},
                                         {"sphere-1M-flat", "sphere?n=289", Culling::kPatches},
                                         {"sphere-1M-classic", "sphere?n=289", Culling::kNone},
                                         {"sphere-100k", "sphere?n=91"},
                                         {"terrain-2M", "terrain?n=1001"},
                                         {"terrain-2M-flat", "terrain?n=1001", Culling::kPatches},
                                         {"city", "city?blocks=20"},
                                         {"gallery", "gallery"}}};

/// What a frame must move at least, if nothing that is binned stays in a cache: positions and corners of the triangles
/// that are drawn, the binned ones out and in again, normals, and the picture.
ItemBytes frameBytes(const Counters& counters) {
  const auto vertices = static_cast<double>(counters.vertices_transformed);
  const double binned = sizeof(raster::ShadeTriangle) * static_cast<double>(counters.triangles_binned) +
                        sizeof(raster::BinEntry) * static_cast<double>(counters.bin_entries);
  return {.read = vertices * (3 * sizeof(float) + sizeof(raster::VertexNormal)) +
                  3.0 * static_cast<double>(counters.triangles_assembled) + binned,
          .write = binned + sizeof(Rgba8) * kBenchWidth * kBenchHeight};
}

// Whole frames with the times of their stages (cpu, summed over threads) as counters, and the time that one thread
// would need to move their bytes.
void drawFrame(benchmark::State& state, const Load& load, int threads) {
  TaskPool pool(threads);
  scenes::Scene scene = scenes::buildBuiltin(load.spec);
  const double aspect = static_cast<double>(kBenchWidth) / kBenchHeight;
  scenes::Camera camera = scene.cameras.empty()
                              ? scenes::fitCamera(scene, scenes::namedView("iso"), aspect, radians(40.0), false)
                              : scene.cameras.front();
  camera = scenes::fitClipPlanes(camera, scenes::boundsOf(scene));
  if (scene.lights.empty()) scenes::addDefaultLights(scene, camera);
  const PreparedScene prepared = prepareScene(std::move(scene), pool);
  constexpr std::array kStages = {Stage::kCull,     Stage::kTransform, Stage::kClip,
                                  Stage::kSetupBin, Stage::kRaster,    Stage::kShade};
  const Frame frame = repeatFrame(state, prepared, camera, load.culling, kStages, pool);
  state.counters["binned"] = static_cast<double>(frame.counters.triangles_binned);
  state.counters["pixels"] = static_cast<double>(frame.counters.pixels_shaded);
  state.counters["memory_ms"] = 1e3 * memorySeconds(frameBytes(frame.counters));
}

// A mesh's way from plain arrays to patches.
void prepare(benchmark::State& state) {
  TaskPool pool(static_cast<int>(state.range(0)));
  const scenes::Scene scene = scenes::buildBuiltin("sphere?n=289");
  for (auto _ : state) benchmark::DoNotOptimize(prepareScene(scene, pool));
  state.counters["triangles/s"] =
      benchmark::Counter(static_cast<double>(scene.triangleCount()), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(prepare)
    ->Name("pipeline/prepare/sphere-1M")
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

const int kRegistered = [] {
  for (const Load& load : kLoads)
    for (const int threads : {1, 2})
      benchmark::RegisterBenchmark(
          (std::string("pipeline/frame/") + load.name + "/threads:" + std::to_string(threads)).c_str(),
          [&load, threads](benchmark::State& state) { drawFrame(state, load, threads); })
          ->UseRealTime()
          ->Unit(benchmark::kMillisecond);
  return 0;
}();

}  // namespace
}  // namespace sheaf::pipeline
