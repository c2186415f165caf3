#include "cli/cluster_picture.h"

#include <utility>

#include "cli/view.h"
#include "mesh/normals.h"
#include "pipeline/renderer.h"
#include "raster/image_io.h"
#include "scenes/camera.h"
#include "scenes/painted_parts.h"

namespace sheaf::cli {
namespace {

scenes::Scene sceneOf(mesh::Mesh mesh, const scenes::Scene& original) {
  scenes::Scene scene;
  scene.name = original.name;
  scene.meshes.push_back(std::move(mesh));
  scenes::Material& material = scene.materials.emplace_back();
  material.base_color = Vec4(1.0F);
  material.double_sided = true;
  scene.instances.emplace_back();
  scene.cameras = original.cameras;
  scene.lights = original.lights;
  scene.ambient = original.ambient;
  scene.background = original.background;
  return scene;
}

}  // namespace

void drawClusters(const ClusterRequest& request, const scenes::Scene& scene, mesh::Mesh mesh,
                  std::span<const std::uint32_t> cluster_of_face, std::span<const std::uint32_t> cluster_colors,
                  TaskPool& pool) {
  // Normals first: they shall not show where clusters end.
  mesh::makeSmoothNormals(mesh, request.crease_angle_rad.value_or(scenes::ImportOptions{}.crease_angle_rad));
  scenes::Scene painted = sceneOf(scenes::paintedParts(mesh, cluster_of_face, cluster_colors), scene);
  const scenes::Camera camera = chooseCamera(painted, request.view, request.aspect());
  if (painted.lights.empty()) scenes::addDefaultLights(painted, camera);

  pipeline::RenderSettings settings;
  settings.width = request.size.width;
  settings.height = request.size.height;
  settings.background = backgroundOf(request, painted);
  settings.want_linear = raster::formatOf(request.output).linear;
  settings.want_srgb = !settings.want_linear;
  const pipeline::PreparedScene prepared = pipeline::prepareScene(std::move(painted), pool);
  pipeline::Frame frame;
  pipeline::Renderer(pool).render(prepared, camera, settings, frame);
  const raster::Picture picture{.srgb = frame.color.empty() ? nullptr : &frame.color,
                                .linear = frame.linear.empty() ? nullptr : &frame.linear};
  raster::writePicture(request.output, picture, pool);
}

}  // namespace sheaf::cli
