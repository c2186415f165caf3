#include "cli/render_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "cli/commands.h"
#include "core/error.h"
#include "raster/image_io.h"

namespace sheaf::cli {
namespace {

// What the option parser stores for a flag without a value.
constexpr std::string_view kBareTimings = "true";
constexpr int kMaxFrames = 100000;

constexpr const char* kFooter =
    "The camera is chosen by one of --view, --orbit, --eye or --camera; without them it is the file's first camera,\n"
    "or, if it has none, --view iso. Lights are added when the file has none. --eye, --target and --up X,Y,Z are in\n"
    "the file's coordinates; --up may be given twice, once as axis and once as direction.\n"
    "\n"
    "Examples:\n"
    "  sheaf render model.glb -o model.png\n"
    "  sheaf render part.stl --up z --view front --orthographic -o part.png --background transparent\n"
    "  sheaf render scan.ply.gz --orbit 30,20 --size 1920x1080 -o scan.png --timings\n"
    "  sheaf render builtin:gallery --eye 4,2,6 --target 0,1,0 --fov 35 -o - > gallery.png\n"
    "  sheaf render model.glb -o model.exr --channels depth,ids\n"
    "  sheaf render builtin:terrain --frames 50 --timings=times.json --trace trace.json\n"
    "  sheaf render scan.ply --grouping planar --epsilon 0.1% -o grouped.png --timings\n"
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
  addGroupingOptions(command, a.grouping, pipeline::Grouping::kNone);
  addMeasuringOptions(command, a);
  command.footer(std::string(kFooter) + kExitCodes);
}

RenderRequest understand(const RenderArguments& arguments) {
  RenderRequest request;
  understandScene(arguments, request);
  understandMeasuring(arguments, request);
  understandOutput(arguments, request);
  if (arguments.no_patch_culling) request.culling = pipeline::Culling::kNone;
  request.grouping = understandGrouping(arguments.grouping, pipeline::Grouping::kNone);
  return request;
}

}  // namespace sheaf::cli
