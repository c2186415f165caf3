// Draws a sphere: uses headers of every module, and links what a static library drags along.
#include <cstdio>

#include "core/task_pool.h"
#include "pipeline/prepare.h"
#include "pipeline/renderer.h"
#include "scenes/builtin.h"
#include "scenes/camera.h"

int main() {
  sheaf::TaskPool pool(2);
  sheaf::scenes::Scene scene = sheaf::scenes::buildBuiltin("sphere?n=8");
  sheaf::pipeline::RenderSettings settings;
  settings.width = 64;
  settings.height = 48;
  sheaf::scenes::Camera camera =
      sheaf::scenes::fitCamera(scene, sheaf::scenes::namedView("iso"), 64.0 / 48.0, sheaf::radians(40.0), false);
  camera = sheaf::scenes::fitClipPlanes(camera, sheaf::scenes::boundsOf(scene));
  const sheaf::pipeline::PreparedScene prepared = sheaf::pipeline::prepareScene(std::move(scene), pool);

  sheaf::pipeline::Renderer renderer(pool);
  sheaf::pipeline::Frame frame;
  renderer.render(prepared, camera, settings, frame);
  const bool drawn = frame.color.at(32, 24).a == 255 && frame.color.at(0, 0).a == 0;
  std::printf("%d x %d pixels, %s\n", frame.color.width(), frame.color.height(), drawn ? "a sphere" : "no sphere");
  return drawn ? 0 : 1;
}
