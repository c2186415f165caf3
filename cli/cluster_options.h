// cli/cluster_options: what `sheaf cluster` was asked to do.
#pragma once

#include <memory>
#include <string>

#include "cli/cut_options.h"
#include "cli/scene_options.h"

namespace CLI {
class App;
}

namespace sheaf::cli {

/// The options as they were written; absent ones are empty.
struct ClusterArguments : SceneArguments {
  CutArguments cut;
  Text output;
  Text hierarchy;
  bool json = false;
};

/// The same, understood and checked.
struct ClusterRequest : SceneRequest {
  CutRequest cut;
  std::string output;
  bool is_picture = false;  ///< else a PLY file, where there is an output
  std::string hierarchy;    ///< the file to save it in
  bool json = false;
};

void addClusterOptions(CLI::App& command, const std::shared_ptr<ClusterArguments>& arguments);

/// Throws Error(kUsage) that names the option and the reason.
ClusterRequest understand(const ClusterArguments& arguments);

}  // namespace sheaf::cli
