// cli/saved_groups: drawing with vertex groups that `sheaf group -o` has saved, in place of finding some.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cli/scene_options.h"
#include "pipeline/prepare.h"
#include "scenes/scene.h"

namespace sheaf::cli {

struct GroupsToDraw {
  pipeline::GroupingOptions options;
  /// Of saved groups: by triangle of all instances, one instance after the other, which group it is in (groupOfFace()).
  std::vector<std::uint32_t> group_of_face;
  std::uint32_t group_count = 0;
};

/// What was asked for, or, if there is a file, its groups with the form and the preference that were asked for. Groups
/// are of a scene's instances as one, so the scene then gets a mesh for each instance.
/// file   may be empty
/// scene  as importScene() returns it for the request
/// Throws Error(kBadInput) if the file is damaged, of another kind or of another mesh.
GroupsToDraw groupsToDrawWith(const std::string& file, const pipeline::GroupingOptions& asked,
                              const SceneRequest& request, scenes::Scene& scene);

}  // namespace sheaf::cli
