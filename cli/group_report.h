// cli/group_report: what grouping has done to a mesh, for people and for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cli/group_options.h"
#include "grouping/compression.h"
#include "grouping/vertex_groups.h"
#include "mesh/mesh.h"

namespace sheaf::cli {

struct GroupReport {
  const GroupRequest& request;
  std::string name;  ///< of the scene
  std::size_t mesh_vertices = 0;
  std::size_t mesh_triangles = 0;
  const grouping::VertexGroups& groups;
  grouping::CompressionFigures compression;
  std::vector<std::string> warnings;
};

/// `quadric metric, safe limit`
std::string metricText(const grouping::VertexGroups& groups);

/// What can be said without the mesh, for `sheaf group` and about saved groups: epsilon, counts, displacement, faces.
std::string groupFacts(const grouping::VertexGroups& groups);
nlohmann::ordered_json groupFactsJson(const grouping::VertexGroups& groups);

/// A table of a dozen lines.
std::string groupText(const GroupReport& report);
std::string groupJson(const GroupReport& report);

}  // namespace sheaf::cli
