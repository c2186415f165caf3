// cli/cluster_report: what clustering has made of a mesh, for people and for programs.
#pragma once

#include <string>
#include <vector>

#include "cli/cluster_options.h"
#include "grouping/cluster_cuts.h"

namespace sheaf::cli {

struct ClusterReport {
  const ClusterRequest& request;
  std::string name;  ///< of the scene
  std::size_t vertices = 0;
  std::size_t faces = 0;
  std::size_t components = 0;
  double extent = 0.0;  ///< longest edge of the mesh's box
  grouping::CutFigures figures;
  double ms = 0.0;  ///< of clustering or of loading the hierarchy, without the cut
  std::vector<std::string> warnings;
};

/// A table of seven lines.
std::string clusterText(const ClusterReport& report);
std::string clusterJson(const ClusterReport& report);

}  // namespace sheaf::cli
