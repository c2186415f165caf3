#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/bench_page.h"
#include "cli/bench_report.h"
#include "cli/build_info.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/grouping_options.h"
#include "cli/html_page.h"
#include "cli/output.h"
#include "cli/saved_groups.h"
#include "cli/scene_options.h"
#include "cli/views.h"
#include "core/error.h"
#include "core/file.h"
#include "scenes/camera.h"

namespace sheaf::cli {
namespace {

constexpr UsualGrouping kUsualGrouping{pipeline::Grouping::kPlanar, pipeline::Prefer::kSpeed};

constexpr int kDefaultFrames = 24;
constexpr int kMaxFrames = 100000;

constexpr const char* kFooter =
    "Three ways to draw the same scene, frame by frame in turns: classic transforms every vertex; modern leaves out\n"
    "patches that are out of view or face away, testing each; grouped finds the same ones by way of a tree over them,\n"
    "and transforms and clips the vertices of the others by groups. All use the same vectors, threads, raster and\n"
    "shading.\n"
    "\n"
    "--views orbit goes around the scene, all of it in view; inside stands where 5, 25 and 50 % of the triangles are "
    "in\n"
    "view; fly goes through it; a file lists cameras as sheaf info --json does: eye, target, up, vertical_fov_degrees "
    "or\n"
    "orthographic_height.\n"
    "\n"
    "Examples:\n"
    "  sheaf bench builtin:terrain --report terrain.html\n"
    "  sheaf bench bunny.ply --views inside --threads 1 --size 1920x1080\n"
    "  sheaf bench model.glb --views fly --frames 200 --json > model.json\n"
    "\n";

/// The options as they were written; absent ones are empty.
struct BenchArguments : SceneArguments {
  GroupingArguments grouping;
  Text views;
  Text frames;
  Text report;
  bool json = false;
};

struct BenchRequest : SceneRequest {
  pipeline::GroupingOptions grouping;
  std::string saved_groups;  ///< a file to take groups from, else empty
  ViewsRequest views;
  int frames = kDefaultFrames;
  std::string report;  ///< HTML; empty: not written
  bool json = false;
};

BenchRequest understand(const BenchArguments& arguments) {
  BenchRequest request;
  understandScene(arguments, request);
  request.grouping = understandGrouping(arguments.grouping, kUsualGrouping);
  request.saved_groups = arguments.grouping.from.value_or("");
  const ViewRequest& view = request.view;
  if (arguments.views)
    request.views = understandViews(*arguments.views, view);
  else if (!view.named && !view.eye && !view.file_camera)
    request.views.kind = Views::kOrbit;
  if (arguments.frames) request.frames = static_cast<int>(parseWhole("--frames", *arguments.frames, 1, kMaxFrames));
  request.report = understandReport(arguments.report);
  request.json = arguments.json;
  return request;
}

pipeline::BaselineBench prepare(const BenchRequest& request, const scenes::Scene& scene,
                                const pipeline::RenderSettings& settings, TaskPool& pool) {
  ProgressLine line("grouping", request.quiet);
  return {scene, request.grouping, settings, pool, shownOn(line)};
}

BenchReport measure(const BenchRequest& request, const scenes::Scene& scene, const std::vector<ViewRow>& rows,
                    TaskPool& pool) {
  pipeline::RenderSettings settings;
  settings.width = request.size.width;
  settings.height = request.size.height;
  settings.background = backgroundOf(request, scene);
  pipeline::BaselineBench bench = prepare(request, scene, settings, pool);
  BenchReport report;
  report.context = contextOf(request, pool);
  report.grouping = request.grouping;
  report.geometry = pipeline::geometricError(bench.grouped());
  report.triangles = scene.triangleCount();
  report.vertices = bench.vertexCount();
  report.drawn_by_groups = pipeline::shareDrawnByGroups(bench.grouped());
  report.original_bytes_per_vertex = pipeline::bytesPerVertex(bench.original());
  report.grouped_bytes_per_vertex = pipeline::bytesPerVertex(bench.grouped());
  report.warnings = bench.grouped().warnings;
  ProgressLine progress("measuring", request.quiet);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ViewRow& row = rows[i];
    const auto done = [&](double share) {
      progress.show((static_cast<double>(i) + share) / static_cast<double>(rows.size()));
    };
    report.sections.push_back(
        {row.name, row.share_in_view, row.cameras.size(), bench.run(row.cameras, request.frames, done)});
    if (report.sections.back().run.differing_frames > 0)
      throw Error(ErrorCode::kInternal, "culling of patches changed a picture");
  }
  return report;
}

int runBench(BenchRequest request) {
  std::vector<std::string> inputs = inputFiles(request);
  if (!request.saved_groups.empty()) inputs.push_back(request.saved_groups);
  checkOutputs({{"--report", request.report}}, inputs);
  if (request.simd) forceSimdTarget(*request.simd);
  TaskPool pool(request.threads);
  scenes::Scene scene = importScene(request);
  request.grouping = groupsToDrawWith(request.saved_groups, request.grouping, request, scene).options;
  const std::vector<ViewRow> rows = makeViews(scene, request.views, request.view, request.aspect(), request.frames);
  if (scene.lights.empty()) scenes::addDefaultLights(scene, rows.front().cameras.front());
  BenchReport report = measure(request, scene, rows, pool);
  report.warnings.insert(report.warnings.begin(), scene.warnings.begin(), scene.warnings.end());
  if (!request.quiet && !request.json) printWarnings(report.warnings);
  if (!request.report.empty()) writeFile(request.report, benchPage(report, pool));
  writeStdout(request.json ? benchJson(report) : benchText(report));
  return 0;
}

}  // namespace

void addBenchCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("bench", "Time a scene with vertex groups and without, stage by stage");
  const auto arguments = std::make_shared<BenchArguments>();
  BenchArguments& a = *arguments;
  command->add_option("INPUT", a.input, "A mesh file, or builtin:NAME?key=value&... (see sheaf scenes)")->required();
  command
      ->add_option("--frames", a.frames,
                   fmt::format("Frames of each kind, 1 to {} (default {}); of inside, for each share", kMaxFrames,
                               kDefaultFrames))
      ->type_name("N");
  command->add_flag("--json", a.json, "Everything as JSON, the times of each frame included");
  addReportOption(*command, a.report);
  addPictureOptions(*command, a);
  addGroupingOptions(*command, a.grouping, kUsualGrouping);
  addSavedGroupsOption(*command, a.grouping);
  addCameraOptions(*command, a);
  command
      ->add_option("--views", a.views,
                   "A row of cameras (default orbit, unless one camera is chosen); N of\nthem (default: one for each "
                   "frame). --orbit says where an orbit or the\nway inside begins")
      ->type_name("orbit[:N]|inside|fly[:N]|FILE.json")
      ->group("Camera");
  command->footer(std::string(kFooter) + kExitCodes);
  command->callback([arguments, &run] { run = [arguments] { return runBench(understand(*arguments)); }; });
}

}  // namespace sheaf::cli
