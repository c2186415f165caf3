// The geometry stage as sheaf draws with it: vectors, patches, culling.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "bench/experiments/experiment.h"
#include "bench/experiments/lit_scene.h"
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
    "*Vectors.* To clip space a vertex on a plane costs as much as one in full, not 0.45 of it as without "
    "vectors: what it saves in products goes into unpacking parameters and into runs that do not fill their last "
    "vector. *Division, rounding and stores* are half of what a full vertex costs, the same for both. From caches "
    "grouped vertices therefore take a quarter longer; in runs of 256 both take 0.31 ns (`scripts/bench pipeline "
    "--benchmark_filter=transform_runs`). *Bandwidth* is the one thing that planes save: only to read 12 bytes "
    "takes 0.42 ns, 4 bytes 0.16. From memory the full transform takes a third longer than from caches, by planes "
    "a tenth, and they are equal. *Clock*: a third of what the kernel takes for a patch.\n\n";
constexpr const char* kLargeVerdict =
    "**1.5 times as fast is not reached**: with 16-bit parameters groups make transform and clipping 1.00 to "
    "1.09 times as fast. The next patch's vertices are asked for while one is set up, so that neither way "
    "waits much for memory, which is what planes could save. Without that the terrain took 4.6 ms in full and "
    "3.9 by planes, 1.18 times as fast, in place of 3.0 both ways. Of the 0.59 ns that a full vertex takes on "
    "the terrain, 0.29 are the kernel (0.15 of them division, rounding and stores) and 0.09 the clock. With "
    "its vertices read once more before the clock starts it takes 0.53, by planes 0.56. So groups can only "
    "save the 0.13 ns of sums before the division and less than 0.1 of waiting: were all of that free, they "
    "would be 1.6 times as fast. Storing shorter runs by planes (`--prefer memory`) makes vertices 40 to 42 % "
    "as large as positions in floats, and transform and clipping 0.91 to 0.93 times as fast. The whole "
    "geometry stage gains 3 to 5 %, most of it in set-up.\n\n";
constexpr const char* kSweepVerdict =
    "**Never slower than 0.95 times is kept**: 0.99 at least. Meshes of less than 900,000 patch vertices are "
    "stored in full even where they are grouped (`--prefer speed`, the default): what differs there is noise. "
    "By planes in runs of 120 and more the dragon, terrain?n=256 and sphere?n=289 were 0.91 to 0.96 times as "
    "fast.\n\n";
constexpr const char* kFramesVerdict =
    "**A whole frame gains nothing.** Against the same moved vertices drawn without groups the difference is "
    "-1.3 to +1.4 %, within the noise; most of these meshes are drawn in full either way. Against the original "
    "mesh every scene but three is slower, mostly by 2 %, the terrain by 7 % and the dragon by 12 %: not by "
    "groups, but because vertices that have moved make a mesh that costs more to draw, grouped or not.\n\n";
constexpr const char* kVisibleVerdict =
    "**Neither target is met.** At 10 % in view grouped drawing takes 1.3 to 1.7 times less than classic for "
    "the whole geometry stage, not 5 times: setting up the triangles in view, the same for all, is most of it. "
    "Transform and clipping together take 5.7 to 7.9 times less, with culling 3.3 to 6.4 times. Against "
    "modern, groups gain 1.36 times on the terrain with 5 % in view, where they drop triangles before set-up, "
    "nothing at 10 %, and 1.04 to 1.06 times beyond. **The scanned models lose 3 to 21 %**, though they are "
    "transformed and clipped as without groups: set-up takes up to a third longer for the moved vertices; why "
    "has not been found out.\n\n";

using pipeline::Grouping;
using pipeline::GroupingOptions;
using pipeline::ParameterForm;
using pipeline::Prefer;
using pipeline::PreparedMesh;
using pipeline::PreparedScene;

constexpr int kWidth = 1920, kHeight = 1080;
constexpr double kAspect = static_cast<double>(kWidth) / kHeight;

/// How vertices on planes are stored.
struct Storage {
  const char* name;  ///< as a row of a table is called, empty for the usual one
  ParameterForm form = ParameterForm::k16Bit;
  Prefer prefer = Prefer::kSpeed;
};
constexpr Storage kUsual = {""}, kSmall = {", for memory", ParameterForm::k16Bit, Prefer::kMemory},
                  kFloats = {", float", ParameterForm::kFloat};

PreparedScene prepared(const scenes::Scene& scene, Grouping method, bool use_groups, const Storage& storage,
                       TaskPool& pool) {
  GroupingOptions options;
  options.method = method;
  options.use_groups = use_groups;
  options.form = storage.form;
  options.prefer = storage.prefer;
  return pipeline::prepareScene(scene, pool, options);
}

std::uint64_t vertexCount(const PreparedScene& scene) {
  std::uint64_t count = 0;
  for (const scenes::Instance& instance : scene.instances) count += scene.meshes[instance.mesh].vertex_count;
  return count;
}

/// Over the turns, milliseconds of wall time per frame.
struct Frames {
  Spread frame;
  Spread transform_clip;
  Spread geometry;
  double transform_clip_ratio = 1.0;  ///< of the first way's time to this one's, turn by turn, the median
  double geometry_ratio = 1.0;
};

/// So many turns of so many frames in a row.
struct Turns {
  int count = 0;
  int frames = 1;
  int width = kWidth;
  int height = kHeight;
};

double ms(const StageTimes& times, std::initializer_list<Stage> stages) {
  std::int64_t sum = 0;
  for (const Stage stage : stages) sum += times[stage];
  return 1e-6 * static_cast<double>(sum);
}

double medianRatio(const std::vector<double>& first, const std::vector<double>& second) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < first.size(); ++i) ratios.push_back(first[i] / second[i]);
  return spreadOf(std::move(ratios)).median;
}

// Each way draws once untimed before its turn, so that it finds its own data in the caches.
std::vector<Frames> drawInTurns(const std::vector<const PreparedScene*>& ways,
                                const std::vector<scenes::Camera>& cameras, const Turns& turns, TaskPool& pool) {
  pipeline::Renderer renderer(pool);
  pipeline::RenderSettings settings;
  settings.width = turns.width;
  settings.height = turns.height;
  pipeline::Frame frame;
  std::vector<std::array<std::vector<double>, 3>> times(ways.size());
  for (int turn = 0; turn < turns.count; ++turn)
    for (std::size_t w = 0; w < ways.size(); ++w) {
      const scenes::Camera& camera = cameras[static_cast<std::size_t>(turn) % cameras.size()];
      renderer.render(*ways[w], camera, settings, frame);
      std::array<double, 3> sums{};
      for (int i = 0; i < turns.frames; ++i) {
        renderer.render(*ways[w], camera, settings, frame);
        sums[0] += 1e-6 * static_cast<double>(frame.wall_ns);
        sums[1] += ms(frame.wall, {Stage::kTransform, Stage::kClip});
        sums[2] += ms(frame.wall, {Stage::kCull, Stage::kTransform, Stage::kClip, Stage::kSetupBin});
      }
      for (std::size_t k = 0; k < 3; ++k) times[w][k].push_back(sums[k] / turns.frames);
    }
  std::vector<Frames> result(ways.size());
  for (std::size_t w = 0; w < ways.size(); ++w)
    result[w] = {spreadOf(times[w][0]), spreadOf(times[w][1]), spreadOf(times[w][2]),
                 medianRatio(times[0][1], times[w][1]), medianRatio(times[0][2], times[w][2])};
  return result;
}

scenes::Camera wholeView(const scenes::Scene& scene) {
  return scenes::fitClipPlanes(scenes::fitCamera(scene, scenes::namedView("iso"), kAspect, radians(40.0), false),
                               scenes::boundsOf(scene));
}

std::string spreadText(const Spread& s, double scale = 1.0) {
  return fmt::format("{} [{}, {}]", rounded(s.median * scale), rounded(s.lower * scale), rounded(s.upper * scale));
}

struct Load {
  std::string name;
  std::size_t vertices = 0;
};

// The snapped mesh without groups against the same with them, everything in view; a row for one thread and one for two.
// scale  of milliseconds
void addStageRows(Context& context, const Load& load, const Storage& storage, Turns turns, double scale, Table& table) {
  const scenes::Scene scene = litScene(context, load.name, load.vertices);
  const PreparedScene full = prepared(scene, Grouping::kPlanar, false, storage, context.pool);
  const PreparedScene grouped = prepared(scene, Grouping::kPlanar, true, storage, context.pool);
  const PreparedMesh& mesh = grouped.meshes[0];
  constexpr std::uint64_t kVerticesPerTurn = 200'000;
  if (turns.frames == 0)
    turns.frames = static_cast<int>(std::clamp<std::uint64_t>(kVerticesPerTurn / vertexCount(full), 1, 50));
  for (const int threads : {1, 2}) {
    TaskPool pool(threads);
    const std::vector<Frames> f = drawInTurns({&full, &grouped}, {wholeView(scene)}, turns, pool);
    table.add({fmt::format("{}{}, {}", load.name, storage.name, threads), fmt::format("{}", vertexCount(full)),
               fmt::format("{:.1f}", static_cast<double>(mesh.vertices.runs.size()) / double(mesh.patches.size())),
               fmt::format("{:.1f}", static_cast<double>(mesh.vertexBytes()) / static_cast<double>(mesh.vertex_count)),
               spreadText(f[0].transform_clip, scale), spreadText(f[1].transform_clip, scale),
               fmt::format("{:.2f}", f[1].transform_clip_ratio), fmt::format("{:.2f}", f[1].geometry_ratio)});
  }
}

std::vector<std::string> stageHead(const std::string& unit) {
  return {"mesh, threads",     "patch vertices",  "runs per patch", "bytes per vertex",
          "ungrouped " + unit, "grouped " + unit, "times as fast",  "whole geometry stage"};
}

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
        pipeline::transformRun(runs, runs.patches[p], {run, start, 0, run.vertex_count}, m, clip);
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

// Nanoseconds per vertex of what follows the transform: division, rounding and stores.
double timeProjection() {
  static pipeline::ProjectedVertices projected;
  static pipeline::ClipVertices clip;
  std::fill(std::begin(clip.w), std::end(clip.w), 2.0F);
  const pipeline::Viewport viewport(kWidth, kHeight);
  constexpr std::uint32_t kCount = pipeline::kMaxPatchVertices;
  const auto project = [&] { pipeline::projectVertices(clip, 0, kCount, viewport, projected); };
  return timeInTurns({project}, 51, 1000, 1000)[0].median / kCount;
}

}  // namespace

std::string writeKernels(Context& context) {
  Table kernels({"terrain", "cached, to clip space", "cached, to the screen", "from memory, to clip space",
                 "from memory, to the screen", "memory only read"});
  {
    const scenes::Scene scene = litScene(context, "builtin:terrain?n=2048");
    addKernelRow("ungrouped, 12 bytes", prepared(scene, Grouping::kPlanar, false, kUsual, context.pool), kernels);
    addKernelRow("planar, 4 bytes", prepared(scene, Grouping::kPlanar, true, kUsual, context.pool), kernels);
    addKernelRow("planar, 8 bytes", prepared(scene, Grouping::kPlanar, true, kFloats, context.pool), kernels);
  }
  volatile std::int64_t last = 0;
  const Spread clock = timeInTurns({[&] { last = nowNs(); }}, 51, 1000, 1000)[0];
  return fmt::format(
             "Machine: {}. **The kernels by themselves**, nanoseconds per vertex over all patches of a terrain of 4 M "
             "vertices (from "
             "memory) or the first 16 of them (cached); results go to the same few kilobytes each time, as in a "
             "frame. Division, rounding and stores by themselves take {:.3f} ns. One reading of the clock takes {:.0f} "
             "ns here; a frame reads it once for each stage of each patch.\n\n",
             machineText(), timeProjection(), clock.median) +
         kernels.text() + kKernelVerdict;
}

std::string writeLarge(Context& context) {
  Table large(stageHead("ms"));
  for (const std::string name : {"builtin:terrain?n=2048", "builtin:sphere?n=836"})
    for (const Storage& storage : {kUsual, kSmall, kFloats})
      addStageRows(context, {name}, storage, {.count = 15}, 1.0, large);
  return fmt::format(
             "Frames with everything in view: the snapped mesh drawn without groups and with planar ones, in turns; "
             "wall time of transform and clipping, medians and quartiles, and medians of the ratios frame by frame. "
             "Machine: {}.\n\n",
             machineText()) +
         large.text() + kLargeVerdict;
}

std::string writeSweep(Context& context) {
  Table sweep(stageHead("us"));
  for (const Load& load : std::vector<Load>{{"cow", 300},
                                            {"jet", 300},
                                            {"cow", 1000},
                                            {"bunny", 3000},
                                            {"bunny", 10000},
                                            {"bunny"},
                                            {"armadillo"},
                                            {"dragon"},
                                            {"builtin:teapot"},
                                            {"builtin:terrain?n=256"},
                                            {"builtin:terrain?n=1024"},
                                            {"builtin:sphere?n=289"}})
    addStageRows(context, load, kUsual, {.count = 31, .frames = 0, .width = 480, .height = 270}, 1e3, sweep);
  return fmt::format(
             "As above, 16-bit parameters, small meshes too, microseconds. Since reading the clock takes a fiftieth of "
             "one, each of 31 turns draws up to 50 frames in a row, of 480x270 pixels lest most of the time go into "
             "those, and the ratio is the median over the turns. Machine: {}.\n\n",
             machineText()) +
         sweep.text() + kSweepVerdict;
}

std::string writeVisible(Context& context) {
  Table table({"scene, triangles in view %", "stage", "classic ms", "modern ms", "grouped ms", "against classic",
               "against modern"});
  for (const std::string name : {"builtin:terrain?n=1024", "bunny", "dragon"}) {
    const scenes::Scene scene = litScene(context, name);
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
    const scenes::Scene scene = litScene(context, name);
    const PreparedScene original = prepared(scene, Grouping::kNone, false, kUsual, context.pool);
    const PreparedScene snapped = prepared(scene, Grouping::kPlanar, false, kUsual, context.pool);
    const PreparedScene grouped = prepared(scene, Grouping::kPlanar, true, kUsual, context.pool);
    const std::vector<scenes::Camera> cameras = timedOrbit(scene, 4);
    const std::vector<Frames> f = drawInTurns({&original, &snapped, &grouped}, cameras, {.count = 20}, context.pool);
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
