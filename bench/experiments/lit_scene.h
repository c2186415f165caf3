// bench/experiments/lit_scene: the scenes and cameras that frames are timed with.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bench/experiments/experiment.h"
#include "scenes/camera_path.h"
#include "scenes/scene.h"

namespace sheaf::experiments {

/// `name` of a model, simplified to so many vertices or whole (0), smooth and single-sided; or builtin:... as it is.
/// With lights.
scenes::Scene litScene(Context& context, const std::string& name, std::size_t vertices = 0);

/// The first camera of all paths: the whole scene in view, 16:9.
scenes::PathOptions timedPath();
std::vector<scenes::Camera> timedOrbit(const scenes::Scene& scene, int count);

}  // namespace sheaf::experiments
