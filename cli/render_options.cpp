#include "cli/render_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "cli/commands.h"
#include "core/error.h"
#include "raster/image_io.h"
#include "scenes/camera.h"

namespace sheaf::cli {
namespace {

// What the option parser stores for a flag without a value.
constexpr std::string_view kBareTimings = "true";
constexpr int kMaxThreads = 256;
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
    "\n";

[[noreturn]] void refuse(const std::string& reason) {
  throw Error(ErrorCode::kUsage, reason);
}

bool isBuiltin(const std::string& input) {
  return input.starts_with("builtin:");
}

void understandUp(const RenderArguments& arguments, RenderRequest& request) {
  std::optional<bool> z_up;
  for (const std::string& text : arguments.up) {
    const Up up = parseUp("--up", text);
    if (up.direction ? request.view.up.has_value() : z_up.has_value())
      refuse(fmt::format("--up {}: there is another --up of this kind", text));
    if (up.direction)
      request.view.up = up.direction;
    else
      z_up = up.z_axis;
  }
  request.view.z_up = z_up.value_or(false);
  if (z_up && isBuiltin(request.input)) refuse("--up y|z is for files: the built-in scenes have +Y up");
}

void understandView(const RenderArguments& arguments, ViewRequest& view) {
  std::vector<std::string> choices;
  const auto note = [&](bool given, const char* option) {
    if (given) choices.emplace_back(option);
  };
  note(arguments.view.has_value(), "--view");
  note(arguments.orbit.has_value(), "--orbit");
  note(arguments.eye.has_value(), "--eye");
  note(arguments.camera.has_value(), "--camera");
  if (choices.size() > 1)
    refuse(fmt::format("{} and {} each choose a camera: give one of them", choices[0], choices[1]));
  if (arguments.view) {
    scenes::namedView(*arguments.view);  // throws for an unknown name, before anything is read
    view.named = arguments.view;
  }
  if (arguments.orbit) view.orbit = parseOrbit("--orbit", *arguments.orbit);
  if (arguments.eye) view.eye = parseVector("--eye", *arguments.eye);
  if (arguments.target) view.target = parseVector("--target", *arguments.target);
  view.file_camera = arguments.camera;
  if (arguments.fov) view.fov_rad = radians(parseNumber("--fov", *arguments.fov, 1.0, 170.0));
  view.orthographic = arguments.orthographic;

  if (view.target && !view.eye) refuse("--target needs --eye: the other views choose where they look");
  if (view.up && !view.eye) refuse("--up X,Y,Z needs --eye: the other views choose their up direction");
  if (view.eye && view.target && *view.eye == *view.target) refuse("--eye and --target are the same point");
  if (view.orthographic && view.file_camera)
    refuse("--orthographic and --camera: the file's camera has its own projection");
  if (view.orthographic && view.fov_rad && !view.eye)
    refuse("--fov and --orthographic: a parallel projection has no field of view");
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
  if (request.background && request.background->a < 255 && !format.alpha)
    refuse(fmt::format("--background {}: {} has no alpha channel", *arguments.background, format.name));
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

void addPictureOptions(CLI::App& command, RenderArguments& a) {
  command.add_option("-o,--output", a.output, "PNG, JPEG, EXR, TIFF, HDR ... by the extension; - is PNG to stdout")
      ->type_name("FILE");
  command.add_option("--size", a.size, "Pixels, each side 1 to 16384 (default 1280x720)")->type_name("WxH");
  command
      .add_option("--background", a.background,
                  "A name, #rgb, #rrggbb, #rrggbbaa or transparent\n(default: the file's own, else light grey)")
      ->type_name("COLOR");
  command
      .add_option("--crease", a.crease,
                  "Edges sharper than this stay sharp where the file has no\nnormals, 0 to 180 (default 60)")
      ->type_name("DEG");
  command
      .add_option("--channels", a.channels,
                  "Further channels of an EXR: depth (Z, distance along the view),\nids (instance_id, triangle_id) or "
                  "depth,ids")
      ->type_name("LIST");
  command
      .add_option("--threads", a.threads,
                  "Number of threads, 1 to 256 (default: one per core);\nthe image does not depend on it")
      ->type_name("N");
  command.add_option("--simd", a.simd, "Use this SIMD target (see sheaf --version);\nthe image does not depend on it")
      ->type_name("NAME");
  command.add_flag("--no-patch-culling", a.no_patch_culling,
                   "Transform every vertex: the classic pipeline, to compare with");
  command.add_flag("-q,--quiet", a.quiet, "No warnings on stderr");
}

void addCameraOptions(CLI::App& command, RenderArguments& a) {
  const auto add = [&](const char* name, auto& value, const std::string& meaning, const char* type) {
    return command.add_option(name, value, meaning)->type_name(type)->group("Camera");
  };
  const std::vector<std::string>& views = scenes::namedViews();
  add("--view", a.view, fmt::format("See the whole scene from one of:\n{}", fmt::join(views, ", ")), "NAME");
  add("--orbit", a.orbit,
      "The same from any side, degrees: 0,0 is the front, the azimuth\ngrows to the right, the elevation lies between "
      "-90 and 90",
      "AZ,EL");
  add("--eye", a.eye, "Look from this point", "X,Y,Z");
  add("--target", a.target, "... at this one (default: the middle of the scene)", "X,Y,Z");
  add("--camera", a.camera, "A camera of the file, by name or number (see sheaf info)", "N|NAME");
  add("--up", a.up, "y or z: which axis is up in the file (default y);\nX,Y,Z: the camera's up direction, with --eye",
      "y|z|X,Y,Z")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false);
  add("--fov", a.fov, "Vertical field of view, 1 to 170 degrees\n(default: that of the file's camera, else 40)", "DEG");
  command
      .add_flag("--orthographic", a.orthographic,
                "Parallel projection; with --eye as tall as the perspective\npicture is at the target")
      ->group("Camera");
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
  addPictureOptions(command, a);
  addCameraOptions(command, a);
  addMeasuringOptions(command, a);
  command.footer(std::string(kFooter) + kExitCodes);
}

RenderRequest understand(const RenderArguments& arguments) {
  RenderRequest request;
  request.input = arguments.input;
  if (arguments.size) request.size = parseSize("--size", *arguments.size);
  if (arguments.background) request.background = parseColor("--background", *arguments.background);
  understandUp(arguments, request);
  understandView(arguments, request.view);
  understandMeasuring(arguments, request);
  understandOutput(arguments, request);
  if (arguments.crease) {
    if (isBuiltin(request.input)) refuse("--crease is for files: the built-in scenes bring their normals");
    request.crease_angle_rad = radians(parseNumber("--crease", *arguments.crease, 0.0, 180.0));
  }
  if (arguments.threads)
    request.threads = static_cast<int>(parseWhole("--threads", *arguments.threads, 1, kMaxThreads));
  request.cull_patches = !arguments.no_patch_culling;
  request.simd = arguments.simd;
  request.quiet = arguments.quiet;
  return request;
}

}  // namespace sheaf::cli
