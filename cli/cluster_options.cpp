#include "cli/cluster_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "cli/commands.h"
#include "core/error.h"

namespace sheaf::cli {
namespace {

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
    "joined. Lengths are fractions of the longest edge of the mesh's box. The picture is that of\n"
    "sheaf render --color-by cluster.\n"
    "\n"
    "Examples:\n"
    "  sheaf cluster bunny.ply -o bunny.png\n"
    "  sheaf cluster bunny.ply --clusters 16 --overlay boxes -o boxes.png\n"
    "  sheaf cluster part.stl --up z --tolerance 0.1% -o part.png --view front\n"
    "  sheaf cluster scan.ply --max-faces 256 --weights 1,1,0 -o clusters.ply --hierarchy scan.sheaf --json\n"
    "  sheaf cluster scan.ply --from scan.sheaf --tolerance 0.1% -o flat.png\n"
    "\n";

[[noreturn]] void refuse(const std::string& reason) {
  throw Error(ErrorCode::kUsage, reason);
}

/// What changes nothing but a picture.
void refuseIdlePictureOptions(const ClusterArguments& a) {
  const auto check = [](bool given, std::string_view option) {
    if (given) refuse(fmt::format("{} is about the picture: add -o FILE.png", option));
  };
  check(a.cut.overlay.has_value(), "--overlay");
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
  if (arguments.hierarchy && arguments.cut.from)
    refuse("--hierarchy would save what --from has loaded: give one of them");
  if (!request.is_picture) refuseIdlePictureOptions(arguments);
}

}  // namespace

void addClusterOptions(CLI::App& command, const std::shared_ptr<ClusterArguments>& arguments) {
  ClusterArguments& a = *arguments;
  command.add_option("INPUT", a.input, "A mesh file or builtin:NAME")->required();
  addCutOptions(command, a.cut);
  command
      .add_option("--from", a.cut.from,
                  "Take the hierarchy from a file that sheaf cluster --hierarchy has\nsaved of the same mesh")
      ->type_name("FILE.sheaf");
  command
      .add_option("-o,--output", a.output,
                  "The mesh in a colour per cluster: a PLY file, or a picture (PNG, JPEG,\nEXR ...) by the extension")
      ->type_name("FILE");
  command
      .add_option(
          "--hierarchy", a.hierarchy,
          "Save the whole hierarchy, as sheaf's own .sheaf file: for info, and for\n--from of cluster and render")
      ->type_name("FILE");
  command.add_flag("--json", a.json, "Report as JSON, warnings included");
  addPictureOptions(command, a);
  addCameraOptions(command, a);
  command.footer(std::string(kFooter) + kExitCodes);
}

ClusterRequest understand(const ClusterArguments& arguments) {
  ClusterRequest request;
  understandScene(arguments, request);
  request.cut = understandCut(arguments.cut);
  understandOutput(arguments, request);
  request.json = arguments.json;
  return request;
}

}  // namespace sheaf::cli
