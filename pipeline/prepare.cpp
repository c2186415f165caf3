#include "pipeline/prepare.h"

#include <fmt/format.h>

#include <utility>

#include "core/error.h"
#include "grouping/carried_groups.h"
#include "grouping/cluster_patches.h"
#include "grouping/group_quality.h"
#include "grouping/linear_groups.h"
#include "grouping/patch_groups.h"
#include "grouping/planar_groups.h"

namespace sheaf::pipeline {
namespace {

template <typename T>
std::uint64_t bytesOf(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

raster::WrapMode wrapMode(scenes::Wrap wrap) {
  switch (wrap) {
    case scenes::Wrap::kClamp:
      return raster::WrapMode::kClamp;
    case scenes::Wrap::kMirror:
      return raster::WrapMode::kMirror;
    case scenes::Wrap::kRepeat:
      break;
  }
  return raster::WrapMode::kRepeat;
}

raster::SolidTexture solidTexture(scenes::Solid solid) {
  switch (solid) {
    case scenes::Solid::kMarble:
      return raster::SolidTexture::kMarble;
    case scenes::Solid::kWood:
      return raster::SolidTexture::kWood;
    case scenes::Solid::kChecker:
      return raster::SolidTexture::kChecker;
    case scenes::Solid::kNone:
      break;
  }
  return raster::SolidTexture::kNone;
}

raster::ShadeModel shadeModel(scenes::Shading shading) {
  switch (shading) {
    case scenes::Shading::kFlat:
      return raster::ShadeModel::kFlat;
    case scenes::Shading::kUnlit:
      return raster::ShadeModel::kUnlit;
    case scenes::Shading::kSmooth:
      break;
  }
  return raster::ShadeModel::kSmooth;
}

raster::ShadeMaterial shadeMaterial(const scenes::Material& in, const std::vector<raster::MipTexture>& textures) {
  raster::ShadeMaterial out;
  const scenes::TextureUse& use = in.base_color_texture;
  out.base_color = in.base_color;
  if (use.texture >= 0) out.texture = &textures[static_cast<std::size_t>(use.texture)];
  out.sampler = {
      wrapMode(use.wrap_u), wrapMode(use.wrap_v),
      use.filter == scenes::Filter::kNearest ? raster::FilterMode::kNearest : raster::FilterMode::kTrilinear};
  out.uv_linear = use.linear;
  out.uv_offset = use.offset;
  out.solid = solidTexture(in.solid);
  out.solid_colors = in.solid_colors;
  out.solid_frequency = in.solid_frequency;
  out.specular = in.specular;
  out.shininess = in.shininess;
  out.model = shadeModel(in.shading);
  return out;
}

void gatherAttributes(const mesh::Mesh& mesh, const grouping::PatchSet& set, std::size_t begin, std::size_t end,
                      PreparedMesh& out) {
  for (std::size_t slot = begin; slot < end; ++slot) {
    const std::uint32_t v = set.vertex_source[slot];
    if (!out.position[0].empty())
      for (int k = 0; k < 3; ++k) out.position[static_cast<std::size_t>(k)][slot] = mesh.positions[v][k];
    if (!mesh.normals.empty()) out.normal[slot] = raster::vertexNormal(mesh.normals[v]);
    if (!mesh.texcoords.empty())
      for (int k = 0; k < 2; ++k) out.texcoord[static_cast<std::size_t>(k)][slot] = mesh.texcoords[v][k];
    if (!mesh.colors.empty()) {
      const auto packed = raster::packColor(mesh.colors[v]);
      for (std::size_t k = 0; k < 2; ++k) out.color[k][slot] = packed[k];
    }
  }
}

grouping::VertexGroups findGroups(const mesh::Mesh& mesh, const GroupingOptions& options,
                                  const grouping::Progress& progress) {
  if (options.method == Grouping::kLinear) {
    grouping::LinearOptions linear;
    linear.epsilon = options.epsilon;
    linear.metric = options.metric;
    linear.limit = options.limit;
    linear.progress = progress;
    return groupLinear(mesh, linear);
  }
  grouping::PlanarOptions planar;
  planar.epsilon = options.epsilon;
  planar.metric = options.metric;
  planar.limit = options.limit;
  return groupPlanar(mesh, planar);
}

// What is stored by planes, by frames with everything in view (docs/experiments.md, sections large and sweep). Terrain
// and sphere of 4 M vertices are transformed and clipped 1.00 to 1.09 times as fast as in full if runs have at least
// 120 vertices, and 0.91 to 0.93 times if they have 16, where they take 4.8 and 5.0 bytes a vertex in place of 5.6
// and 5.9. Meshes of 0.08 to 0.6 M vertices, which fit the caches, lose: 0.91 to 0.96 times. Border vertices count once
// per patch.
constexpr std::uint32_t kMinPlaneRun = 120;
constexpr std::uint64_t kMinPlanarVertices = 900'000;
// A run of this length takes less memory than its vertices in full.
constexpr std::uint32_t kMinPlaneRunForMemory = 16;
constexpr std::uint32_t kNoPlaneRuns = 1000;

std::uint32_t minPlaneRun(const GroupingOptions& options, const grouping::PatchSet& set) {
  if (options.prefer == Prefer::kMemory) return kMinPlaneRunForMemory;
  std::uint64_t vertices = 0;
  for (const grouping::Patch& patch : set.patches) vertices += patch.vertex_count;
  const bool in_full = options.method == Grouping::kPlanar && vertices < kMinPlanarVertices;
  return in_full ? kNoPlaneRuns : kMinPlaneRun;
}

grouping::VertexGroups findPatchGroups(const mesh::Mesh& mesh, const grouping::PatchSet& set,
                                       const GroupingOptions& options, std::uint32_t min_run, TaskPool& pool) {
  grouping::PatchGroupOptions patch_groups;
  patch_groups.epsilon = options.epsilon;
  patch_groups.metric = options.metric;
  patch_groups.limit = options.limit;
  patch_groups.min_members = min_run;
  return groupInPatches(mesh, set, patch_groups, pool);
}

struct Placed {
  grouping::VertexGroups groups;  // what is measured
  grouping::PlacedVertices vertices;
};

Placed placeFound(const GroupingOptions& options, const grouping::Progress& progress, const mesh::Mesh& mesh,
                  const grouping::PatchSet& set, std::uint32_t min_run, TaskPool& pool) {
  if (options.method == Grouping::kCluster) {
    grouping::VertexGroups groups = findPatchGroups(mesh, set, options, min_run, pool);
    grouping::PlacedVertices vertices = placeInFrames(mesh, groups, set, options.form);
    return {std::move(groups), std::move(vertices)};
  }
  grouping::VertexGroups groups = findGroups(mesh, options, progress);
  grouping::PlacedVertices vertices = placeGrouped(mesh, groups, set, options.form);
  return {std::move(groups), std::move(vertices)};
}

Placed placeSaved(const GroupingOptions& options, const grouping::VertexGroups& groups, const mesh::Mesh& mesh,
                  const grouping::PatchSet& set) {
  return {groups, options.method == Grouping::kCluster
                      ? placeInFrames(mesh, framedByPatch(groups, set), set, options.form)
                      : placeOnGroups(groups, set, options.form)};
}

// Moves the mesh's vertices to where their groups put them and sorts the patches by group.
// saved  of this mesh, or null
void groupVertices(const GroupingOptions& options, const grouping::VertexGroups* saved,
                   const grouping::Progress& progress, mesh::Mesh& mesh, grouping::PatchSet& set, TaskPool& pool,
                   PreparedMesh& out, std::vector<std::string>& warnings) {
  const std::uint32_t min_run = minPlaneRun(options, set);
  Placed placed = saved != nullptr ? placeSaved(options, *saved, mesh, set)
                                   : placeFound(options, progress, mesh, set, min_run, pool);
  grouping::VertexGroups& groups = placed.groups;
  warnings.insert(warnings.end(), groups.warnings.begin(), groups.warnings.end());
  groups.positions = placed.vertices.positions;
  grouping::measure(mesh.positions, mesh.triangles, groups);
  out.grouping = groups.stats;
  mesh.positions = placed.vertices.positions;
  grouping::renewBounds(mesh, set, pool);
  out.vertices = buildVertexRuns(placed.vertices, options.use_groups ? min_run : kNoPlaneRuns, set, pool);
}

// positions_shaded  shading reads positions
PreparedMesh prepareMesh(mesh::Mesh& mesh, const GroupingOptions& options, const grouping::VertexGroups* saved,
                         const grouping::Progress& progress, bool positions_shaded, TaskPool& pool,
                         std::vector<std::string>& warnings) {
  PreparedMesh out;
  out.extent = saved != nullptr ? saved->extent : mesh::boundsOf(mesh).longestEdge();
  grouping::PatchSet set = options.method == Grouping::kCluster ? grouping::clusterPatches(mesh, {}, pool)
                                                                : grouping::splitIntoPatches(mesh, {}, pool);
  if (options.method == Grouping::kNone)
    out.vertices = ungroupedRuns(mesh, set, pool);
  else
    groupVertices(options, saved, progress, mesh, set, pool, out, warnings);

  const std::size_t slots = set.vertex_source.size();
  if (positions_shaded && !out.vertices.isFullBySlot())
    for (auto& axis : out.position) axis.resize(slots);
  if (!mesh.normals.empty()) out.normal.resize(slots);
  if (!mesh.texcoords.empty())
    for (auto& axis : out.texcoord) axis.resize(slots);
  if (!mesh.colors.empty())
    for (auto& half : out.color) half.resize(slots);

  constexpr std::size_t kSlotsPerPiece = 16384;
  pool.parallelFor(static_cast<int>((slots + kSlotsPerPiece - 1) / kSlotsPerPiece), [&](int piece, int) {
    const std::size_t begin = static_cast<std::size_t>(piece) * kSlotsPerPiece;
    gatherAttributes(mesh, set, begin, std::min(slots, begin + kSlotsPerPiece), out);
  });

  for (const grouping::Patch& patch : set.patches) {
    out.bounds.extend(patch.bounds);
    out.vertex_count += patch.vertex_count;
    out.triangle_count += patch.triangle_count;
  }
  out.patches = std::move(set.patches);
  out.tree = grouping::buildPatchTree(out.patches);
  out.corners = std::move(set.corners);
  out.triangle_source = std::move(set.triangle_source);
  return out;
}

// Meshes whose shading reads positions: of solid textures and of flat normals.
std::vector<bool> meshesWithShadedPositions(const scenes::Scene& scene) {
  std::vector<bool> shaded(scene.meshes.size(), false);
  for (const scenes::Instance& instance : scene.instances) {
    const scenes::Material& material = scene.materials[instance.material];
    if (material.solid != scenes::Solid::kNone || material.shading == scenes::Shading::kFlat ||
        scene.meshes[instance.mesh].normals.empty())
      shaded[instance.mesh] = true;
  }
  return shaded;
}

}  // namespace

std::uint64_t PreparedMesh::bytes() const {
  std::uint64_t sum = vertices.bytes() + bytesOf(patches) + tree.bytes() + bytesOf(triangle_source) + bytesOf(normal);
  for (const auto& c : corners) sum += bytesOf(c);
  for (const auto& p : position) sum += bytesOf(p);
  for (const auto& t : texcoord) sum += bytesOf(t);
  for (const auto& c : color) sum += bytesOf(c);
  return sum;
}

const float* PreparedMesh::shadingPosition(std::size_t axis) const {
  if (!position[axis].empty()) return position[axis].data();
  return vertices.isFullBySlot() ? vertices.full.data() + axis * vertices.full_stride : nullptr;
}

PreparedScene prepareScene(scenes::Scene scene, TaskPool& pool, const GroupingOptions& grouping,
                           const grouping::Progress& progress) {
  PreparedScene out;
  const std::vector<bool> positions_shaded = meshesWithShadedPositions(scene);
  out.meshes.reserve(scene.meshes.size());
  double vertices = 0.0, vertices_before = 0.0;
  for (const mesh::Mesh& mesh : scene.meshes) vertices += static_cast<double>(mesh.vertexCount());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const auto vertices_here = static_cast<double>(scene.meshes[m].vertexCount());
    const auto showShare = [&](double done) {
      if (progress) progress((vertices_before + done * vertices_here) / vertices);
      return true;
    };
    try {
      const grouping::VertexGroups* saved = grouping.saved ? &grouping.saved->at(m) : nullptr;
      out.meshes.push_back(
          prepareMesh(scene.meshes[m], grouping, saved, showShare, positions_shaded[m], pool, out.warnings));
    } catch (const Error& e) {  // grouping knows no names of files
      throw Error(e.code(), fmt::format("{}: {}", scene.name, e.what()));
    }
    scene.meshes[m] = {};
    vertices_before += vertices_here;
  }
  for (std::string& warning : out.warnings) warning = fmt::format("{}: {}", scene.name, warning);
  out.textures.reserve(scene.textures.size());
  for (scenes::Texture& texture : scene.textures) {
    out.textures.emplace_back(texture.pixels);
    texture.pixels = {};
  }
  for (const scenes::Material& material : scene.materials) {
    out.materials.push_back(shadeMaterial(material, out.textures));
    out.double_sided.push_back(material.double_sided);
  }
  out.instances = std::move(scene.instances);
  out.lights = std::move(scene.lights);
  if (out.lights.size() > raster::kMaxLights) {
    out.warnings.push_back(fmt::format("{}: has {} lights, only the first {} are used", scene.name, out.lights.size(),
                                       raster::kMaxLights));
    out.lights.resize(raster::kMaxLights);
  }
  out.ambient = scene.ambient;
  return out;
}

}  // namespace sheaf::pipeline
