// The geometry stage with and without vertex groups: kernels by length of run, and stages of whole frames.
#include <benchmark/benchmark.h>

#include <array>
#include <string>

#include "bench/pipeline/frame_loop.h"
#include "core/task_pool.h"
#include "pipeline/transform.h"
#include "scenes/builtin.h"
#include "scenes/camera.h"

namespace sheaf::pipeline {
namespace {

using grouping::ParameterForm;
using grouping::RunKind;

// A patch of 256 vertices in runs of equal length, in the first-level cache.
grouping::VertexRuns patchOfRuns(RunKind kind, ParameterForm form, std::uint32_t length) {
  grouping::VertexRuns runs;
  runs.form = form;
  runs.step = 1.0F / 65536.0F;
  runs.lines = {{Vec3(0.1F), Vec3(0.2F), 0.0F, 1e-5F}};
  runs.full.assign(3 * kVertexSlots, 0.25F);
  runs.quantised.assign(kVertexSlots, 1234);
  runs.parameters.assign(kVertexSlots, Vec2(0.25F));
  const std::uint32_t count = kMaxPatchVertices / length;
  runs.full_stride = kVertexSlots;
  runs.patches.push_back({.run_count = count});
  for (std::uint32_t r = 0; r < count; ++r)
    runs.runs.push_back({.kind = kind,
                         .axis = static_cast<std::uint8_t>(kind == RunKind::kLine ? 0 : r % 3),
                         .vertex_count = static_cast<std::uint16_t>(length),
                         .plane = 0.5F,
                         .line = 0});
  return runs;
}

void transformRuns(benchmark::State& state, RunKind kind, ParameterForm form) {
  const auto length = static_cast<std::uint32_t>(state.range(0));
  const grouping::VertexRuns runs = patchOfRuns(kind, form, length);
  Mat4 clip_from_object(1.0F);
  clip_from_object[3] = {0.1F, 0.2F, 0.3F, 2.0F};
  static ProjectedVertices projected;
  for (auto _ : state) {
    transformPatch(runs, runs.patches[0], clip_from_object, Viewport(1920, 1080), projected);
    benchmark::DoNotOptimize(projected);
    benchmark::ClobberMemory();
  }
  state.counters["vertices/s"] =
      benchmark::Counter(kMaxPatchVertices / length * length, benchmark::Counter::kIsIterationInvariantRate);
}

struct Load {
  const char* name;
  const char* spec;
};
constexpr std::array<Load, 4> kLoads = {{{"sphere-1M", "sphere?n=289"},
                                         {"sphere-12M", "sphere?n=1000"},
                                         {"terrain-8M", "terrain?n=2000"},
                                         {"teapot", "teapot"}}};

struct Way {
  const char* name;
  Culling culling;
  Grouping method;
  bool use_groups;
  ParameterForm form;
};
constexpr std::array<Way, 5> kWays = {{{"classic", Culling::kNone, Grouping::kNone, false, ParameterForm::k16Bit},
                                       {"modern", Culling::kPatches, Grouping::kNone, false, ParameterForm::k16Bit},
                                       {"snapped", Culling::kTree, Grouping::kPlanar, false, ParameterForm::k16Bit},
                                       {"planar16", Culling::kTree, Grouping::kPlanar, true, ParameterForm::k16Bit},
                                       {"planarF", Culling::kTree, Grouping::kPlanar, true, ParameterForm::kFloat}}};

// CPU time of the stages, one thread. `closeness` 0: the whole scene in view; towards 1: the eye near the middle.
void drawFrame(benchmark::State& state, const Load& load, const Way& way, double closeness) {
  TaskPool pool(1);
  scenes::Scene scene = scenes::buildBuiltin(load.spec);
  const double aspect = static_cast<double>(kBenchWidth) / kBenchHeight;
  scenes::Camera camera = scenes::fitCamera(scene, scenes::namedView("iso"), aspect, radians(40.0), false);
  const Box3 box = scenes::boundsOf(scene);
  camera.eye = glm::mix(camera.eye, camera.target, closeness);
  camera = scenes::fitClipPlanes(camera, box);
  scenes::addDefaultLights(scene, camera);
  GroupingOptions options;
  options.method = way.method;
  options.use_groups = way.use_groups;
  options.form = way.form;
  options.prefer = Prefer::kMemory;  // or smaller meshes were drawn in full
  const PreparedScene prepared = prepareScene(std::move(scene), pool, options);
  constexpr std::array kStages = {Stage::kCull, Stage::kTransform, Stage::kClip, Stage::kSetupBin};
  const Frame frame = repeatFrame(state, prepared, camera, way.culling, kStages, pool);
  const PreparedMesh& mesh = prepared.meshes[0];
  state.counters["bytes/vertex"] = static_cast<double>(mesh.vertexBytes()) / static_cast<double>(mesh.vertex_count);
  state.counters["runs/patch"] =
      static_cast<double>(mesh.vertices.runs.size()) / static_cast<double>(mesh.patches.size());
  state.counters["vertices"] = static_cast<double>(frame.counters.vertices_transformed);
  state.counters["binned"] = static_cast<double>(frame.counters.triangles_binned);
}

const int kRegistered = [] {
  const std::pair<const char*, RunKind> kinds[] = {
      {"full", RunKind::kFull}, {"plane", RunKind::kPlane}, {"line", RunKind::kLine}};
  const std::pair<const char*, ParameterForm> forms[] = {{"16bit", ParameterForm::k16Bit},
                                                         {"float", ParameterForm::kFloat}};
  for (const auto& [kind_name, kind] : kinds)
    for (const auto& [form_name, form] : forms) {
      if (kind == RunKind::kFull && form == ParameterForm::k16Bit) continue;
      auto* const bench =
          benchmark::RegisterBenchmark((std::string("pipeline/transform_runs/") + kind_name + "/" + form_name).c_str(),
                                       [kind, form](benchmark::State& state) { transformRuns(state, kind, form); });
      bench->ArgName("length")->RangeMultiplier(2)->Range(4, 256);
    }
  for (const Load& load : kLoads)
    for (const auto& [view, closeness] : {std::pair{"whole", 0.0}, {"close", 0.75}})
      for (const Way& way : kWays)
        benchmark::RegisterBenchmark(
            (std::string("pipeline/grouping/") + load.name + "/" + view + "/" + way.name).c_str(),
            [&load, &way, closeness](benchmark::State& state) { drawFrame(state, load, way, closeness); })
            ->Unit(benchmark::kMillisecond);
  return 0;
}();

}  // namespace
}  // namespace sheaf::pipeline
