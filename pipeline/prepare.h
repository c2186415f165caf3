// pipeline: from a scene to a frame: prepare once, then every frame cull, transform, clip, set up and bin, rasterize,
// shade.
//   In     scenes::Scene, scenes::Camera
//   Out    Frame: images, counters, times; clip space is -w <= x, y <= w and 0 <= z <= w, z = w at the near plane
//   Keeps  the same image for any number of threads; nothing is allocated per frame once the renderer is warm
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/math.h"
#include "core/task_pool.h"
#include "grouping/patch_tree.h"
#include "grouping/patches.h"
#include "grouping/vertex_groups.h"
#include "grouping/vertex_runs.h"
#include "raster/shade.h"
#include "raster/texture.h"
#include "scenes/scene.h"

namespace sheaf::pipeline {

enum class Grouping : std::uint8_t {
  kNone,
  kLinear,   ///< lines through two vertices
  kPlanar,   ///< planes across an axis, of the whole mesh
  kCluster,  ///< planes of patches that are made of face clusters
};

using grouping::ParameterForm;

/// Where planes are used. On meshes that fit the caches drawing in full is faster, by planes takes less memory.
enum class Prefer : std::uint8_t {
  kSpeed,   ///< kPlanar: in large meshes only, smaller ones are drawn in full; long runs of vertices only
  kMemory,  ///< wherever it saves memory
};

/// Which vertices of each mesh are moved onto common lines or planes, and how they are then drawn. Grouping is lossy:
/// vertices move by up to epsilon.
struct GroupingOptions {
  Grouping method = Grouping::kNone;
  grouping::Metric metric = grouping::Metric::kDistance;
  grouping::Limit limit = grouping::Limit::kSafe;  ///< of the quadric metric
  double epsilon = 0.005;                          ///< fraction of each mesh's extent
  ParameterForm form = ParameterForm::k16Bit;      ///< 16 bits move a vertex by up to 2^-17 of the largest patch's size
  /// Of kPlanar and kLinear only how vertices are stored. kCluster moves no vertex that is then drawn in full: there
  /// kMemory moves more of them.
  Prefer prefer = Prefer::kSpeed;
  /// By mesh of the scene, taken in place of a search; null: searched. `method` says which kind they are: kPlanar only
  /// on grouping::axisPlanes(), kCluster on planes across any directions; metric, limit and epsilon are theirs.
  /// Vertices are then exactly where these groups have them, but for the form.
  std::shared_ptr<const std::vector<grouping::VertexGroups>> saved;
  /// false: the snapped mesh drawn ungrouped: the same vertices at the same places, each stored and transformed in
  /// full. What grouped drawing is held against.
  bool use_groups = true;
};

/// A mesh cut into patches, its attributes in patch order (structure of arrays). Slots are those of
/// grouping::PatchSet; padding slots hold copies.
struct PreparedMesh {
  std::vector<grouping::Patch> patches;
  grouping::PatchTree tree;  ///< over `patches`, for culling
  std::array<std::vector<std::uint8_t>, 3> corners;
  std::vector<std::uint32_t> triangle_source;
  grouping::VertexRuns vertices;  ///< what is transformed, object space
  /// x, y, z by slot for shading, where it needs them and `vertices` does not have them so: solid textures, flat
  /// normals.
  std::array<std::vector<float>, 3> position;
  std::vector<raster::VertexNormal> normal;         ///< object space; empty = flat
  std::array<std::vector<float>, 2> texcoord;       ///< empty = none
  std::array<std::vector<std::uint32_t>, 2> color;  ///< raster::packColor(); empty = none
  Box3 bounds;
  std::uint64_t vertex_count = 0;  ///< slots that are not padding: border vertices count once per patch
  std::uint64_t triangle_count = 0;
  /// What grouping did to the mesh as it is drawn; counts are 0 when it was not grouped.
  grouping::GroupingStats grouping;
  /// Longest edge of the mesh's box, or of what was grouped as one: the unit of the figures above.
  double extent = 0.0;

  /// By slot; null where shading does not need it.
  const float* shadingPosition(std::size_t axis) const;

  std::uint64_t bytes() const;
  /// Of that, what the geometry stage reads of vertices: coordinates, parameters, runs.
  std::uint64_t vertexBytes() const { return vertices.bytes(); }
};

/// Immutable and shared by all frames and threads. Does not refer to the scene that it was made from. Movable only:
/// materials point to textures.
struct PreparedScene {
  PreparedScene() = default;
  PreparedScene(const PreparedScene&) = delete;
  PreparedScene& operator=(const PreparedScene&) = delete;
  PreparedScene(PreparedScene&&) = default;
  PreparedScene& operator=(PreparedScene&&) = default;

  std::vector<PreparedMesh> meshes;
  std::vector<scenes::Instance> instances;
  std::vector<bool> double_sided;  ///< by material
  std::vector<raster::ShadeMaterial> materials;
  std::vector<raster::MipTexture> textures;
  std::vector<scenes::Light> lights;
  scenes::Ambient ambient;
  std::vector<std::string> warnings;
};

/// Cuts, reorders and packs. The scene's meshes and texture pixels are released as they are taken over, so that mesh
/// and prepared mesh do not stand in memory together for longer than one mesh.
/// progress  of the search for lines, which may take long: its share over all meshes; returning false does not stop it.
///           May be empty
PreparedScene prepareScene(scenes::Scene scene, TaskPool& pool, const GroupingOptions& grouping = {},
                           const grouping::Progress& progress = {});

}  // namespace sheaf::pipeline
