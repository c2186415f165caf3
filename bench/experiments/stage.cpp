// The geometry stage as sheaf draws with it: vectors, patches, culling.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "bench/experiments/experiment.h"
#include "bench/experiments/rounds.h"
#include "bench/experiments/table.h"
#include "mesh/normals.h"
#include "pipeline/baselines.h"
#include "pipeline/prepare.h"
#include "pipeline/renderer.h"
#include "pipeline/transform.h"
#include "scenes/builtin.h"
#include "scenes/camera.h"
#include "scenes/camera_path.h"

namespace sheaf::experiments {
namespace {

constexpr const char* kKernelVerdict =
    "*Vectors.* To clip space a vertex on a plane costs 0.7 of a full one, not 0.45 as without vectors. *Stores "
    "and projection* are the larger part: to the screen, with a division and vertices stored whole for the "
    "set-up, costs 0.2 ns more for full vertices and 0.3 ns for grouped ones, whose runs do not fill the last "
    "vector and begin anywhere in a cache line: what groups save before, they lose here. *Bandwidth*: reading 12 "
    "bytes takes 0.33 ns and 4 bytes 0.15, but that hides behind the arithmetic: from memory the full transform "
    "to the screen is only a tenth slower than from caches. One thread is bound by the stores and shuffles of "
    "projected vertices. *Clock*: two tenths of what a patch of 256 vertices costs.\n\n";
constexpr const char* kLargeVerdict = "";
constexpr const char* kSweepVerdict = "";
constexpr const char* kVisibleVerdict =
    "**Neither bound is met.** At 10 % in view grouped drawing takes 1.4 to 1.7 times less than classic for the "
    "whole geometry stage, not 5 times: setting up the triangles in view, the same for all, is most of it "
    "(transform and clip together: 4 to 5.5 times on the large meshes). Against modern it gains only on the "
    "terrain with 5 % in view (1.39 times), where groups drop triangles before set-up, is even at 10 %, and "
    "**loses 10 to 25 % on the scanned models**: patches that reach over the edges of the picture have their "
    "groups tested and their triangles sorted, and set-up gets them in shorter pieces, which costs more than it "
    "saves.\n\n";
constexpr const char* kFramesVerdict = "";

using pipeline::Grouping;
using pipeline::GroupingOptions;
using pipeline::ParameterForm;
using pipeline::PreparedMesh;
using pipeline::PreparedScene;

constexpr int kWidth = 1920, kHeight = 1080;
constexpr double kAspect = static_cast<double>(kWidth) / kHeight;

scenes::Scene sceneOf(const mesh::Mesh& mesh) {
  scenes::Scene scene;
  scene.meshes.push_back(mesh);
  mesh::makeSmoothNormals(scene.meshes[0], kPi);
  scene.materials.emplace_back();
  scene.instances.emplace_back();
  return scene;
}

scenes::Scene litScene(scenes::Scene scene) {
  const scenes::Camera camera = scenes::fitCamera(scene, scenes::namedView("iso"), kAspect, radians(40.0), false);
  if (scene.lights.empty()) scenes::addDefaultLights(scene, camera);
  return scene;
}

/// `name` of a model, with a number of vertices or whole (0), or builtin:...
scenes::Scene loadAny(Context& context, const std::string& name, std::size_t vertices = 0) {
  if (name.starts_with("builtin:")) return litScene(scenes::buildBuiltin(name.substr(8)));
  return litScene(sceneOf(vertices == 0 ? context.models.whole(name) : context.models.lod(name, vertices)));
}

PreparedScene prepared(const scenes::Scene& scene, Grouping method, bool use_groups, ParameterForm form,
                       TaskPool& pool) {
  GroupingOptions options;
  options.method = method;
  options.use_groups = use_groups;
  options.form = form;
  return pipeline::prepareScene(scene, pool, options);
}

std::uint64_t vertexCount(const PreparedScene& scene) {
  std::uint64_t count = 0;
  for (const scenes::Instance& instance : scene.instances) count += scene.meshes[instance.mesh].vertex_count;
  return count;
}

/// Medians over the frames, milliseconds of wall time.
struct Frames {
  Spread frame;
  Spread transform_clip;
  Spread geometry;
  pipeline::Counters counters;
};

double ms(const StageTimes& times, std::initializer_list<Stage> stages) {
  std::int64_t sum = 0;
  for (const Stage stage : stages) sum += times[stage];
  return 1e-6 * static_cast<double>(sum);
}

// Frame by frame in turns; each way draws once untimed before it is timed, so that it finds its own data in the caches.
std::vector<Frames> drawInTurns(const std::vector<const PreparedScene*>& ways,
                                const std::vector<scenes::Camera>& cameras, int frames, TaskPool& pool) {
  pipeline::Renderer renderer(pool);
  pipeline::RenderSettings settings;
  settings.width = kWidth;
  settings.height = kHeight;
  std::vector<pipeline::Frame> drawn(ways.size());
  std::vector<std::array<std::vector<double>, 3>> times(ways.size());
  std::vector<Frames> result(ways.size());
  for (int f = 0; f < frames; ++f)
    for (std::size_t w = 0; w < ways.size(); ++w) {
      const scenes::Camera& camera = cameras[static_cast<std::size_t>(f) % cameras.size()];
      for (int i = 0; i < 2; ++i) renderer.render(*ways[w], camera, settings, drawn[w]);
      times[w][0].push_back(1e-6 * static_cast<double>(drawn[w].wall_ns));
      times[w][1].push_back(ms(drawn[w].wall, {Stage::kTransform, Stage::kClip}));
      times[w][2].push_back(ms(drawn[w].wall, {Stage::kCull, Stage::kTransform, Stage::kClip, Stage::kSetupBin}));
      result[w].counters = drawn[w].counters;
    }
  for (std::size_t w = 0; w < ways.size(); ++w) {
    result[w].frame = spreadOf(times[w][0]);
    result[w].transform_clip = spreadOf(times[w][1]);
    result[w].geometry = spreadOf(times[w][2]);
  }
  return result;
}

scenes::Camera wholeView(const scenes::Scene& scene) {
  return scenes::fitClipPlanes(scenes::fitCamera(scene, scenes::namedView("iso"), kAspect, radians(40.0), false),
                               scenes::boundsOf(scene));
}

std::string spreadText(const Spread& s) {
  return fmt::format("{} [{}, {}]", rounded(s.median), rounded(s.lower), rounded(s.upper));
}

struct Load {
  std::string name;
  std::size_t vertices = 0;
  int frames = 0;
};

// The snapped mesh without groups against the same with them, everything in view; a row for one thread and one for two.
void addStageRows(Context& context, const Load& load, ParameterForm form, Table& table) {
  const scenes::Scene scene = loadAny(context, load.name, load.vertices);
  const PreparedScene full = prepared(scene, Grouping::kPlanar, false, form, context.pool);
  const PreparedScene grouped = prepared(scene, Grouping::kPlanar, true, form, context.pool);
  const PreparedMesh& mesh = grouped.meshes[0];
  for (const int threads : {1, 2}) {
    TaskPool pool(threads);
    const std::vector<Frames> f = drawInTurns({&full, &grouped}, {wholeView(scene)}, load.frames, pool);
    table.add({fmt::format("{}{}, {}", load.name, form == ParameterForm::k16Bit ? "" : ", float", threads),
               fmt::format("{}", vertexCount(full)),
               fmt::format("{:.1f}", static_cast<double>(mesh.vertices.runs.size()) / double(mesh.patches.size())),
               fmt::format("{:.1f}", static_cast<double>(mesh.vertexBytes()) / static_cast<double>(mesh.vertex_count)),
               spreadText(f[0].transform_clip), spreadText(f[1].transform_clip),
               fmt::format("{:.2f}", f[0].transform_clip.median / f[1].transform_clip.median),
               fmt::format("{:.2f}", f[0].geometry.median / f[1].geometry.median)});
  }
}

const std::vector<std::string> kStageHead = {"mesh, threads",    "patch vertices",      "runs per patch",
                                             "bytes per vertex", "ungrouped ms",        "grouped ms",
                                             "times as fast",    "whole geometry stage"};

// --- the kernels by themselves ---

volatile double g_sink;  // keeps what is only read

/// Nanoseconds per vertex of passes over all patches of a mesh, or over its first ones, which stay in the caches.
struct KernelTimes {
  Spread to_screen;  ///< as a frame does it: projected, stored as 16 bytes
  Spread to_clip;    ///< transformed only, four floats
  Spread read;       ///< the same memory, only read
};

KernelTimes timeKernels(const PreparedMesh& mesh, std::size_t patches, int rounds) {
  static pipeline::ProjectedVertices projected;
  static pipeline::ClipVertices clip;
  const grouping::VertexRuns& runs = mesh.vertices;
  Mat4 m(1.0F);
  m[3] = {0.1F, 0.2F, 0.3F, 2000.0F};
  std::uint64_t vertices = 0;
  for (std::size_t p = 0; p < patches; ++p)
    for (std::uint32_t r = 0; r < runs.patches[p].run_count; ++r)
      vertices += runs.runs[runs.patches[p].first_run + r].vertex_count;
  const int calls = std::max(1, static_cast<int>(200'000 / vertices));
  const pipeline::Viewport viewport(kWidth, kHeight);
  const auto to_screen = [&] {
    for (std::size_t p = 0; p < patches; ++p) pipeline::transformPatch(runs, runs.patches[p], m, viewport, projected);
  };
  const auto to_clip = [&] {
    for (std::size_t p = 0; p < patches; ++p) {
      pipeline::RunStart start(runs.patches[p]);
      for (std::uint32_t r = 0; r < runs.patches[p].run_count; ++r) {
        const grouping::VertexRun& run = runs.runs[runs.patches[p].first_run + r];
        pipeline::transformRun(runs, runs.patches[p], run, start, 0, run.vertex_count, m, clip);
        start.skip(run);
      }
    }
  };
  const bool all = patches == runs.patches.size();
  const auto read = [&] {
    std::uint32_t bits = 0;
    for (const std::uint32_t q : runs.quantised) bits += q;
    float sums[16] = {};
    for (std::size_t i = 0; i + 16 <= runs.full.size(); i += 16)
      for (std::size_t k = 0; k < 16; ++k) sums[k] += runs.full[i + k];
    for (std::size_t i = 0; i + 8 <= runs.parameters.size(); i += 8)
      for (std::size_t k = 0; k < 8; ++k)
        sums[2 * k] += runs.parameters[i + k].x, sums[2 * k + 1] += runs.parameters[i + k].y;
    g_sink = std::accumulate(std::begin(sums), std::end(sums), static_cast<double>(bits));
  };
  std::vector<std::function<void()>> ways = {to_screen, to_clip};
  if (all) ways.emplace_back(read);
  std::vector<Spread> spreads = timeInTurns(ways, rounds, calls, 1);
  for (Spread& s : spreads) {
    const double n = static_cast<double>(vertices);
    s = {s.median / n, s.lower / n, s.upper / n};
  }
  return {spreads[0], spreads[1], all ? spreads[2] : Spread{}};
}

void addKernelRow(const std::string& name, const PreparedScene& scene, Table& table) {
  const PreparedMesh& mesh = scene.meshes[0];
  constexpr std::size_t kCached = 16;  // patches: 49 KB of floats at most, in the second-level cache
  const KernelTimes beyond = timeKernels(mesh, mesh.patches.size(), 15);
  const KernelTimes cached = timeKernels(mesh, std::min(kCached, mesh.patches.size()), 51);
  table.add({name, fmt::format("{:.3f}", cached.to_clip.median), fmt::format("{:.3f}", cached.to_screen.median),
             fmt::format("{:.3f}", beyond.to_clip.median), fmt::format("{:.3f}", beyond.to_screen.median),
             fmt::format("{:.3f}", beyond.read.median)});
}

}  // namespace

std::string writeKernels(Context& context) {
  Table kernels({"terrain", "cached, to clip space", "cached, to the screen", "from memory, to clip space",
                 "from memory, to the screen", "memory only read"});
  {
    const scenes::Scene scene = loadAny(context, "builtin:terrain?n=2048");
    for (const ParameterForm form : {ParameterForm::k16Bit, ParameterForm::kFloat}) {
      const bool is_16 = form == ParameterForm::k16Bit;
      if (is_16)
        addKernelRow("ungrouped, 12 bytes", prepared(scene, Grouping::kPlanar, false, form, context.pool), kernels);
      addKernelRow(is_16 ? "planar, 4 bytes" : "planar, 8 bytes",
                   prepared(scene, Grouping::kPlanar, true, form, context.pool), kernels);
    }
  }
  volatile std::int64_t last = 0;
  const Spread clock = timeInTurns({[&] { last = nowNs(); }}, 51, 1000, 1000)[0];
  return fmt::format(
             "Machine: {}. **The kernels by themselves**, nanoseconds per vertex over all patches of a terrain of 4 M "
             "vertices (from "
             "memory) or the first 16 of them (cached); results go to the same few kilobytes each time, as in a "
             "frame. One reading of the clock takes {:.0f} ns here; a frame reads it once for each stage of each "
             "patch.\n\n",
             machineText(), clock.median) +
         kernels.text() + kKernelVerdict;
}

std::string writeLarge(Context& context) {
  Table large(kStageHead);
  for (const std::string name : {"builtin:terrain?n=2048", "builtin:sphere?n=836"})
    for (const ParameterForm form : {ParameterForm::k16Bit, ParameterForm::kFloat})
      addStageRows(context, {name, 0, 11}, form, large);
  return fmt::format(
             "Frames with everything in view: the snapped mesh drawn without groups and with planar ones, in turns; "
             "wall time of transform and clipping, medians and quartiles. Machine: {}.\n\n",
             machineText()) +
         large.text() + kLargeVerdict;
}

std::string writeSweep(Context& context) {
  Table sweep(kStageHead);
  for (const Load& load : std::vector<Load>{{"cow", 300, 100},
                                            {"jet", 300, 100},
                                            {"cow", 1000, 100},
                                            {"bunny", 3000, 100},
                                            {"bunny", 10000, 80},
                                            {"bunny", 0, 60},
                                            {"armadillo", 0, 30},
                                            {"dragon", 0, 20},
                                            {"builtin:teapot", 0, 60},
                                            {"builtin:terrain?n=256", 0, 40},
                                            {"builtin:sphere?n=289", 0, 15}})
    addStageRows(context, load, ParameterForm::k16Bit, sweep);
  return fmt::format("As above, 16-bit parameters, small meshes too. Machine: {}.\n\n", machineText()) + sweep.text() +
         kSweepVerdict;
}

std::string writeVisible(Context& context) {
  Table table({"scene, triangles in view %", "stage", "classic ms", "modern ms", "grouped ms", "against classic",
               "against modern"});
  for (const std::string name : {"builtin:terrain?n=1024", "bunny", "dragon"}) {
    const scenes::Scene scene = loadAny(context, name);
    pipeline::RenderSettings settings;
    settings.width = kWidth;
    settings.height = kHeight;
    GroupingOptions grouping;
    grouping.method = Grouping::kPlanar;
    pipeline::BaselineBench bench(scene, grouping, settings, context.pool);
    for (const double share : {0.05, 0.10, 0.25, 0.50}) {
      scenes::PathOptions path;
      path.azimuth_rad = radians(30.0);
      path.elevation_rad = radians(20.0);
      path.aspect = kAspect;
      const scenes::InsideView view = scenes::insideView(scene, share, path);
      const pipeline::BaselineRun run = bench.run(std::span(&view.camera, 1), 31, [](double) {});
      for (const pipeline::BaselineRow& row : pipeline::summarize(run, bench.vertexCount())) {
        if (row.name != "cull" && row.name != "transform" && row.name != "clip" && row.name != "setup+bin" &&
            row.name != "geometry")
          continue;
        const auto median = [&](std::size_t way) { return rounded(row.wall_ms[way].median); };
        const auto ratio = [&](std::size_t way) { return fmt::format("{:.2f}", row.speedup[way].median); };
        table.add({row.name == "cull" ? fmt::format("{}, {}", name, percent(view.share_in_view)) : "", row.name,
                   median(0), median(1), median(2), ratio(0), ratio(1)});
      }
    }
  }
  return fmt::format(
             "One thread, medians of 31 frames in turns from a camera inside the scene. *Classic* transforms every "
             "vertex; *modern* leaves out patches; *grouped* tests groups too. Machine: {}. "
             "`sheaf bench SCENE --views inside` measures the same.\n\n",
             machineText()) +
         table.text() + kVisibleVerdict;
}

std::string writeFrames(Context& context) {
  Table table(
      {"scene", "original ms", "snapped, ungrouped ms", "grouped ms", "gain over snapped %", "gain over original %"});
  std::vector<std::string> names;
  for (const scenes::BuiltinInfo& info : scenes::builtinScenes()) names.push_back("builtin:" + info.name);
  for (const char* const model : {"cow", "bunny", "armadillo", "dragon", "jet"}) names.emplace_back(model);
  for (const std::string& name : names) {
    const scenes::Scene scene = loadAny(context, name);
    const PreparedScene original = prepared(scene, Grouping::kNone, false, ParameterForm::k16Bit, context.pool);
    const PreparedScene snapped = prepared(scene, Grouping::kPlanar, false, ParameterForm::k16Bit, context.pool);
    const PreparedScene grouped = prepared(scene, Grouping::kPlanar, true, ParameterForm::k16Bit, context.pool);
    scenes::PathOptions path;
    path.azimuth_rad = radians(30.0);
    path.elevation_rad = radians(20.0);
    path.aspect = kAspect;
    const std::vector<scenes::Camera> cameras = scenes::orbitPath(scene, 4, path);
    const std::vector<Frames> f = drawInTurns({&original, &snapped, &grouped}, cameras, 20, context.pool);
    const auto gain = [&](std::size_t way) { return percent(f[way].frame.median / f[2].frame.median - 1.0); };
    table.add({name, spreadText(f[0].frame), spreadText(f[1].frame), spreadText(f[2].frame), gain(1), gain(0)});
  }
  return fmt::format(
             "Whole frames of 1920x1080, one thread, an orbit of 4 cameras, medians and quartiles of 20 frames in "
             "turns. "
             "Machine: {}.\n\n",
             machineText()) +
         table.text() + kFramesVerdict;
}

}  // namespace sheaf::experiments
