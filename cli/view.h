// cli/view: the camera that the options ask for.
#pragma once

#include "cli/scene_options.h"
#include "scenes/scene.h"

namespace sheaf::cli {

/// From the coordinates of a file to those of the scene.
DVec3 worldFromFile(const DVec3& v, bool z_up);

/// A camera whose near and far may be left to scenes::fitClipPlanes(). Throws Error(kUsage) when the scene does not
/// have what is asked for.
scenes::Camera chooseUnfittedCamera(const scenes::Scene& scene, const ViewRequest& request, double aspect);

/// The same with near and far set.
scenes::Camera chooseCamera(const scenes::Scene& scene, const ViewRequest& request, double aspect);

}  // namespace sheaf::cli
