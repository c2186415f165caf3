// scenes/floor_light: soft shadows on a floor, computed once and painted into its texture, because the renderer casts
// none.
#pragma once

#include <span>
#include <vector>

#include "core/math.h"
#include "mesh/mesh.h"
#include "scenes/scene.h"

namespace sheaf::scenes {

/// A square of the plane y = height; texel (i, j) of `texels` x `texels` grows with +x and +z.
struct FloorArea {
  double height = 0.0;
  double center_x = 0.0;
  double center_z = 0.0;
  double side = 1.0;
  int texels = 512;
};

struct Occluder {
  const mesh::Mesh* mesh = nullptr;
  DMat4 world_from_object{1.0};
};

/// Part of a light that reaches each texel of a square, 0 = none, 1 = all: row by row.
struct LightMap {
  int side = 0;
  std::vector<float> values;

  /// Between the centres of texels; u, v in [0, 1].
  double at(double u, double v) const;
};

/// The sky's map is coarser: its shadows have no edges.
struct FloorLight {
  LightMap key;
  LightMap sky;
};

/// Shadows of everything above the floor, in a disc of directions about `direction_to_key` and in the upper hemisphere
/// (the sky, darker towards contact).
FloorLight computeFloorLight(const FloorArea& area, std::span<const Occluder> occluders, const DVec3& direction_to_key);

}  // namespace sheaf::scenes
