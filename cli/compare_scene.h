// cli/compare_scene: `sheaf compare INPUT`: a scene drawn with groups, and what that does to its pictures.
#pragma once

#include <optional>
#include <string>

#include "cli/compare_limits.h"
#include "cli/grouping_options.h"
#include "cli/scene_options.h"
#include "cli/views.h"

namespace sheaf::cli {

/// The options as they were written; absent ones are empty.
struct SceneCompareArguments : SceneArguments {
  GroupingArguments grouping;
  Text views;
  Text report;
};

/// The same, understood and checked.
struct SceneCompareRequest : SceneRequest {
  pipeline::GroupingOptions grouping;
  std::string saved_groups;  ///< a file to take groups from, else empty
  ViewsRequest views;
  Limits limits;       ///< of quality
  std::string output;  ///< original, grouped and heat map side by side; empty: not written
  std::string report;  ///< HTML; empty: not written
  bool json = false;
};

/// Adds what is only for scenes; INPUT is for the command to add.
void addSceneCompareOptions(CLI::App& command, SceneCompareArguments& arguments);

/// Throws Error(kUsage) that names the option and the reason.
void understandSceneCompare(const SceneCompareArguments& arguments, SceneCompareRequest& request);

/// The exit code: 1 when drawing is not right in some view, or quality is beyond the limits in one.
int compareScene(const SceneCompareRequest& request);

}  // namespace sheaf::cli
