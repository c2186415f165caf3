// bench/pipeline: repeats one frame and counts what its stages cost.
#pragma once

#include <benchmark/benchmark.h>

#include <span>
#include <string>

#include "core/task_pool.h"
#include "pipeline/renderer.h"

namespace sheaf::pipeline {

inline constexpr int kBenchWidth = 1920;
inline constexpr int kBenchHeight = 1080;

/// Draws the frame once to warm up and then for every iteration of `state`. The counters `<stage>_ms` are cpu times per
/// frame, summed over threads. Returns the last frame.
inline Frame repeatFrame(benchmark::State& state, const PreparedScene& scene, const scenes::Camera& camera,
                         Culling culling, std::span<const Stage> stages, TaskPool& pool) {
  Renderer renderer(pool);
  RenderSettings settings;
  settings.width = kBenchWidth;
  settings.height = kBenchHeight;
  settings.culling = culling;
  Frame frame;
  renderer.render(scene, camera, settings, frame);
  StageTimes cpu;
  for (auto _ : state) {
    renderer.render(scene, camera, settings, frame);
    cpu += frame.cpu;
  }
  for (const Stage stage : stages)
    state.counters[std::string(kStageNames[static_cast<std::size_t>(stage)]) + "_ms"] =
        benchmark::Counter(static_cast<double>(cpu[stage]) / 1e6, benchmark::Counter::kAvgIterations);
  return frame;
}

}  // namespace sheaf::pipeline
