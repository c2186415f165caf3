// cli/cluster_options: what `sheaf cluster` was asked to do.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "cli/scene_options.h"
#include "grouping/cluster_cost.h"

namespace CLI {
class App;
}

namespace sheaf::cli {

/// The options as they were written; absent ones are empty.
struct ClusterArguments : SceneArguments {
  Text clusters;
  Text tolerance;
  Text max_faces;
  Text weights;
  Text output;
  Text hierarchy;
  bool json = false;
};

enum class CutBy { kCount, kTolerance, kFaces };

/// The same, understood and checked.
struct ClusterRequest : SceneRequest {
  CutBy cut = CutBy::kCount;
  std::uint32_t count = 64;  ///< of kCount: clusters; of kFaces: faces of a cluster, at most
  double tolerance = 0.0;    ///< of kTolerance: of a corner to its plane, at most; fraction of the extent
  grouping::CostWeights weights;
  std::string output;
  bool is_picture = false;  ///< else a PLY file, where there is an output
  std::string hierarchy;    ///< the file to save it in
  bool json = false;
};

void addClusterOptions(CLI::App& command, const std::shared_ptr<ClusterArguments>& arguments);

/// Throws Error(kUsage) that names the option and the reason.
ClusterRequest understand(const ClusterArguments& arguments);

}  // namespace sheaf::cli
