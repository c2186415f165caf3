#include "bench/experiments/lit_scene.h"

#include "bench/experiments/picture.h"
#include "scenes/builtin.h"
#include "scenes/camera.h"

namespace sheaf::experiments {

scenes::Scene litScene(Context& context, const std::string& name, std::size_t vertices) {
  scenes::Scene scene;
  if (name.starts_with("builtin:"))
    scene = scenes::buildBuiltin(name.substr(8));
  else
    scene = sceneOf(vertices == 0 ? context.models.whole(name) : context.models.lod(name, vertices), {});
  const double aspect = timedPath().aspect;
  if (scene.lights.empty())
    scenes::addDefaultLights(scene, scenes::fitCamera(scene, scenes::namedView("iso"), aspect, radians(40.0), false));
  return scene;
}

scenes::PathOptions timedPath() {
  scenes::PathOptions path;
  path.azimuth_rad = radians(30.0);
  path.elevation_rad = radians(20.0);
  path.aspect = 16.0 / 9.0;
  return path;
}

std::vector<scenes::Camera> timedOrbit(const scenes::Scene& scene, int count) {
  return scenes::orbitPath(scene, count, timedPath());
}

}  // namespace sheaf::experiments
