#include "bench/experiments/picture.h"

#include <algorithm>

#include "mesh/normals.h"
#include "pipeline/overlays.h"
#include "pipeline/prepare.h"
#include "pipeline/renderer.h"
#include "raster/srgb.h"
#include "scenes/camera.h"

namespace sheaf::experiments {
namespace {

constexpr int kSamplesPerSide = 2;

scenes::Material solid(scenes::Solid kind, const Vec3& light, const Vec3& dark, double frequency) {
  scenes::Material material;
  material.base_color = Vec4(1.0F);
  material.solid = kind;
  material.solid_colors = {light, dark};
  material.solid_frequency = static_cast<float>(frequency);
  material.double_sided = true;
  return material;
}

Image8 averaged(const ImageF4& fine) {
  Image8 out(fine.width() / kSamplesPerSide, fine.height() / kSamplesPerSide);
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) {
      Vec4 sum(0.0F);
      for (int dy = 0; dy < kSamplesPerSide; ++dy)
        for (int dx = 0; dx < kSamplesPerSide; ++dx) sum += fine.at(kSamplesPerSide * x + dx, kSamplesPerSide * y + dy);
      sum /= static_cast<float>(kSamplesPerSide * kSamplesPerSide);
      out.at(x, y) = {raster::encodeSrgb(sum.r), raster::encodeSrgb(sum.g), raster::encodeSrgb(sum.b), 255};
    }
  return out;
}

void copyInto(const Image8& from, int left, int top, Image8& to) {
  for (int y = 0; y < from.height(); ++y)
    for (int x = 0; x < from.width(); ++x) to.at(left + x, top + y) = from.at(x, y);
}

}  // namespace

scenes::Material plainGrey() {
  scenes::Material material;
  material.base_color = Vec4(0.6F, 0.6F, 0.6F, 1.0F);
  material.double_sided = true;
  return material;
}

scenes::Material wood(double frequency) {
  return solid(scenes::Solid::kWood, Vec3(0.62F, 0.38F, 0.17F), Vec3(0.30F, 0.14F, 0.05F), frequency);
}

scenes::Material marble(double frequency) {
  return solid(scenes::Solid::kMarble, Vec3(0.82F, 0.80F, 0.76F), Vec3(0.17F, 0.18F, 0.21F), frequency);
}

scenes::Scene sceneOf(mesh::Mesh mesh, const scenes::Material& material) {
  if (mesh.normals.empty()) mesh::makeSmoothNormals(mesh, kPi);
  scenes::Scene scene;
  scene.meshes.push_back(std::move(mesh));
  scene.materials.push_back(material);
  scene.instances.emplace_back();
  return scene;
}

scenes::Camera cameraOn(const scenes::Scene& scene, double azimuth, double elevation, const Panel& panel) {
  constexpr double kFov = 0.5;
  const double aspect = static_cast<double>(panel.width) / panel.height;
  return scenes::fitCamera(scene, scenes::orbitView(radians(azimuth), radians(elevation)), aspect, kFov, false);
}

Image8 draw(scenes::Scene scene, const scenes::Camera& camera, const Panel& panel, TaskPool& pool, Extras extras) {
  scenes::addDefaultLights(scene, camera);
  Box3 bounds = scenes::boundsOf(scene);
  if (extras.overlay) bounds.extend(scenes::boundsOf(*extras.overlay));
  const scenes::Camera fitted = scenes::fitClipPlanes(camera, bounds);
  pipeline::RenderSettings settings;
  settings.width = kSamplesPerSide * panel.width;
  settings.height = kSamplesPerSide * panel.height;
  settings.background = Vec4(1.0F);
  settings.want_srgb = false;
  settings.want_linear = true;
  settings.want_ids = extras.colors.has_value();
  pipeline::PreparedScene prepared = pipeline::prepareScene(std::move(scene), pool);
  if (extras.overlay) pipeline::addOverlay(std::move(*extras.overlay), prepared, pool);
  pipeline::Renderer renderer(pool);
  pipeline::Frame frame;
  renderer.render(prepared, fitted, settings, frame);
  if (extras.colors) pipeline::colorPixels(*extras.colors, frame, pool);
  return averaged(frame.linear);
}

Image8 sideBySide(std::span<const Image8> pictures) {
  int width = 0;
  for (const Image8& picture : pictures) width += picture.width();
  Image8 whole(width, pictures.front().height());
  int left = 0;
  for (const Image8& picture : pictures) {
    copyInto(picture, left, 0, whole);
    left += picture.width();
  }
  return whole;
}

Image8 stacked(const Image8& above, const Image8& below) {
  Image8 whole(above.width(), above.height() + below.height());
  copyInto(above, 0, 0, whole);
  copyInto(below, 0, above.height(), whole);
  return whole;
}

}  // namespace sheaf::experiments
