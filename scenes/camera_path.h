// scenes/camera_path: rows of cameras, for looking at a scene from many sides and for measuring along a way through it.
// All cameras returned here have near and far set, but for those that are read from a file.
#pragma once

#include <filesystem>
#include <vector>

#include "scenes/scene.h"

namespace sheaf::scenes {

/// From where a path sets out, and through which lens.
struct PathOptions {
  double azimuth_rad = 0.0;  ///< as orbitView()
  double elevation_rad = 0.0;
  double aspect = 1.0;  ///< width / height of the picture
  double vertical_fov_rad = Camera{}.vertical_fov_rad;
  bool orthographic = false;  ///< of orbits only
};

/// `count` cameras at equal angles around the scene, the first at the azimuth of `options`, each the one that
/// fitCamera() makes. Their names are `AZIMUTH,ELEVATION` in degrees.
std::vector<Camera> orbitPath(const Scene& scene, int count, const PathOptions& options);

/// `count` cameras on a way through the scene along the longer horizontal side of its box: from before it, all of it in
/// view, down into its middle, the head turning to both sides. Names are numbers from 1. The start angles do not count.
std::vector<Camera> flyPath(const Scene& scene, int count, const PathOptions& options);

/// Share of the scene's triangles that have something within the view volume, as far as its planes tell: no plane has
/// all three corners beyond it. [0, 1], 0 without triangles. Exact for each triangle, in double precision.
double shareInView(const Scene& scene, const Camera& camera, double aspect);

struct InsideView {
  Camera camera;
  double share_in_view = 0.0;  ///< what was reached
};

/// A camera that has `share` of the triangles in view, to a hundredth of it where the mesh allows that: on the line
/// from the fitted one into the scene, but not through a surface that faces it; if more is in view even there, through
/// a longer lens. share in (0, 1).
InsideView insideView(const Scene& scene, double share, const PathOptions& options);

/// A JSON array of objects, or an object that has one called cameras, as `sheaf info --json` prints: eye, target
/// (arrays of three numbers), and optionally up, name, and one of vertical_fov_degrees (1 to 170) and
/// orthographic_height. Throws Error(kBadInput) that names file and camera for anything else, an empty array included.
/// Near and far stay 0.
std::vector<Camera> readCameras(const std::filesystem::path& path);

}  // namespace sheaf::scenes
