#include "scenes/camera_path.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

#include "scenes/camera.h"

namespace sheaf::scenes {
namespace {

/// How far towards a surface the way inside goes: near enough to fill the picture, not yet within it.
constexpr double kRoomBeforeSurface = 0.95;

/// One bit for each of the six clip planes that the point lies beyond.
std::uint8_t beyond(const DVec4& clip) {
  const auto bit = [](bool set, int k) { return static_cast<std::uint8_t>(set ? 1U << k : 0U); };
  return static_cast<std::uint8_t>(bit(clip.x < -clip.w, 0) | bit(clip.x > clip.w, 1) | bit(clip.y < -clip.w, 2) |
                                   bit(clip.y > clip.w, 3) | bit(clip.z < 0.0, 4) | bit(clip.z > clip.w, 5));
}

Camera fittedFrom(const Scene& scene, const Box3& box, double azimuth_rad, const PathOptions& options) {
  const ViewDirection direction = orbitView(azimuth_rad, options.elevation_rad);
  return fitClipPlanes(fitCamera(scene, direction, options.aspect, options.vertical_fov_rad, options.orthographic),
                       box);
}

/// Where origin + t * way, t > 0, first meets a triangle that is drawn as seen from there; infinite if it meets none.
double firstSurface(const Scene& scene, const DVec3& origin, const DVec3& way) {
  double first = std::numeric_limits<double>::infinity();
  for (const Instance& instance : scene.instances) {
    const mesh::Mesh& mesh = scene.meshes[instance.mesh];
    const DMat4 object_from_world = glm::inverse(instance.world_from_object);
    const DVec3 o(object_from_world * DVec4(origin, 1.0));
    const DVec3 d(object_from_world * DVec4(way, 0.0));
    for (const mesh::Triangle& t : mesh.triangles) {
      const DVec3 a(mesh.positions[t[0]]);
      const DVec3 ab = DVec3(mesh.positions[t[1]]) - a;
      const DVec3 ac = DVec3(mesh.positions[t[2]]) - a;
      // Solves o + s d = a + u ab + v ac by Cramer's rule. The determinant is positive where the front is seen, in
      // object space, whatever the instance mirrors.
      const DVec3 n = glm::cross(d, ac);
      const double det = glm::dot(ab, n);
      if (!(det > 0.0 || (det < 0.0 && scene.materials[instance.material].double_sided))) continue;
      const DVec3 ao = o - a;
      const DVec3 q = glm::cross(ao, ab);
      const double u = glm::dot(ao, n) / det;
      const double v = glm::dot(d, q) / det;
      const double s = glm::dot(ac, q) / det;
      if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && s > 0.0) first = std::min(first, s);
    }
  }
  return first;
}

}  // namespace

std::vector<Camera> orbitPath(const Scene& scene, int count, const PathOptions& options) {
  const Box3 box = boundsOf(scene);
  std::vector<Camera> cameras;
  for (int i = 0; i < count; ++i) {
    const double azimuth_rad = options.azimuth_rad + 2.0 * kPi * i / count;
    cameras.push_back(fittedFrom(scene, box, azimuth_rad, options));
    // Turned into [0, 360), and free of what conversion to radians and back leaves behind.
    const double turned = std::round(1000.0 * std::fmod(degrees(azimuth_rad) + 720.0, 360.0)) / 1000.0;
    const double elevation = std::round(1000.0 * degrees(options.elevation_rad)) / 1000.0;
    cameras.back().name = fmt::format("{},{}", turned == 360.0 ? 0.0 : turned, elevation);
  }
  return cameras;
}

std::vector<Camera> flyPath(const Scene& scene, int count, const PathOptions& options) {
  const Box3 box = boundsOf(scene);
  const DVec3 size = box.empty() ? DVec3(1.0) : DVec3(box.size());
  const DVec3 middle = box.empty() ? DVec3(0.0) : DVec3(box.center());
  const DVec3 ahead = size.x > size.z ? DVec3(1.0, 0.0, 0.0) : DVec3(0.0, 0.0, -1.0);
  const DVec3 aside(-ahead.z, 0.0, ahead.x);
  const double length = std::max({size.x, size.y, size.z});
  std::vector<Camera> cameras;
  for (int i = 0; i < count; ++i) {
    const double t = count > 1 ? static_cast<double>(i) / (count - 1) : 0.0;
    const double left = 1.0 - t;
    Camera camera;
    camera.eye = middle + ahead * (length * (1.6 * t - 1.5)) + DVec3(0.0, size.y * 0.1 + length * 0.4 * left, 0.0);
    const double turn = radians(25.0) * std::sin(2.0 * kPi * t);
    camera.target =
        camera.eye + length * (ahead * std::cos(turn) + aside * std::sin(turn) - DVec3(0.0, 0.05 + 0.25 * left, 0.0));
    camera.vertical_fov_rad = options.vertical_fov_rad;
    camera.name = fmt::format("{}", i + 1);
    cameras.push_back(fitClipPlanes(camera, box));
  }
  return cameras;
}

double shareInView(const Scene& scene, const Camera& camera, double aspect) {
  const DMat4 clip_from_world = clipFromView(camera, aspect) * viewFromWorld(camera);
  std::vector<std::uint8_t> codes;
  std::size_t seen = 0;
  for (const Instance& instance : scene.instances) {
    const mesh::Mesh& mesh = scene.meshes[instance.mesh];
    const DMat4 clip_from_object = clip_from_world * instance.world_from_object;
    codes.clear();
    for (const Vec3& p : mesh.positions) codes.push_back(beyond(clip_from_object * DVec4(DVec3(p), 1.0)));
    for (const mesh::Triangle& t : mesh.triangles) seen += (codes[t[0]] & codes[t[1]] & codes[t[2]]) == 0 ? 1 : 0;
  }
  const std::size_t all = scene.triangleCount();
  return all > 0 ? static_cast<double>(seen) / static_cast<double>(all) : 0.0;
}

InsideView insideView(const Scene& scene, double share, const PathOptions& options) {
  assert(share > 0.0 && share < 1.0 && !options.orthographic);
  const Box3 box = boundsOf(scene);
  const Camera outside = fittedFrom(scene, box, options.azimuth_rad, options);
  const DVec3 way = outside.target - outside.eye;
  // Past the point opposite nothing is in view.
  const double farthest = std::min(2.0, kRoomBeforeSurface * firstSurface(scene, outside.eye, way));
  const auto at = [&](double t, double zoom) {
    Camera camera = outside;
    camera.near = camera.far = 0.0;
    camera.eye += t * way;
    camera.target += t * way;
    camera.vertical_fov_rad *= 1.0 - zoom;
    camera = fitClipPlanes(camera, box);
    return InsideView{camera, shareInView(scene, camera, options.aspect)};
  };
  // More is in view at 0, less at 1. Between them the share need not fall steadily, but it passes the wanted one.
  const bool zooms = at(farthest, 0.0).share_in_view > share;
  double more = 0.0;
  double less = 1.0;
  InsideView view{outside, 1.0};
  for (int step = 0; step < 40 && std::abs(view.share_in_view - share) > 0.01 * share; ++step) {
    const double t = 0.5 * (more + less);
    view = zooms ? at(farthest, t) : at(t * farthest, 0.0);
    (view.share_in_view > share ? more : less) = t;
  }
  return view;
}

}  // namespace sheaf::scenes
