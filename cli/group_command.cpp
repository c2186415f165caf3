#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/group_options.h"
#include "cli/group_report.h"
#include "cli/interrupt.h"
#include "cli/output.h"
#include "cli/saved_file.h"
#include "core/error.h"
#include "grouping/cluster_patches.h"
#include "grouping/groups_file.h"
#include "scenes/join.h"
#include "scenes/ply_writer.h"
#include "scenes/scene.h"

namespace sheaf::cli {
namespace {

/// For the figures of storage, where groups are not saved with fewer: a 16384th of the extent is what positions of
/// meshes are commonly quantised to.
constexpr int kDefaultGridBits = 14;

void checkBeforehand(const GroupRequest& request) {
  std::vector<std::string> inputs;
  if (!request.input.starts_with("builtin:")) inputs.push_back(request.input);
  if (!request.plane_file.empty()) inputs.push_back(request.plane_file);
  checkOutputs({{"-o", request.output}, {"--snapped", request.snapped}}, inputs);
}

grouping::VertexGroups search(const mesh::Mesh& mesh, const GroupRequest& request, const InterruptGuard& guard) {
  if (request.method == GroupMethod::kPlanar) return grouping::groupPlanar(mesh, request.planar);
  if (request.method == GroupMethod::kCluster) {
    TaskPool pool;
    return grouping::groupInPatches(mesh, grouping::clusterPatches(mesh, {}, pool), request.cluster, pool);
  }
  ProgressLine progress("grouping", request.quiet);
  grouping::LinearOptions options = request.linear;
  options.progress = [&](double done) {
    progress.show(done);
    return !guard.interrupted();
  };
  return grouping::groupLinear(mesh, options);
}

/// The library knows no names of files.
grouping::VertexGroups searchNamed(const mesh::Mesh& mesh, const GroupRequest& request, const InterruptGuard& guard) {
  try {
    return search(mesh, request, guard);
  } catch (const Error& e) {
    throw Error(e.code(), fmt::format("{}: {}", request.input, e.what()));
  }
}

int runGroup(GroupRequest request) {
  checkBeforehand(request);
  if (!request.plane_file.empty()) {
    request.planar.planes = grouping::loadPlanes(request.plane_file);
    request.plane_set = fmt::format("{} planes of {}", request.planar.planes.size(), request.plane_file);
  }
  refuseAsScene(request.input);
  scenes::ImportOptions import;
  import.for_drawing = false;
  const scenes::Scene scene = scenes::loadScene(request.input, import);
  const mesh::Mesh mesh = scenes::joinedMesh(scene);

  const InterruptGuard guard;
  grouping::VertexGroups groups = searchNamed(mesh, request, guard);
  guard.endIfInterrupted();
  GroupReport report{.request = request,
                     .name = scene.name,
                     .mesh_vertices = mesh.vertexCount(),
                     .mesh_triangles = mesh.triangleCount(),
                     .groups = groups,
                     .compression = grouping::measureCompression(
                         mesh, groups, request.saved_bits > 0 ? request.saved_bits : kDefaultGridBits),
                     .warnings = scene.warnings};
  for (const std::string& warning : groups.warnings)
    report.warnings.push_back(fmt::format("{}: {}", request.input, warning));
  if (!request.quiet && !request.json) printWarnings(report.warnings);
  if (!request.output.empty()) {
    groups.mesh_checksum = grouping::meshChecksum(mesh);
    grouping::saveGroups(request.output, groups, {.parameter_bits = request.saved_bits});
  }
  if (!request.snapped.empty()) scenes::writePly(request.snapped, grouping::snappedMesh(mesh, groups));
  writeStdout(request.json ? groupJson(report) : groupText(report));
  return 0;
}

}  // namespace

void addGroupCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("group", "Find vertices on common lines or planes, and say what that saves");
  const auto arguments = std::make_shared<GroupArguments>();
  addGroupOptions(*command, arguments);
  command->callback([arguments, &run] { run = [arguments] { return runGroup(understand(*arguments)); }; });
}

}  // namespace sheaf::cli
