// cli/cut_options: which face clusters are wanted: the options that cluster and render share, and the clusters
// themselves.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/task_pool.h"
#include "grouping/cluster_cuts.h"
#include "pipeline/overlays.h"
#include "scenes/scene.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace sheaf::cli {

/// The options as they were written; absent ones are empty.
struct CutArguments {
  using Text = std::optional<std::string>;
  Text clusters;
  Text tolerance;
  Text max_faces;
  Text weights;
  Text from;
  Text overlay;
};

enum class CutBy { kCount, kTolerance, kFaces };

/// The same, understood and checked.
struct CutRequest {
  CutBy by = CutBy::kCount;
  std::uint32_t count = 64;  ///< of kCount: clusters; of kFaces: faces of a cluster, at most
  double tolerance = 0.0;    ///< of kTolerance: of a corner to its plane, at most; fraction of the extent
  grouping::CostWeights weights;
  std::string from;  ///< a file to load the hierarchy from; else it is made, with the weights
  pipeline::Overlay overlay;
};

/// Adds the options but --from, which is for the command to add, and returns them.
std::vector<CLI::Option*> addCutOptions(CLI::App& command, CutArguments& arguments);

/// Throws Error(kUsage) that names the option and the reason.
CutRequest understandCut(const CutArguments& arguments);

/// What face clusters are made of, and they.
struct Clustering {
  /// Of the joined scene (mesh::surfaceOf), in the file's coordinates: a saved hierarchy fits whichever axis is up.
  mesh::Mesh surface;
  DMat4 world_from_surface{1.0};
  grouping::FaceClusters clusters;
  grouping::ClusterCut cut;
  double ms = 0.0;  ///< to make or to load the clusters, without the cut
};

/// z_up  as the scene was loaded. Throws Error(kBadInput) if there are no faces, or if the file to load from is damaged
///       or belongs to another mesh.
Clustering clusterScene(const CutRequest& request, const scenes::Scene& scene, const std::string& input, bool z_up,
                        TaskPool& pool);

}  // namespace sheaf::cli
