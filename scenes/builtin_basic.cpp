// The built-in scenes that are one shape, and the fill-rate load.
#include "scenes/builtin_scenes.h"
#include "scenes/noise.h"
#include "scenes/shapes.h"

namespace sheaf::scenes {
namespace {

Scene sceneOf(mesh::Mesh&& m, Material&& material) {
  Scene scene;
  scene.meshes.push_back(std::move(m));
  scene.materials.push_back(std::move(material));
  scene.instances.emplace_back();
  return scene;
}

/// Colours whose neighbours differ as much as possible: hues a golden section apart.
Vec4 layerColor(int layer) {
  const double turns = 0.6180339887498949 * layer;
  const double hue = 6.0 * (turns - std::floor(turns));
  const auto channel = [&](double center) {
    const double away = std::abs(hue - center);
    return static_cast<float>(0.08 + 0.84 * std::clamp(2.0 - std::min(away, 6.0 - away), 0.0, 1.0));
  };
  return {channel(0.0), channel(2.0), channel(4.0), 1.0F};
}

/// The order in which layers are drawn, 0 = nearest.
std::vector<int> layerOrder(int layers, FillOrder order) {
  std::vector<int> result;
  for (int i = 0; i < layers; ++i) result.push_back(order == FillOrder::kBackToFront ? layers - 1 - i : i);
  if (order == FillOrder::kShuffled)
    for (int i = layers - 1; i > 0; --i)  // Fisher-Yates
      std::swap(result[static_cast<std::size_t>(i)], result[hashOf(i, 0, 0, 1) % static_cast<std::uint32_t>(i + 1)]);
  return result;
}

}  // namespace

Scene buildSphere(const BuiltinArguments& arguments) {
  Material material;
  material.name = "clay";
  material.base_color = Vec4(0.70F, 0.34F, 0.22F, 1.0F);
  material.specular = 0.06F;
  return sceneOf(cubeSphere(arguments.whole("n")), std::move(material));
}

Scene buildTorusKnot(const BuiltinArguments& arguments) {
  Material material;
  material.name = "marble";
  material.base_color = Vec4(1.0F);
  material.solid = Solid::kMarble;
  material.solid_colors = {Vec3(0.86F, 0.84F, 0.80F), Vec3(0.20F, 0.21F, 0.24F)};
  material.solid_frequency = 1.2F;
  material.specular = 0.10F;
  material.shininess = 90.0F;
  TorusKnot knot;
  knot.turns_about_axis = arguments.whole("p");
  knot.turns_through_hole = arguments.whole("q");
  knot.tube_radius = arguments.number("radius");
  return sceneOf(torusKnotMesh(knot, arguments.whole("u"), arguments.whole("v")), std::move(material));
}

Scene buildFill(const BuiltinArguments& arguments) {
  const int layers = arguments.whole("layers");
  const int n = arguments.whole("n");
  const auto order = static_cast<FillOrder>(arguments.whole("order"));

  Scene scene;
  // Sixteen times the picture's height, so that every picture up to 16:1 is covered from edge to edge.
  scene.meshes.push_back(gridSurface({n, n, false, false}, [](double u, double v) {
    return SurfacePoint{DVec3(16.0 * (u - 0.5), 16.0 * (0.5 - v), 0.0), DVec3(0.0, 0.0, 1.0)};
  }));
  for (const int layer : layerOrder(layers, order)) {
    Material material;
    material.name = "layer " + std::to_string(layer);
    material.base_color = layerColor(layer);
    material.shading = Shading::kUnlit;
    Instance instance;
    instance.material = static_cast<std::uint32_t>(scene.materials.size());
    instance.world_from_object[3] = DVec4(0.0, 0.0, -static_cast<double>(layer) / layers, 1.0);
    scene.materials.push_back(std::move(material));
    scene.instances.push_back(instance);
  }
  Camera camera;
  camera.name = "full screen";
  camera.orthographic_height = 1.0;
  camera.eye = DVec3(0.0, 0.0, 1.0);
  camera.near = 0.5;
  camera.far = 2.5;
  scene.cameras.push_back(camera);
  scene.ambient = {Vec3(1.0F), Vec3(1.0F)};
  return scene;
}

}  // namespace sheaf::scenes
