// Built-in scenes, ready to be drawn.
#pragma once

#include <string>
#include <utility>

#include "core/task_pool.h"
#include "pipeline/prepare.h"
#include "pipeline/renderer.h"
#include "scenes/builtin.h"
#include "scenes/camera.h"

namespace sheaf::pipeline {

/// Every built-in scene, of few triangles.
inline constexpr const char* kSmallScenes[] = {
    "gallery",      "teapot?n=6",    "sphere?n=20", "torusknot?u=90&v=16",
    "terrain?n=65", "city?blocks=3", "cornell?n=6", "fill?layers=5&order=shuffled"};

struct ReadyScene {
  PreparedScene prepared;
  scenes::Camera camera;
};

/// The scene's first camera, or one fitted from the corner.
inline scenes::Camera usualCamera(const scenes::Scene& scene, double aspect) {
  scenes::Camera camera = scene.cameras.empty()
                              ? scenes::fitCamera(scene, scenes::namedView("iso"), aspect, radians(40.0), false)
                              : scene.cameras.front();
  return scenes::fitClipPlanes(camera, scenes::boundsOf(scene));
}

inline ReadyScene makeReady(scenes::Scene scene, const scenes::Camera& camera, TaskPool& pool) {
  if (scene.lights.empty()) scenes::addDefaultLights(scene, camera);
  return {prepareScene(std::move(scene), pool), camera};
}

inline ReadyScene makeReady(const std::string& spec, int width, int height, TaskPool& pool) {
  scenes::Scene scene = scenes::buildBuiltin(spec);
  const scenes::Camera camera = usualCamera(scene, static_cast<double>(width) / height);
  return makeReady(std::move(scene), camera, pool);
}

/// A camera that stands in the middle of the scene's box and looks to the side: much of the scene is behind it, and
/// triangles cross the near plane.
inline scenes::Camera insideCamera(const scenes::Scene& scene) {
  const Box3 box = scenes::boundsOf(scene);
  scenes::Camera camera;
  camera.eye = DVec3(box.center()) + 0.07 * DVec3(box.size());
  camera.target = camera.eye + DVec3(1.0, -0.2, 0.6);
  camera.vertical_fov_rad = radians(70.0);
  return scenes::fitClipPlanes(camera, box);
}

/// Everything that a frame can hold, on the background of the goldens.
inline RenderSettings allChannels(int width, int height) {
  RenderSettings settings;
  settings.width = width;
  settings.height = height;
  settings.background = {0.1F, 0.2F, 0.3F, 1.0F};
  settings.want_linear = settings.want_depth = settings.want_ids = true;
  return settings;
}

inline bool samePicture(const Frame& a, const Frame& b) {
  return a.color == b.color && a.linear == b.linear && a.depth == b.depth && a.instance_id == b.instance_id &&
         a.triangle_id == b.triangle_id;
}

}  // namespace sheaf::pipeline
