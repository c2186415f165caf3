#include "cli/cluster_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <limits>
#include <vector>

#include "cli/commands.h"
#include "core/error.h"

namespace sheaf::cli {
namespace {

constexpr double kMaxWeight = 1000.0;

constexpr const char* kFooter =
    "Neighbouring faces are joined, cheapest first, into clusters that are flat, face one way and are round (Garland,\n"
    "Willmott and Heckbert, Hierarchical Face Clustering on Polygonal Surfaces), until every connected piece of the\n"
    "mesh is one. That hierarchy is then cut across: into --clusters N, into the largest clusters whose corners all "
    "lie\n"
    "within --tolerance of a plane, or into the largest of at most --max-faces N. Where there are more pieces than N,\n"
    "there are more clusters.\n"
    "\n"
    "A file or scene of several meshes is clustered as one: every instance where it stands, vertices at the same "
    "place\n"
    "joined. Lengths are fractions of the longest edge of the mesh's box. The options of the picture are those of\n"
    "sheaf render.\n"
    "\n"
    "Examples:\n"
    "  sheaf cluster bunny.ply -o bunny.png\n"
    "  sheaf cluster part.stl --up z --tolerance 0.1% -o part.png --view front\n"
    "  sheaf cluster scan.ply --max-faces 256 --weights 1,1,0 -o clusters.ply --json\n"
    "\n";

[[noreturn]] void refuse(const std::string& reason) {
  throw Error(ErrorCode::kUsage, reason);
}

void understandCut(const ClusterArguments& arguments, ClusterRequest& request) {
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
    request.cut = CutBy::kTolerance;
    request.tolerance = parseFraction("--tolerance", *arguments.tolerance);
  }
  if (arguments.max_faces) {
    request.cut = CutBy::kFaces;
    request.count = count("--max-faces", *arguments.max_faces);
  }
}

void understandWeights(const std::string& text, grouping::CostWeights& weights) {
  const std::vector<double> values = parseList("--weights", text, 3, 4, 0.0, kMaxWeight);
  weights.fit = values[0];
  weights.direction = values[1];
  weights.shape = values[2];
  if (values.size() > 3) weights.balance = values[3];
}

/// What changes nothing but a picture.
void refuseIdlePictureOptions(const ClusterArguments& a) {
  const auto check = [](bool given, std::string_view option) {
    if (given) refuse(fmt::format("{} is about the picture: add -o FILE.png", option));
  };
  check(a.size.has_value(), "--size");
  check(a.background.has_value(), "--background");
  check(a.crease.has_value(), "--crease");
  check(a.simd.has_value(), "--simd");
  check(a.view.has_value(), "--view");
  check(a.orbit.has_value(), "--orbit");
  check(a.eye.has_value(), "--eye");
  check(a.target.has_value(), "--target");
  check(a.camera.has_value(), "--camera");
  check(!a.up.empty(), "--up");
  check(a.fov.has_value(), "--fov");
  check(a.orthographic, "--orthographic");
}

void understandOutput(const ClusterArguments& arguments, ClusterRequest& request) {
  request.output = arguments.output.value_or("");
  if (arguments.output && !request.output.ends_with(".ply")) {
    if (!raster::hasPictureExtension(request.output))
      refuse(fmt::format("-o {}: expected a name that ends in .ply, or in .png or another picture's extension",
                         request.output));
    request.is_picture = true;
    checkBackground(arguments, request, raster::formatOf(request.output));
  }
  request.hierarchy = arguments.hierarchy.value_or("");
  if (arguments.hierarchy && !request.hierarchy.ends_with(".sheaf"))
    refuse(fmt::format("--hierarchy {}: expected a name that ends in .sheaf", request.hierarchy));
  if (!request.is_picture) refuseIdlePictureOptions(arguments);
}

}  // namespace

void addClusterOptions(CLI::App& command, const std::shared_ptr<ClusterArguments>& arguments) {
  ClusterArguments& a = *arguments;
  command.add_option("INPUT", a.input, "A mesh file or builtin:NAME")->required();
  command.add_option("--clusters", a.clusters, "Cut into so many clusters (default 64)")->type_name("N");
  command
      .add_option("--tolerance", a.tolerance,
                  "Cut into clusters that are this flat: 0.5% or 0.005 of the longest\nedge of the box")
      ->type_name("T");
  command.add_option("--max-faces", a.max_faces, "Cut into clusters of at most so many faces")->type_name("N");
  command
      .add_option("--weights", a.weights,
                  "How much flatness, direction, roundness and balance count, 0 to 1000\neach (default 1,1,1,0.1)")
      ->type_name("FIT,DIR,SHAPE[,BALANCE]");
  command
      .add_option("-o,--output", a.output,
                  "The mesh in a colour per cluster: a PLY file, or a picture (PNG, JPEG,\nEXR ...) by the extension")
      ->type_name("FILE");
  command.add_option("--hierarchy", a.hierarchy, "Save the whole hierarchy, as sheaf's own .sheaf file")
      ->type_name("FILE");
  command.add_flag("--json", a.json, "Report as JSON, warnings included");
  addPictureOptions(command, a);
  addCameraOptions(command, a);
  command.footer(std::string(kFooter) + kExitCodes);
}

ClusterRequest understand(const ClusterArguments& arguments) {
  ClusterRequest request;
  understandScene(arguments, request);
  understandCut(arguments, request);
  if (arguments.weights) understandWeights(*arguments.weights, request.weights);
  understandOutput(arguments, request);
  request.json = arguments.json;
  return request;
}

}  // namespace sheaf::cli
