#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/build_info.h"
#include "cli/cluster_options.h"
#include "cli/cluster_picture.h"
#include "cli/cluster_report.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/output.h"
#include "core/error.h"
#include "core/stage_timer.h"
#include "grouping/cluster_colors.h"
#include "grouping/clusters_file.h"
#include "mesh/weld.h"
#include "scenes/join.h"
#include "scenes/painted_parts.h"
#include "scenes/ply_writer.h"

namespace sheaf::cli {
namespace {

void checkBeforehand(const ClusterRequest& request) {
  checkOutputs({{"-o", request.output}, {"--hierarchy", request.hierarchy}}, inputFiles(request));
  if (request.is_picture) raster::checkFormatAvailable(request.output);
}

/// The surface alone: vertices that differ in what is not their place would tear it at seams.
mesh::Mesh surfaceOf(const scenes::Scene& scene, const std::string& input) {
  mesh::Mesh mesh = scenes::joinedMesh(scene);
  if (mesh.triangles.empty()) throw Error(ErrorCode::kBadInput, fmt::format("{}: has no faces to cluster", input));
  mesh.normals = {};
  mesh.texcoords = {};
  mesh.colors = {};
  mesh::weldVertices(mesh);
  return mesh;
}

grouping::ClusterCut cutAsAsked(const ClusterRequest& request, const mesh::Mesh& mesh,
                                const grouping::FaceClusters& clusters) {
  switch (request.cut) {
    case CutBy::kCount:
      return grouping::cutByCount(clusters, request.count);
    case CutBy::kTolerance:
      return grouping::cutByPlanarity(mesh, clusters, grouping::Planarity::kMax, request.tolerance);
    case CutBy::kFaces:
      return grouping::cutBySize(mesh, clusters, {.max_faces = request.count});
  }
  return {};
}

void writeOutput(const ClusterRequest& request, const scenes::Scene& scene, mesh::Mesh mesh,
                 const grouping::FaceClusters& clusters, const grouping::ClusterCut& cut, TaskPool& pool) {
  const std::vector<std::uint32_t> cluster_of_face = grouping::clusterOfFace(clusters, cut);
  const std::vector<std::uint32_t> colors = grouping::colorClusters(mesh, clusters, cut, scenes::kPartColors);
  if (request.is_picture)
    drawClusters(request, scene, std::move(mesh), cluster_of_face, colors, pool);
  else
    scenes::writePly(request.output, scenes::paintedParts(mesh, cluster_of_face, colors));
}

int runCluster(const ClusterRequest& request) {
  checkBeforehand(request);
  if (request.simd) forceSimdTarget(*request.simd);
  scenes::ImportOptions import;
  import.for_drawing = false;
  import.z_up = request.view.z_up;
  const scenes::Scene scene = scenes::loadScene(request.input, import);
  mesh::Mesh mesh = surfaceOf(scene, request.input);

  TaskPool pool(request.threads);
  const std::int64_t begin_ns = nowNs();
  const grouping::FaceClusters clusters = grouping::clusterFaces(mesh, {.weights = request.weights}, pool);
  const double ms = 1e-6 * static_cast<double>(nowNs() - begin_ns);
  const grouping::ClusterCut cut = cutAsAsked(request, mesh, clusters);
  const ClusterReport report{.request = request,
                             .name = scene.name,
                             .vertices = mesh.vertexCount(),
                             .faces = mesh.triangleCount(),
                             .components = clusters.roots.size(),
                             .extent = double{mesh::boundsOf(mesh).longestEdge()},
                             .figures = grouping::figuresOf(mesh, clusters, cut),
                             .ms = ms,
                             .warnings = scene.warnings};
  if (!request.quiet && !request.json) printWarnings(report.warnings);
  if (!request.output.empty()) writeOutput(request, scene, std::move(mesh), clusters, cut, pool);
  if (!request.hierarchy.empty()) grouping::saveClusters(request.hierarchy, clusters);
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
