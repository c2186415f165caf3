#include "cli/compare_scene.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "cli/build_info.h"
#include "cli/comparison_page.h"
#include "cli/comparison_report.h"
#include "cli/console.h"
#include "cli/html_page.h"
#include "cli/output.h"
#include "cli/saved_groups.h"
#include "core/error.h"
#include "core/file.h"
#include "raster/image_io.h"

namespace sheaf::cli {
namespace {

// By groups wherever it can be: whether they are drawn right is the question, not how fast.
constexpr UsualGrouping kUsualGrouping{pipeline::Grouping::kPlanar, pipeline::Prefer::kMemory};

constexpr int kDefaultViews = 8;

void checkBeforehand(const SceneCompareRequest& request) {
  std::vector<std::string> inputs = inputFiles(request);
  if (!request.saved_groups.empty()) inputs.push_back(request.saved_groups);
  checkOutputs({{"-o", request.output}, {"--report", request.report}}, inputs);
  if (request.output.empty()) return;
  raster::checkFormatAvailable(request.output);
  const int width = 3 * request.size.width + 2 * pipeline::kSideBySideGapPx;
  if (width > raster::kMaxReadSide)
    throw Error(ErrorCode::kUsage, fmt::format("-o: three pictures of {} pixels side by side are too wide: choose a "
                                               "smaller --size",
                                               request.size.width));
}

std::vector<scenes::Camera> camerasOf(const std::vector<ViewRow>& rows) {
  std::vector<scenes::Camera> cameras;
  for (const ViewRow& row : rows) cameras.insert(cameras.end(), row.cameras.begin(), row.cameras.end());
  return cameras;
}

/// The options whose limit is passed in some view.
std::vector<std::string> beyondInAnyView(const Limits& limits, const pipeline::Comparison& comparison) {
  std::vector<std::string> options;
  for (const pipeline::ViewComparison& view : comparison.views)
    for (const std::string& option : beyond(limits, view.quality.pixels))
      if (std::find(options.begin(), options.end(), option) == options.end()) options.push_back(option);
  return options;
}

}  // namespace

void addSceneCompareOptions(CLI::App& command, SceneCompareArguments& a) {
  addReportOption(command, a.report);
  addPictureOptions(command, a);
  addGroupingOptions(command, a.grouping, kUsualGrouping);
  addSavedGroupsOption(command, a.grouping);
  addCameraOptions(command, a);
  command
      .add_option("--views", a.views,
                  fmt::format("Several views, of which the worst is reported: N around the scene\n(default {}; --orbit "
                              "says where to begin), inside it, through it, or the\ncameras of a file as sheaf info "
                              "--json lists them",
                              kDefaultViews))
      ->type_name("orbit[:N]|inside|fly[:N]|FILE.json")
      ->group("Camera");
}

void understandSceneCompare(const SceneCompareArguments& arguments, SceneCompareRequest& request) {
  understandScene(arguments, request);
  request.grouping = understandGrouping(arguments.grouping, kUsualGrouping);
  request.saved_groups = arguments.grouping.from.value_or("");
  request.report = understandReport(arguments.report);
  if (arguments.views) request.views = understandViews(*arguments.views, request.view);
}

int compareScene(const SceneCompareRequest& request) {
  checkBeforehand(request);
  if (request.simd) forceSimdTarget(*request.simd);
  TaskPool pool(request.threads);
  scenes::Scene scene = importScene(request);
  const pipeline::GroupingOptions grouping =
      groupsToDrawWith(request.saved_groups, request.grouping, request, scene).options;
  if (!request.quiet && !request.json) printWarnings(scene.warnings);
  const std::vector<scenes::Camera> cameras =
      camerasOf(makeViews(scene, request.views, request.view, request.aspect(), kDefaultViews));

  pipeline::RenderSettings settings;
  settings.width = request.size.width;
  settings.height = request.size.height;
  settings.background = backgroundOf(request, scene);
  ComparisonReport report;
  {
    ProgressLine line("grouping", request.quiet);
    report.comparison = pipeline::compareGrouping(scene, cameras, grouping, settings, pool, shownOn(line));
  }
  report.context = contextOf(request, pool);
  report.triangles = scene.triangleCount();
  report.limited = !request.limits.none();
  report.beyond = beyondInAnyView(request.limits, report.comparison);
  report.warnings = scene.warnings;
  report.warnings.insert(report.warnings.end(), report.comparison.warnings.begin(), report.comparison.warnings.end());
  if (!request.quiet && !request.json) printWarnings(report.comparison.warnings);

  if (!request.output.empty()) {
    const Image8 picture = pipeline::sideBySide(report.comparison);
    raster::writePicture(request.output, {.srgb = &picture}, pool);
  }
  if (!request.report.empty()) writeFile(request.report, comparisonPage(report, pool));
  writeStdout(request.json ? comparisonJson(report) : comparisonText(report));
  return report.comparison.drawsRight() && report.beyond.empty() ? 0 : 1;
}

}  // namespace sheaf::cli
