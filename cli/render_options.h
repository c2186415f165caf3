// cli/render_options: what `sheaf render` was asked to do.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/values.h"

namespace CLI {
class App;
}

namespace sheaf::cli {

/// The options as they were written; absent ones are empty.
struct RenderArguments {
  using Text = std::optional<std::string>;
  std::string input;
  Text output;
  Text size;
  Text view;
  Text orbit;
  Text eye;
  Text target;
  std::vector<std::string> up;
  Text fov;
  bool orthographic = false;
  Text camera;
  Text background;
  Text crease;
  Text threads;
  bool no_patch_culling = false;
  Text channels;
  std::string timings;  ///< kBareTimings, a file, or empty
  Text trace;
  Text frames;
  Text simd;
  bool quiet = false;
};

/// Which camera is wanted. At most one of named, orbit, eye and file_camera is set; none: the scene's first camera,
/// else fitted from the corner.
struct ViewRequest {
  std::optional<std::string> named;
  std::optional<Orbit> orbit;
  std::optional<DVec3> eye;     ///< in the file's coordinates, as target and up are
  std::optional<DVec3> target;  ///< none: the middle of the scene
  std::optional<DVec3> up;      ///< none: the file's up axis
  std::optional<std::string> file_camera;
  std::optional<double> fov_rad;
  bool orthographic = false;
  bool z_up = false;  ///< what the file's coordinates are
};

/// The same, understood and checked: every value in range, no options that contradict each other.
struct RenderRequest {
  std::string input;
  std::string output;  ///< "-": PNG to stdout; empty: nothing is written
  Size size{1280, 720};
  ViewRequest view;
  std::optional<Rgba8> background;
  std::optional<double> crease_angle_rad;
  int threads = 0;
  bool cull_patches = true;
  bool want_depth = false;
  bool want_ids = false;
  bool table = false;
  std::string timings_file;
  std::string trace_file;
  int frames = 1;
  std::optional<std::string> simd;
  bool quiet = false;
};

/// Adds all options of `sheaf render` to `command`; parsing fills `arguments`.
void addRenderOptions(CLI::App& command, const std::shared_ptr<RenderArguments>& arguments);

/// Throws Error(kUsage) that names the option and the reason.
RenderRequest understand(const RenderArguments& arguments);

}  // namespace sheaf::cli
