#include "cli/scene_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>

#include "cli/build_info.h"
#include "cli/saved_file.h"
#include "core/error.h"
#include "raster/srgb.h"
#include "scenes/camera.h"

namespace sheaf::cli {
namespace {

constexpr int kMaxThreads = 256;

// Light and neutral, so that dark and bright models stand out.
constexpr Rgba8 kDefaultBackground{233, 235, 238};

[[noreturn]] void refuse(const std::string& reason) {
  throw Error(ErrorCode::kUsage, reason);
}

void understandUp(const SceneArguments& arguments, SceneRequest& request) {
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

void understandView(const SceneArguments& arguments, ViewRequest& view) {
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

}  // namespace

void addPictureOptions(CLI::App& command, SceneArguments& a) {
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
      .add_option("--threads", a.threads,
                  "Number of threads, 1 to 256 (default: one per core);\nthe image does not depend on it")
      ->type_name("N");
  command.add_option("--simd", a.simd, "Use this SIMD target (see sheaf --version);\nthe image does not depend on it")
      ->type_name("NAME");
  command.add_flag("-q,--quiet", a.quiet, "No warnings and no progress on stderr");
}

void addCameraOptions(CLI::App& command, SceneArguments& a) {
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

void understandScene(const SceneArguments& arguments, SceneRequest& request) {
  request.input = arguments.input;
  if (arguments.size) request.size = parseSize("--size", *arguments.size);
  if (arguments.background) request.background = parseColor("--background", *arguments.background);
  understandUp(arguments, request);
  understandView(arguments, request.view);
  if (arguments.crease) {
    if (isBuiltin(request.input)) refuse("--crease is for files: the built-in scenes bring their normals");
    request.crease_angle_rad = radians(parseNumber("--crease", *arguments.crease, 0.0, 180.0));
  }
  if (arguments.threads)
    request.threads = static_cast<int>(parseWhole("--threads", *arguments.threads, 1, kMaxThreads));
  request.simd = arguments.simd;
  request.quiet = arguments.quiet;
}

void checkBackground(const SceneArguments& arguments, const SceneRequest& request,
                     const raster::PictureFormat& format) {
  if (request.background && request.background->a < 255 && !format.alpha)
    refuse(fmt::format("--background {}: {} has no alpha channel", *arguments.background, format.name));
}

bool isBuiltin(const std::string& input) {
  return input.starts_with("builtin:");
}

std::vector<std::string> inputFiles(const SceneRequest& request) {
  return isBuiltin(request.input) ? std::vector<std::string>{} : std::vector{request.input};
}

scenes::Scene importScene(const SceneRequest& request) {
  scenes::ImportOptions options;
  options.z_up = request.view.z_up;
  refuseAsScene(request.input);
  if (request.crease_angle_rad) options.crease_angle_rad = *request.crease_angle_rad;
  return scenes::loadScene(request.input, options);
}

pipeline::RunContext contextOf(const SceneRequest& request, const TaskPool& pool) {
  return {.input = request.input,
          .width = request.size.width,
          .height = request.size.height,
          .threads = pool.threadCount(),
          .simd_target = simdTargets().front(),
          .build = buildText(),
          .revision = revisionText(),
          .flags = flagsText(),
          .cpu = cpuModel()};
}

Vec4 backgroundOf(const SceneRequest& request, const scenes::Scene& scene) {
  if (!request.background && scene.background) return Vec4(*scene.background, 1.0F);
  const Rgba8 c = request.background.value_or(kDefaultBackground);
  const auto& linear = raster::srgbDecodeTable();
  return {linear[c.r], linear[c.g], linear[c.b], static_cast<float>(c.a) / 255.0F};
}

}  // namespace sheaf::cli
