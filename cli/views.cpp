#include "cli/views.h"

#include <fmt/format.h>

#include "cli/view.h"
#include "core/error.h"
#include "scenes/camera.h"
#include "scenes/camera_path.h"

namespace sheaf::cli {
namespace {

constexpr int kMaxViews = 10000;
constexpr Orbit kDefaultStart{radians(30.0), radians(20.0)};
constexpr double kShares[] = {0.05, 0.25, 0.5};

[[noreturn]] void refuse(const std::string& reason) {
  throw Error(ErrorCode::kUsage, reason);
}

void refuseCameras(const ViewsRequest& request, const ViewRequest& view) {
  if (view.named || view.eye || view.file_camera)
    refuse("--views chooses the cameras: leave out --view, --eye and --camera");
  const bool turns = request.kind == Views::kOrbit || request.kind == Views::kInside;
  if (view.orbit && !turns) refuse("--orbit with --views is where an orbit or the way inside begins");
  if (view.orthographic && request.kind != Views::kOrbit)
    refuse("--orthographic: of --views only an orbit can be seen in parallel projection");
  if (view.fov_rad && request.kind == Views::kFile) refuse("--fov: the cameras of the file have their own");
}

std::string nameOf(const ViewRequest& view) {
  if (view.orbit)
    return fmt::format("{:.6g},{:.6g}", degrees(view.orbit->azimuth_rad), degrees(view.orbit->elevation_rad));
  if (view.eye) return std::string("eye");
  return view.named.value_or("iso");
}

std::vector<scenes::Camera> camerasOfFile(const scenes::Scene& scene, const std::string& file, bool z_up) {
  std::vector<scenes::Camera> cameras = scenes::readCameras(file);
  const Box3 box = boundsOf(scene);
  for (scenes::Camera& camera : cameras) {
    camera.eye = worldFromFile(camera.eye, z_up);
    camera.target = worldFromFile(camera.target, z_up);
    camera.up = worldFromFile(camera.up, z_up);
    camera = scenes::fitClipPlanes(camera, box);
  }
  return cameras;
}

}  // namespace

ViewsRequest understandViews(const std::string& text, const ViewRequest& view) {
  ViewsRequest request;
  const std::size_t colon = text.find(':');
  const std::string word = text.substr(0, colon);
  const bool counted = colon != std::string::npos && (word == "orbit" || word == "fly");
  if (counted)
    request.count =
        static_cast<int>(parseWhole(fmt::format("--views {}:N", word), text.substr(colon + 1), 1, kMaxViews));
  if (text == "inside") {
    request.kind = Views::kInside;
  } else if (text == "orbit" || (counted && word == "orbit")) {
    request.kind = Views::kOrbit;
  } else if (text == "fly" || (counted && word == "fly")) {
    request.kind = Views::kFly;
  } else if (text.ends_with(".json")) {
    request.kind = Views::kFile;
    request.file = text;
  } else {
    refuse(fmt::format("--views {}: expected orbit, orbit:N, inside, fly, fly:N or a .json file of cameras", text));
  }
  refuseCameras(request, view);
  return request;
}

std::vector<ViewRow> makeViews(const scenes::Scene& scene, const ViewsRequest& request, const ViewRequest& view,
                               double aspect, int default_count) {
  const Orbit start = view.orbit.value_or(kDefaultStart);
  scenes::PathOptions options;
  options.azimuth_rad = start.azimuth_rad;
  options.elevation_rad = start.elevation_rad;
  options.aspect = aspect;
  if (view.fov_rad) options.vertical_fov_rad = *view.fov_rad;
  options.orthographic = view.orthographic;
  const int count = request.count.value_or(default_count);
  switch (request.kind) {
    case Views::kOrbit:
      return {{"orbit", std::nullopt, orbitPath(scene, count, options)}};
    case Views::kFly:
      return {{"fly", std::nullopt, flyPath(scene, count, options)}};
    case Views::kFile:
      return {{"file", std::nullopt, camerasOfFile(scene, request.file, view.z_up)}};
    case Views::kInside: {
      std::vector<ViewRow> rows;
      for (const double share : kShares) {
        scenes::InsideView inside = insideView(scene, share, options);
        inside.camera.name = fmt::format("inside {:.0f} %", 100.0 * share);
        rows.push_back({inside.camera.name, inside.share_in_view, {inside.camera}});
      }
      return rows;
    }
    case Views::kOne:
      break;
  }
  scenes::Camera camera = chooseCamera(scene, view, aspect);
  if (camera.name.empty()) camera.name = nameOf(view);
  return {{"view", std::nullopt, {camera}}};
}

}  // namespace sheaf::cli
