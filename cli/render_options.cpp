#include "cli/render_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <utility>

#include "cli/commands.h"
#include "cli/saved_file.h"
#include "core/error.h"
#include "raster/image_io.h"

namespace sheaf::cli {
namespace {

// What the option parser stores for a flag without a value.
constexpr std::string_view kBareTimings = "true";
constexpr int kMaxFrames = 100000;
constexpr Names<ColorBy, 3> kColorByNames = {
    {{"cluster", ColorBy::kCluster}, {"group", ColorBy::kGroup}, {"patch", ColorBy::kPatch}}};

constexpr const char* kFooter =
    "The camera is chosen by one of --view, --orbit, --eye or --camera; without them it is the file's first camera,\n"
    "or, if it has none, --view iso. Lights are added when the file has none. --eye, --target and --up X,Y,Z are in\n"
    "the file's coordinates; --up may be given twice, once as axis and once as direction.\n"
    "\n"
    "--color-by group shows what is drawn by planes or lines, by default as --prefer memory draws it. Where these "
    "have\n"
    "few vertices of a patch, vertices are drawn in full and the surface stays white.\n"
    "--color-by joins all instances to one mesh to find neighbours: they may have 2^32 - 2 vertices in all, and many\n"
    "instances of a large mesh take memory and time.\n"
    "\n"
    "Saved groups (--from) are drawn as they are: --grouping, --metric, --limit and --epsilon were theirs to choose.\n"
    "Every instance is then a mesh of its own. --color-by group shows them, drawn by planes or in full: a triangle\n"
    "has the colour of the group that two of its corners are in, or stays white. A saved file is taken only for the\n"
    "mesh that it was made of.\n"
    "\n"
    "Examples:\n"
    "  sheaf render model.glb -o model.png\n"
    "  sheaf render part.stl --up z --view front --orthographic -o part.png --background transparent\n"
    "  sheaf render scan.ply.gz --orbit 30,20 --size 1920x1080 -o scan.png --timings\n"
    "  sheaf render builtin:gallery --eye 4,2,6 --target 0,1,0 --fov 35 -o - > gallery.png\n"
    "  sheaf render model.glb -o model.exr --channels depth,ids\n"
    "  sheaf render builtin:terrain --frames 50 --timings=times.json --trace trace.json\n"
    "  sheaf render scan.ply --grouping planar --epsilon 0.1% -o grouped.png --timings\n"
    "  sheaf render scan.ply --from groups.sheaf --color-by group -o groups.png\n"
    "  sheaf render scan.ply --color-by cluster --tolerance 1% --overlay planes -o clusters.png\n"
    "  sheaf render scan.ply --grouping cluster --color-by group --overlay planes -o groups.png\n"
    "\n";

[[noreturn]] void refuse(const std::string& reason) {
  throw Error(ErrorCode::kUsage, reason);
}

void understandChannels(std::string_view text, RenderRequest& request) {
  request.want_depth = text == "depth" || text == "depth,ids" || text == "ids,depth";
  request.want_ids = text == "ids" || text == "depth,ids" || text == "ids,depth";
  if (!request.want_depth && !request.want_ids)
    refuse(fmt::format("--channels {}: expected depth, ids or depth,ids", text));
}

void understandOutput(const RenderArguments& arguments, RenderRequest& request) {
  request.output = arguments.output.value_or("");
  if (arguments.output && request.output.empty()) refuse("-o: the name of the file is empty");
  if (request.output.empty() && !request.table && request.timings_file.empty() && request.trace_file.empty())
    refuse("-o FILE is missing (without it, --timings or --trace must ask for the times)");
  const bool file = !request.output.empty() && request.output != "-";
  const raster::PictureFormat format = file ? raster::formatOf(request.output) : raster::PictureFormat{.name = "PNG"};
  checkBackground(arguments, request, format);
  if (!arguments.channels) return;
  understandChannels(*arguments.channels, request);
  if (!format.extra_channels)
    refuse(fmt::format("--channels: only OpenEXR (-o FILE.exr) holds more than colour, not {}", format.name));
}

void understandMeasuring(const RenderArguments& arguments, RenderRequest& request) {
  request.table = arguments.timings == kBareTimings;
  if (!request.table) request.timings_file = arguments.timings;
  request.trace_file = arguments.trace.value_or("");
  if (arguments.frames) {
    request.frames = static_cast<int>(parseWhole("--frames", *arguments.frames, 1, kMaxFrames));
    if (arguments.timings.empty() && !arguments.trace)
      refuse("--frames repeats the picture to measure it: add --timings or --trace");
  }
}

/// What is of no use with the colours that were asked for, or without any.
void refuseIdleColorOptions(const RenderArguments& arguments, const RenderRequest& request) {
  const CutArguments& cut = arguments.cut;
  for (const auto& [given, option] : {std::pair{cut.clusters.has_value(), "--clusters"},
                                      {cut.tolerance.has_value(), "--tolerance"},
                                      {cut.max_faces.has_value(), "--max-faces"},
                                      {cut.weights.has_value(), "--weights"}})
    if (given && request.color_by != ColorBy::kCluster)
      refuse(fmt::format("{} is about face clusters: add --color-by cluster", option));
  if (cut.from && request.color_by != ColorBy::kCluster)
    refuse(fmt::format("--from {} holds face clusters: add --color-by cluster", *cut.from));
  if (cut.overlay && !request.color_by) refuse("--overlay is drawn over parts of a surface: say with --color-by which");
  if (request.color_by == ColorBy::kPatch && request.cut.overlay.planes)
    refuse("--overlay planes: patches have boxes only");
  if (request.color_by == ColorBy::kGroup && request.cut.overlay.boxes)
    refuse("--overlay boxes: vertex groups have planes (or lines) only");
  if (request.color_by == ColorBy::kGroup && request.grouping.method == pipeline::Grouping::kNone &&
      request.saved_groups.empty())
    refuse("--color-by group: there are no vertex groups: add --grouping planar, linear or cluster, or --from");
}

void understandColors(const RenderArguments& arguments, RenderRequest& request) {
  if (arguments.color_by) request.color_by = choose("--color-by", *arguments.color_by, kColorByNames);
  // Who wants to see groups wants to see them in small meshes too.
  if (request.color_by == ColorBy::kGroup && !arguments.grouping.prefer)
    request.grouping.prefer = pipeline::Prefer::kMemory;
  request.cut = understandCut(arguments.cut);
  refuseIdleColorOptions(arguments, request);
}

/// The kind of the saved file decides what it is taken for.
void sortSavedFile(RenderArguments& arguments) {
  if (!arguments.from) return;
  if (arguments.from->empty()) refuse("--from: the name of the file is empty");
  const bool has_groups = savedKindOf(*arguments.from) == SavedKind::kVertexGroups;
  (has_groups ? arguments.grouping.from : arguments.cut.from) = arguments.from;
}

void addColorOptions(CLI::App& command, RenderArguments& a) {
  command
      .add_option("--color-by", a.color_by,
                  "In place of the surface's own colours those of its face clusters (all\ninstances clustered as one "
                  "mesh), of its vertex groups, or of the\npatches that it is drawn by")
      ->type_name("cluster|group|patch")
      ->group("Colours");
  for (CLI::Option* option : addCutOptions(command, a.cut)) option->group("Colours");
}

void addOutputOptions(CLI::App& command, RenderArguments& a) {
  command.add_option("-o,--output", a.output, "PNG, JPEG, EXR, TIFF, HDR ... by the extension; - is PNG to stdout")
      ->type_name("FILE");
  command
      .add_option("--channels", a.channels,
                  "Further channels of an EXR: depth (Z, distance along the view),\nids (instance_id, triangle_id) or "
                  "depth,ids")
      ->type_name("LIST");
  command.add_flag("--no-patch-culling", a.no_patch_culling,
                   "Transform every vertex: the classic pipeline, to compare with");
}

void addMeasuringOptions(CLI::App& command, RenderArguments& a) {
  command
      .add_flag("--timings", a.timings,
                "Print where the time went, stage by stage;\n--timings=FILE.json writes it as JSON")
      ->group("Measuring");
  command.add_option("--trace", a.trace, "Write a trace with a track per thread, for Perfetto")
      ->type_name("FILE.json")
      ->group("Measuring");
  command.add_option("--frames", a.frames, "Draw the picture N times, report median and spread (default 1)")
      ->type_name("N")
      ->group("Measuring");
}

}  // namespace

void addRenderOptions(CLI::App& command, const std::shared_ptr<RenderArguments>& arguments) {
  RenderArguments& a = *arguments;
  command.add_option("INPUT", a.input, "A mesh file, or builtin:NAME?key=value&... (see sheaf scenes)")->required();
  addOutputOptions(command, a);
  addPictureOptions(command, a);
  addCameraOptions(command, a);
  addGroupingOptions(command, a.grouping, {});
  command
      .add_option("--from", a.from,
                  "Take vertex groups that sheaf group -o has saved of the same mesh, or\nface clusters (with "
                  "--color-by cluster) of sheaf cluster --hierarchy")
      ->type_name("FILE.sheaf")
      ->group("Groups");
  addColorOptions(command, a);
  addMeasuringOptions(command, a);
  command.footer(std::string(kFooter) + kExitCodes);
}

RenderRequest understand(RenderArguments arguments) {
  RenderRequest request;
  sortSavedFile(arguments);
  understandScene(arguments, request);
  understandMeasuring(arguments, request);
  understandOutput(arguments, request);
  if (arguments.no_patch_culling) request.culling = pipeline::Culling::kNone;
  request.grouping = understandGrouping(arguments.grouping, {});
  request.saved_groups = arguments.grouping.from.value_or("");
  understandColors(arguments, request);
  return request;
}

}  // namespace sheaf::cli
