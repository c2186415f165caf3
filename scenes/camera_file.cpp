// Cameras in a JSON file: scenes/camera_path.h.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "scenes/camera_path.h"

namespace sheaf::scenes {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxBytes = std::size_t{64} << 20;
constexpr double kMinFovDegrees = 1.0;
constexpr double kMaxFovDegrees = 170.0;

/// Reads one camera; every complaint names it.
class CameraReader {
 public:
  CameraReader(const Json& json, std::string where) : json_(json), where_(std::move(where)) {}

  Camera read() const {
    if (!json_.is_object()) refuse("is not an object");
    refuseUnknownKeys();
    Camera camera;
    camera.eye = vector("eye");
    camera.target = vector("target");
    if (json_.contains("up")) camera.up = vector("up");
    if (const auto name = json_.find("name"); name != json_.end()) {
      if (!name->is_string()) refuse("name: is not a string");
      camera.name = name->get<std::string>();
    }
    const bool parallel = json_.contains("orthographic_height");
    if (parallel && json_.contains("vertical_fov_degrees"))
      refuse("has both vertical_fov_degrees and orthographic_height");
    if (parallel) {
      camera.orthographic_height = number("orthographic_height");
      if (!(camera.orthographic_height > 0.0)) refuse("orthographic_height: is not above 0");
    } else if (json_.contains("vertical_fov_degrees")) {
      const double fov = number("vertical_fov_degrees");
      if (!(fov >= kMinFovDegrees && fov <= kMaxFovDegrees))
        refuse(fmt::format("vertical_fov_degrees: {} is not within {} to {}", fov, kMinFovDegrees, kMaxFovDegrees));
      camera.vertical_fov_rad = radians(fov);
    }
    refuseBlindness(camera);
    return camera;
  }

 private:
  [[noreturn]] void refuse(const std::string& reason) const {
    throw Error(ErrorCode::kBadInput, fmt::format("{}: {}", where_, reason));
  }

  void refuseUnknownKeys() const {
    for (const auto& item : json_.items()) {
      const std::string& key = item.key();
      if (key != "name" && key != "eye" && key != "target" && key != "up" && key != "vertical_fov_degrees" &&
          key != "orthographic_height")
        refuse(
            fmt::format("unknown key {}; there are name, eye, target, up, vertical_fov_degrees and "
                        "orthographic_height",
                        Json(key).dump(-1, ' ', true, Json::error_handler_t::replace)));
    }
  }

  void refuseBlindness(const Camera& camera) const {
    const DVec3 view = camera.target - camera.eye;
    if (view == DVec3(0.0)) refuse("eye and target are the same point");
    if (camera.up == DVec3(0.0) || glm::length(glm::cross(glm::normalize(camera.up), glm::normalize(view))) < 1e-6)
      refuse("up is zero or along the line of sight");
  }

  double number(const char* key) const { return finite(json_.at(key), key); }

  double finite(const Json& value, const char* key) const {
    if (!value.is_number() || !std::isfinite(value.get<double>())) refuse(fmt::format("{}: is not a number", key));
    return value.get<double>();
  }

  DVec3 vector(const char* key) const {
    const auto value = json_.find(key);
    if (value == json_.end()) refuse(fmt::format("{} is missing", key));
    if (!value->is_array() || value->size() != 3) refuse(fmt::format("{}: is not an array of three numbers", key));
    return {finite((*value)[0], key), finite((*value)[1], key), finite((*value)[2], key)};
  }

  const Json& json_;
  std::string where_;
};

Json parse(const std::filesystem::path& path) {
  try {
    return Json::parse(readFile(path, true, kMaxBytes));
  } catch (const Json::exception& e) {
    throw Error(ErrorCode::kBadInput, fmt::format("{}: {}", path.string(), e.what()));
  }
}

}  // namespace

std::vector<Camera> readCameras(const std::filesystem::path& path) {
  Json json = parse(path);
  if (json.is_object() && json.contains("cameras")) json = Json(json["cameras"]);
  if (!json.is_array() || json.empty())
    throw Error(ErrorCode::kBadInput, fmt::format("{}: has no array of cameras", path.string()));
  std::vector<Camera> cameras;
  for (std::size_t i = 0; i < json.size(); ++i) {
    cameras.push_back(CameraReader(json[i], fmt::format("{}: camera {}", path.string(), i)).read());
    if (cameras.back().name.empty()) cameras.back().name = fmt::format("{}", i);
  }
  return cameras;
}

}  // namespace sheaf::scenes
