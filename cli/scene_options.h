// cli/scene_options: which scene, drawn how, seen from where: the options that render, compare and bench share.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/values.h"
#include "core/task_pool.h"
#include "pipeline/timing_report.h"
#include "raster/image_io.h"
#include "scenes/scene.h"

namespace CLI {
class App;
}

namespace sheaf::cli {

/// The options as they were written; absent ones are empty.
struct SceneArguments {
  using Text = std::optional<std::string>;
  std::string input;
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
struct SceneRequest {
  std::string input;
  Size size{1280, 720};
  ViewRequest view;
  std::optional<Rgba8> background;
  std::optional<double> crease_angle_rad;
  int threads = 0;
  std::optional<std::string> simd;
  bool quiet = false;

  double aspect() const { return static_cast<double>(size.width) / size.height; }
};

/// Adds the options; parsing fills `arguments`. Size, background and the like stand among the command's own options,
/// those of the camera in a group of their own. INPUT is for the command to add.
void addPictureOptions(CLI::App& command, SceneArguments& arguments);
void addCameraOptions(CLI::App& command, SceneArguments& arguments);

/// Fills `request`. Throws Error(kUsage) that names the option and the reason.
void understandScene(const SceneArguments& arguments, SceneRequest& request);

/// Throws Error(kUsage) if the background can be seen through and the format of the picture has no alpha.
void checkBackground(const SceneArguments& arguments, const SceneRequest& request, const raster::PictureFormat& format);

bool isBuiltin(const std::string& input);

/// The files among the inputs, for checkOutputs().
std::vector<std::string> inputFiles(const SceneRequest& request);

scenes::Scene importScene(const SceneRequest& request);

/// For reports: what was run on what.
pipeline::RunContext contextOf(const SceneRequest& request, const TaskPool& pool);

/// Linear, straight alpha: what was asked for, else the scene's own, else light grey.
Vec4 backgroundOf(const SceneRequest& request, const scenes::Scene& scene);

}  // namespace sheaf::cli
