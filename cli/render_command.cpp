#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>

#include "cli/build_info.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/output.h"
#include "cli/render_options.h"
#include "cli/saved_groups.h"
#include "cli/view.h"
#include "core/error.h"
#include "core/file.h"
#include "pipeline/comparison.h"
#include "pipeline/renderer.h"
#include "pipeline/timing_report.h"
#include "raster/image_io.h"
#include "scenes/camera.h"

namespace sheaf::cli {
namespace {

bool outputIsLinear(const RenderRequest& request) {
  return !request.output.empty() && request.output != "-" && raster::formatOf(request.output).linear;
}

/// All that can be found out before the input is read.
void checkBeforehand(const RenderRequest& request) {
  if (request.output == "-" && isatty(STDOUT_FILENO))
    throw Error(ErrorCode::kUsage, "-o -: standard output is a terminal; redirect it");
  std::vector<std::string> inputs = inputFiles(request);
  for (const std::string& saved : {request.cut.from, request.saved_groups})
    if (!saved.empty()) inputs.push_back(saved);
  checkOutputs({{"-o", request.output}, {"--timings", request.timings_file}, {"--trace", request.trace_file}}, inputs);
  if (!request.output.empty() && request.output != "-") raster::checkFormatAvailable(request.output);
}

/// From the reversed depth of a frame to the distance along the view, world units; infinity where nothing is.
void toViewDistance(ImageF& depth, const scenes::Camera& camera) {
  const double range = camera.far - camera.near;
  for (float& d : depth.pixels()) {
    const bool parallel = camera.orthographic_height > 0.0;
    const double distance = parallel ? camera.far - d * range : camera.far * camera.near / (camera.near + d * range);
    d = d > 0.0F ? static_cast<float>(distance) : std::numeric_limits<float>::infinity();
  }
}

void writeOutput(const RenderRequest& request, const scenes::Camera& camera, pipeline::Frame& frame, TaskPool& pool) {
  if (request.output == "-") return raster::encodePng(frame.color, pool, writeStdout);
  const bool linear = outputIsLinear(request);  // a coloured picture is there in both forms
  raster::Picture picture{.srgb = linear ? nullptr : &frame.color, .linear = linear ? &frame.linear : nullptr};
  if (request.want_depth) {
    toViewDistance(frame.depth, camera);
    picture.depth = &frame.depth;
  }
  if (request.want_ids) {
    picture.instance_id = &frame.instance_id;
    picture.triangle_id = &frame.triangle_id;
  }
  raster::writePicture(request.output, picture, pool);
}

void writeReports(const RenderRequest& request, const pipeline::RunTimes& run, const TaskPool& pool) {
  if (!request.table && request.timings_file.empty() && request.trace_file.empty()) return;
  const pipeline::RunContext context = contextOf(request, pool);
  const pipeline::TimingReport report = pipeline::makeTimingReport(run, context);
  if (!request.timings_file.empty()) writeFile(request.timings_file, pipeline::toJson(report));
  if (!request.trace_file.empty()) writeFile(request.trace_file, pipeline::toTraceJson(run, context));
  if (!request.table) return;
  // With the picture on stdout there is no room for the table there.
  if (request.output == "-")
    fmt::print(stderr, "{}", pipeline::formatTable(report));
  else
    writeStdout(pipeline::formatTable(report));
}

/// Before the scene is prepared; takes the scene's colours.
std::optional<Coloring> beginColoring(const RenderRequest& request, const GroupsToDraw& groups,
                                      const pipeline::OverlayView& view, scenes::Scene& scene, TaskPool& pool) {
  if (!request.color_by) return std::nullopt;
  if (request.color_by == ColorBy::kGroup && groups.options.saved) return Coloring(groups, request.cut.overlay, scene);
  if (request.color_by != ColorBy::kCluster) return Coloring(*request.color_by, request.cut.overlay, scene);
  return Coloring(clusterScene(request.cut, scene, request.input, request.view.z_up, pool), request.cut.overlay, view,
                  scene);
}

int runRender(const RenderRequest& request) {
  pipeline::RunTimes run;
  run.begin_ns = nowNs();
  checkBeforehand(request);
  if (request.simd) forceSimdTarget(*request.simd);
  TaskPool pool(request.threads);

  scenes::Scene scene;
  GroupsToDraw groups;
  run.import = pipeline::timePhase([&] {
    scene = importScene(request);
    groups = groupsToDrawWith(request.saved_groups, request.grouping, request, scene);
  });
  if (!request.quiet) printWarnings(scene.warnings);
  scenes::Camera camera = chooseUnfittedCamera(scene, request.view, request.aspect());
  if (scene.lights.empty()) scenes::addDefaultLights(scene, camera);

  pipeline::RenderSettings settings;
  settings.width = request.size.width;
  settings.height = request.size.height;
  settings.culling = request.culling;
  settings.background = backgroundOf(request, scene);
  settings.want_srgb = !outputIsLinear(request);
  settings.want_linear = !settings.want_srgb || request.color_by;
  settings.want_depth = request.want_depth;
  settings.want_ids = request.want_ids || request.color_by;
  settings.record_spans = !request.trace_file.empty();

  pipeline::PreparedScene prepared;
  Box3 bounds = boundsOf(scene);
  std::optional<Coloring> coloring;
  run.prepare = pipeline::timePhase([&] {
    const pipeline::OverlayView view{scenes::fitClipPlanes(camera, bounds), request.size.height};
    coloring = beginColoring(request, groups, view, scene, pool);
    ProgressLine line("grouping", request.quiet);
    prepared = pipeline::prepareScene(std::move(scene), pool, groups.options, shownOn(line));
    if (coloring) coloring->finish(view, prepared, bounds, pool);
  });
  camera = scenes::fitClipPlanes(camera, bounds);
  if (groups.options.method != pipeline::Grouping::kNone && pipeline::shareDrawnByGroups(prepared) == 0.0)
    prepared.warnings.push_back(
        fmt::format("{}: groups draw {}", request.input, drawnByGroupsText(0.0, groups.options)));
  if (!request.quiet) printWarnings(prepared.warnings);

  pipeline::Renderer renderer(pool);
  pipeline::Frame frame;
  for (int i = 0; i < request.frames; ++i) {
    const std::int64_t begin_ns = nowNs();
    renderer.render(prepared, camera, settings, frame);
    run.addFrame(begin_ns, frame);
  }
  if (!request.output.empty())
    run.encode = pipeline::timePhase([&] {
      if (coloring) coloring->apply(frame, pool);
      writeOutput(request, camera, frame, pool);
    });
  run.pixels = request.output.empty()
                   ? 0
                   : static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(settings.height);
  run.end_ns = nowNs();
  writeReports(request, run, pool);
  return 0;
}

}  // namespace

void addRenderCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("render", "Render a mesh file or a built-in scene to an image");
  const auto arguments = std::make_shared<RenderArguments>();
  addRenderOptions(*command, arguments);
  command->callback([arguments, &run] { run = [arguments] { return runRender(understand(*arguments)); }; });
}

}  // namespace sheaf::cli
