// bench/experiments/picture: small pictures of meshes, drawn by sheaf's renderer.
#pragma once

#include <optional>
#include <span>

#include "core/image.h"
#include "core/task_pool.h"
#include "mesh/mesh.h"
#include "pipeline/triangle_colors.h"
#include "scenes/scene.h"

namespace sheaf::experiments {

struct Panel {
  int width = 360;
  int height = 270;
};

scenes::Material plainGrey();
/// frequency  of the pattern, per unit of the mesh
scenes::Material wood(double frequency);
scenes::Material marble(double frequency);

/// A scene of one mesh; normals are made smooth where it has none.
scenes::Scene sceneOf(mesh::Mesh mesh, const scenes::Material& material);

/// Sees the whole scene from this side, in degrees.
scenes::Camera cameraOn(const scenes::Scene& scene, double azimuth, double elevation, const Panel& panel);

/// What is drawn into the picture of a scene beside the scene.
struct Extras {
  std::optional<pipeline::TriangleColors> colors;
  std::optional<scenes::Scene> overlay;
};

/// Four samples to a pixel, sheaf's default lights, white background.
Image8 draw(scenes::Scene scene, const scenes::Camera& camera, const Panel& panel, TaskPool& pool, Extras extras = {});

/// Pictures of one size from left to right.
Image8 sideBySide(std::span<const Image8> pictures);
/// One above the other, of one width.
Image8 stacked(const Image8& above, const Image8& below);

}  // namespace sheaf::experiments
