#include "cli/saved_groups.h"

#include <fmt/format.h>

#include <cassert>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/error.h"
#include "grouping/carried_groups.h"
#include "grouping/groups_file.h"
#include "grouping/plane_sets.h"
#include "pipeline/triangle_colors.h"
#include "scenes/join.h"

namespace sheaf::cli {
namespace {

/// The mesh as sheaf group has it: as it is in the file, all instances joined.
mesh::Mesh groupedMesh(const SceneRequest& request) {
  scenes::ImportOptions import;
  import.for_drawing = false;
  return scenes::joinedMesh(scenes::loadScene(request.input, import));
}

[[noreturn]] void refuseChanged(const std::string& input) {
  throw Error(ErrorCode::kBadInput, fmt::format("{}: has changed while it was read", input));
}

/// #V, the vertex of the grouped mesh that each vertex of a drawn one is a copy of: triangles are the same, and so are
/// the places of their corners, or the file is not the one that was read first.
/// triangles  of `grouped`, those that are this mesh's
std::vector<std::uint32_t> sourcesOf(const mesh::Mesh& mesh, const mesh::Mesh& grouped,
                                     std::span<const mesh::Triangle> triangles, const std::string& input) {
  std::vector<std::uint32_t> source(mesh.vertexCount(), grouping::kNoIndex);
  for (std::size_t f = 0; f < triangles.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t drawn = mesh.triangles[f][k], from = triangles[f][k];
      if (mesh.positions[drawn] != grouped.positions[from]) refuseChanged(input);
      source[drawn] = from;
    }
  return source;
}

std::vector<grouping::VertexGroups> groupsByMesh(const grouping::VertexGroups& groups, const mesh::Mesh& grouped,
                                                 const scenes::Scene& scene, const std::string& input) {
  if (scene.triangleCount() != grouped.triangleCount()) refuseChanged(input);
  std::span<const mesh::Triangle> left(grouped.triangles);
  grouping::GroupCarrier carrier(groups);
  std::vector<grouping::VertexGroups> by_mesh;
  for (const mesh::Mesh& mesh : scene.meshes) {
    const std::vector<std::uint32_t> source = sourcesOf(mesh, grouped, left.first(mesh.triangleCount()), input);
    by_mesh.push_back(carrier.carry(mesh, source));
    left = left.subspan(mesh.triangleCount());
  }
  return by_mesh;
}

pipeline::Grouping methodFor(const grouping::VertexGroups& groups) {
  if (groups.kind == grouping::GroupKind::kLine) return pipeline::Grouping::kLinear;
  return groups.planes == grouping::axisPlanes() ? pipeline::Grouping::kPlanar : pipeline::Grouping::kCluster;
}

}  // namespace

GroupsToDraw groupsToDrawWith(const std::string& file, const pipeline::GroupingOptions& asked,
                              const SceneRequest& request, scenes::Scene& scene) {
  if (file.empty()) return {asked, {}, 0};
  const mesh::Mesh grouped = groupedMesh(request);
  const grouping::VertexGroups groups = grouping::loadGroups(file, grouped);
  const DMat4 turn(DVec4(1, 0, 0, 0), DVec4(0, 0, -1, 0), DVec4(0, 1, 0, 0), DVec4(0, 0, 0, 1));
  scene = scenes::withMeshPerInstance(std::move(scene), request.view.z_up ? turn : DMat4(1.0));
  pipeline::GroupingOptions options = asked;
  options.method = methodFor(groups);
  options.metric = groups.metric;
  options.limit = groups.limit;
  options.epsilon = groups.epsilon;
  options.saved =
      std::make_shared<const std::vector<grouping::VertexGroups>>(groupsByMesh(groups, grouped, scene, request.input));
  return {std::move(options), pipeline::groupOfFace(groups, grouped.triangles),
          static_cast<std::uint32_t>(groups.groups.size())};
}

}  // namespace sheaf::cli
