#include "cli/cut_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <limits>

#include "cli/values.h"
#include "core/error.h"
#include "core/stage_timer.h"
#include "grouping/clusters_file.h"
#include "mesh/weld.h"
#include "scenes/join.h"

namespace sheaf::cli {
namespace {

constexpr double kMaxWeight = 1000.0;

[[noreturn]] void refuse(const std::string& reason) {
  throw Error(ErrorCode::kUsage, reason);
}

void understandSize(const CutArguments& arguments, CutRequest& request) {
  std::vector<std::string_view> given;
  if (arguments.clusters) given.emplace_back("--clusters");
  if (arguments.tolerance) given.emplace_back("--tolerance");
  if (arguments.max_faces) given.emplace_back("--max-faces");
  if (given.size() > 1) refuse(fmt::format("{} and {} each choose a cut: give one of them", given[0], given[1]));
  const auto count = [](std::string_view option, const std::string& text) {
    return static_cast<std::uint32_t>(parseWhole(option, text, 1, std::numeric_limits<std::uint32_t>::max()));
  };
  if (arguments.clusters) request.count = count("--clusters", *arguments.clusters);
  if (arguments.tolerance) {
    request.by = CutBy::kTolerance;
    request.tolerance = parseFraction("--tolerance", *arguments.tolerance);
  }
  if (arguments.max_faces) {
    request.by = CutBy::kFaces;
    request.count = count("--max-faces", *arguments.max_faces);
  }
}

grouping::CostWeights understandWeights(const std::string& text) {
  const std::vector<double> values = parseList("--weights", text, 3, 4, 0.0, kMaxWeight);
  grouping::CostWeights weights;
  weights.fit = values[0];
  weights.direction = values[1];
  weights.shape = values[2];
  if (values.size() > 3) weights.balance = values[3];
  return weights;
}

grouping::ClusterCut cutAsAsked(const CutRequest& request, const mesh::Mesh& mesh,
                                const grouping::FaceClusters& clusters) {
  switch (request.by) {
    case CutBy::kCount:
      return grouping::cutByCount(clusters, request.count);
    case CutBy::kTolerance:
      return grouping::cutByPlanarity(mesh, clusters, grouping::Planarity::kMax, request.tolerance);
    case CutBy::kFaces:
      return grouping::cutBySize(mesh, clusters, {.max_faces = request.count});
  }
  return {};
}

}  // namespace

std::vector<CLI::Option*> addCutOptions(CLI::App& command, CutArguments& a) {
  const auto add = [&](const char* name, auto& value, const char* meaning, const char* type) {
    return command.add_option(name, value, meaning)->type_name(type);
  };
  return {add("--clusters", a.clusters, "Cut into so many clusters (default 64)", "N"),
          add("--tolerance", a.tolerance,
              "Cut into clusters that are this flat: 0.5% or 0.005 of the longest\nedge of the box", "T"),
          add("--max-faces", a.max_faces, "Cut into clusters of at most so many faces", "N"),
          add("--weights", a.weights,
              "How much flatness, direction, roundness and balance count, 0 to 1000\neach (default 1,1,1,0.1)",
              "FIT,DIR,SHAPE[,BALANCE]"),
          add("--overlay", a.overlay,
              "Draw these too, as thin bars: boxes, planes or boxes,planes; of vertex\ngroups planes (or lines), of "
              "patches boxes. The camera stays as it is",
              "LIST")};
}

CutRequest understandCut(const CutArguments& arguments) {
  CutRequest request;
  understandSize(arguments, request);
  if (arguments.weights) request.weights = understandWeights(*arguments.weights);
  request.from = arguments.from.value_or("");
  if (arguments.from && request.from.empty()) refuse("--from: the name of the file is empty");
  if (arguments.from && arguments.weights)
    refuse("--weights decide how clusters are made, and --from takes clusters that have been made");
  if (arguments.overlay) {
    const std::string& text = *arguments.overlay;
    const bool both = text == "boxes,planes" || text == "planes,boxes";
    request.overlay = {both || text == "boxes", both || text == "planes"};
    if (!request.overlay.any()) refuse(fmt::format("--overlay {}: expected boxes, planes or boxes,planes", text));
  }
  return request;
}

Clustering clusterScene(const CutRequest& request, const scenes::Scene& scene, const std::string& input, bool z_up,
                        TaskPool& pool) {
  Clustering out;
  out.surface = mesh::surfaceOf(scenes::joinedMesh(scene));
  if (out.surface.triangles.empty())
    throw Error(ErrorCode::kBadInput, fmt::format("{}: has no faces to cluster", input));
  if (z_up) {
    out.world_from_surface = DMat4(DVec4(1, 0, 0, 0), DVec4(0, 0, -1, 0), DVec4(0, 1, 0, 0), DVec4(0, 0, 0, 1));
    for (Vec3& p : out.surface.positions) p = {p.x, -p.z, p.y};
  }
  const std::int64_t begin_ns = nowNs();
  out.clusters = request.from.empty() ? grouping::clusterFaces(out.surface, {.weights = request.weights}, pool)
                                      : grouping::loadClusters(request.from, out.surface);
  out.ms = 1e-6 * static_cast<double>(nowNs() - begin_ns);
  out.cut = cutAsAsked(request, out.surface, out.clusters);
  return out;
}

}  // namespace sheaf::cli
