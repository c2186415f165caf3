#include "cli/view.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "core/error.h"
#include "scenes/camera.h"

namespace sheaf::cli {
namespace {

using scenes::Camera;
using scenes::Scene;

constexpr double kDefaultFovRad = Camera{}.vertical_fov_rad;

const Camera& fileCamera(const Scene& scene, const std::string& wanted) {
  for (const Camera& camera : scene.cameras)
    if (camera.name == wanted) return camera;
  std::size_t number = 0;
  const char* end = wanted.data() + wanted.size();
  const auto [stop, ec] = std::from_chars(wanted.data(), end, number);
  if (ec == std::errc() && stop == end && number < scene.cameras.size()) return scene.cameras[number];
  if (scene.cameras.empty()) throw Error(ErrorCode::kUsage, fmt::format("--camera {}: the file has no camera", wanted));
  std::string known;
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) known += fmt::format(" {} ({})", i, scene.cameras[i].name);
  throw Error(ErrorCode::kUsage, fmt::format("--camera {}: the file's cameras are{}", wanted, known));
}

Camera eyeCamera(const Scene& scene, const ViewRequest& request) {
  Camera camera;
  camera.eye = worldFromFile(*request.eye, request.z_up);
  const Box3 box = boundsOf(scene);
  const DVec3 middle = box.empty() ? DVec3(0.0) : DVec3(box.center());
  camera.target = request.target ? worldFromFile(*request.target, request.z_up) : middle;
  if (camera.eye == camera.target)
    throw Error(ErrorCode::kUsage, "--eye is the middle of the scene: say with --target where to look");
  if (request.up) {
    camera.up = worldFromFile(*request.up, request.z_up);
    const DVec3 view = glm::normalize(camera.target - camera.eye);
    if (glm::length(glm::cross(glm::normalize(camera.up), view)) < 1e-6)
      throw Error(ErrorCode::kUsage, "--up is along the line of sight");
  }
  camera.vertical_fov_rad = request.fov_rad.value_or(kDefaultFovRad);
  if (request.orthographic)
    camera.orthographic_height =
        2.0 * glm::length(camera.target - camera.eye) * std::tan(0.5 * camera.vertical_fov_rad);
  return camera;
}

/// A camera of the scene's own, with the field of view that was asked for.
Camera ownCamera(Camera camera, const ViewRequest& request) {
  if (!request.fov_rad) return camera;
  if (camera.orthographic_height > 0.0)
    throw Error(ErrorCode::kUsage, "--fov: the file's camera is orthographic and has no field of view");
  camera.vertical_fov_rad = *request.fov_rad;
  return camera;
}

}  // namespace

DVec3 worldFromFile(const DVec3& v, bool z_up) {
  return z_up ? DVec3(v.x, v.z, -v.y) : v;
}

Camera chooseUnfittedCamera(const Scene& scene, const ViewRequest& request, double aspect) {
  if (request.eye) return eyeCamera(scene, request);
  if (request.file_camera) return ownCamera(fileCamera(scene, *request.file_camera), request);
  if (!request.named && !request.orbit && !request.orthographic && !scene.cameras.empty())
    return ownCamera(scene.cameras.front(), request);
  const scenes::ViewDirection direction =
      request.orbit ? scenes::orbitView(request.orbit->azimuth_rad, request.orbit->elevation_rad)
                    : scenes::namedView(request.named.value_or("iso"));
  return scenes::fitCamera(scene, direction, aspect, request.fov_rad.value_or(kDefaultFovRad), request.orthographic);
}

Camera chooseCamera(const Scene& scene, const ViewRequest& request, double aspect) {
  return scenes::fitClipPlanes(chooseUnfittedCamera(scene, request, aspect), boundsOf(scene));
}

}  // namespace sheaf::cli
