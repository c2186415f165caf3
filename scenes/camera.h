// scenes/camera: cameras that see the whole scene, and the matrices of a camera.
#pragma once

#include "scenes/scene.h"

namespace sheaf::scenes {

/// Direction from the target to the eye and which way is up, both unit, world space.
struct ViewDirection {
  DVec3 to_eye{0.0, 0.0, 1.0};
  DVec3 up{0.0, 1.0, 0.0};
};

/// Named views: front back left right top bottom iso (and iso's three other corners, see namedViews()).
/// Throws Error(kUsage) for another name.
ViewDirection namedView(const std::string& name);
const std::vector<std::string>& namedViews();

/// Azimuth 0 is the front (+Z), grows counter-clockwise seen from above; elevation in (-90, 90) degrees, in radians
/// here.
ViewDirection orbitView(double azimuth_rad, double elevation_rad);

/// A camera that looks along `view` and sees every vertex with `margin` (a fraction of the picture's side) to spare;
/// the tightest such camera, from the projected vertices, not from a bounding sphere. `aspect` = width / height. An
/// empty scene gets a camera on the unit box.
Camera fitCamera(const Scene& scene, const ViewDirection& view, double aspect, double vertical_fov_rad,
                 bool orthographic, double margin = 0.05);

/// Sets near and far, where they are 0, so that the scene's box lies between them with room to spare; also when the eye
/// is within the box (near is then a small fraction of the extent).
Camera fitClipPlanes(Camera camera, const Box3& world_bounds);

DMat4 viewFromWorld(const Camera& camera);

/// Reversed depth: z/w is 1 at near, 0 at far (design: clip 0 <= z <= w). Near and far must be set.
DMat4 clipFromView(const Camera& camera, double aspect);

/// Lights that suit most models, given the camera: a key from the upper left, a fill, a hemisphere. Only for scenes
/// without lights of their own.
void addDefaultLights(Scene& scene, const Camera& camera);

}  // namespace sheaf::scenes
