// cli/render_options: what `sheaf render` was asked to do.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "cli/coloring.h"
#include "cli/grouping_options.h"
#include "cli/scene_options.h"

namespace CLI {
class App;
}

namespace sheaf::cli {

/// The options as they were written; absent ones are empty.
struct RenderArguments : SceneArguments {
  Text output;
  bool no_patch_culling = false;
  GroupingArguments grouping;
  Text color_by;
  Text from;  ///< of groups or clusters: the kind of the file decides
  CutArguments cut;
  Text channels;
  std::string timings;  ///< kBareTimings, a file, or empty
  Text trace;
  Text frames;
};

/// The same, understood and checked: every value in range, no options that contradict each other.
struct RenderRequest : SceneRequest {
  std::string output;  ///< "-": PNG to stdout; empty: nothing is written
  pipeline::Culling culling = pipeline::Culling::kTree;
  pipeline::GroupingOptions grouping;
  std::string saved_groups;  ///< a file to take groups from, else empty
  std::optional<ColorBy> color_by;
  CutRequest cut;  ///< of kCluster; its overlay of all
  bool want_depth = false;
  bool want_ids = false;
  bool table = false;
  std::string timings_file;
  std::string trace_file;
  int frames = 1;
};

/// Adds all options of `sheaf render` to `command`; parsing fills `arguments`.
void addRenderOptions(CLI::App& command, const std::shared_ptr<RenderArguments>& arguments);

/// Throws Error(kUsage) that names the option and the reason.
RenderRequest understand(RenderArguments arguments);

}  // namespace sheaf::cli
