#include <CLI/CLI.hpp>
#include <memory>
#include <utility>

#include "cli/build_info.h"
#include "cli/cluster_options.h"
#include "cli/cluster_report.h"
#include "cli/coloring.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/output.h"
#include "cli/saved_file.h"
#include "cli/view.h"
#include "grouping/cluster_colors.h"
#include "grouping/clusters_file.h"
#include "pipeline/renderer.h"
#include "raster/image_io.h"
#include "scenes/camera.h"
#include "scenes/painted_parts.h"
#include "scenes/ply_writer.h"

namespace sheaf::cli {
namespace {

void checkBeforehand(const ClusterRequest& request) {
  std::vector<std::string> inputs = inputFiles(request);
  if (!request.cut.from.empty()) inputs.push_back(request.cut.from);
  checkOutputs({{"-o", request.output}, {"--hierarchy", request.hierarchy}}, inputs);
  if (request.is_picture) raster::checkFormatAvailable(request.output);
}

/// For a PLY or figures a mesh is as its file has it; a picture shows it as render does.
scenes::Scene load(const ClusterRequest& request) {
  if (request.is_picture) return importScene(request);
  refuseAsScene(request.input);
  scenes::ImportOptions import;
  import.for_drawing = false;
  return scenes::loadScene(request.input, import);
}

void writePly(const std::string& path, const Clustering& c) {
  const std::vector<std::uint32_t> colors = grouping::colorClusters(c.surface, c.clusters, c.cut, scenes::kPartColors);
  scenes::writePly(path, scenes::paintedParts(c.surface, grouping::clusterOfFace(c.clusters, c.cut), colors));
}

void drawClusters(const ClusterRequest& request, const Clustering& clustering, scenes::Scene scene, TaskPool& pool) {
  const scenes::Camera camera = chooseUnfittedCamera(scene, request.view, request.aspect());
  Box3 bounds = boundsOf(scene);
  const pipeline::OverlayView view{scenes::fitClipPlanes(camera, bounds), request.size.height};
  Coloring coloring(clustering, request.cut.overlay, view, scene);
  if (scene.lights.empty()) scenes::addDefaultLights(scene, camera);
  pipeline::RenderSettings settings;
  settings.width = request.size.width;
  settings.height = request.size.height;
  settings.background = backgroundOf(request, scene);
  settings.want_linear = settings.want_ids = true;
  pipeline::PreparedScene prepared = pipeline::prepareScene(std::move(scene), pool);
  coloring.finish(view, prepared, bounds, pool);
  pipeline::Frame frame;
  pipeline::Renderer(pool).render(prepared, scenes::fitClipPlanes(camera, bounds), settings, frame);
  coloring.apply(frame, pool);
  const bool linear = raster::formatOf(request.output).linear;
  raster::writePicture(request.output,
                       {.srgb = linear ? nullptr : &frame.color, .linear = linear ? &frame.linear : nullptr}, pool);
}

int runCluster(const ClusterRequest& request) {
  checkBeforehand(request);
  if (request.simd) forceSimdTarget(*request.simd);
  TaskPool pool(request.threads);
  scenes::Scene scene = load(request);
  const Clustering clustering = clusterScene(request.cut, scene, request.input, request.view.z_up, pool);
  const mesh::Mesh& surface = clustering.surface;
  const ClusterReport report{.request = request,
                             .name = scene.name,
                             .vertices = surface.vertexCount(),
                             .faces = surface.triangleCount(),
                             .components = clustering.clusters.roots.size(),
                             .extent = double{mesh::boundsOf(surface).longestEdge()},
                             .figures = grouping::figuresOf(surface, clustering.clusters, clustering.cut),
                             .ms = clustering.ms,
                             .warnings = scene.warnings};
  if (!request.quiet && !request.json) printWarnings(report.warnings);
  if (request.is_picture)
    drawClusters(request, clustering, std::move(scene), pool);
  else if (!request.output.empty())
    writePly(request.output, clustering);
  if (!request.hierarchy.empty()) grouping::saveClusters(request.hierarchy, clustering.clusters, surface);
  writeStdout(request.json ? clusterJson(report) : clusterText(report));
  return 0;
}

}  // namespace

void addClusterCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("cluster", "Join faces into flat, round clusters, and show them");
  const auto arguments = std::make_shared<ClusterArguments>();
  addClusterOptions(*command, arguments);
  command->callback([arguments, &run] { run = [arguments] { return runCluster(understand(*arguments)); }; });
}

}  // namespace sheaf::cli
