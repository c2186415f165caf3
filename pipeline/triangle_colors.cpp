#include "pipeline/triangle_colors.h"

#include <array>
#include <cassert>
#include <map>
#include <tuple>

#include "grouping/cluster_colors.h"
#include "mesh/weld.h"
#include "raster/srgb.h"
#include "scenes/join.h"
#include "scenes/painted_parts.h"

namespace sheaf::pipeline {
namespace {

using grouping::kNoIndex;

/// Which part each triangle of a mesh is in, kNoIndex for none.
struct Parts {
  std::vector<std::uint32_t> of_face;
  std::uint32_t count = 0;
};

Parts patchesOf(const PreparedMesh& mesh, std::size_t face_count) {
  Parts parts{std::vector<std::uint32_t>(face_count, kNoIndex), static_cast<std::uint32_t>(mesh.patches.size())};
  for (std::uint32_t p = 0; p < mesh.patches.size(); ++p) {
    const grouping::Patch& patch = mesh.patches[p];
    for (std::uint32_t t = 0; t < patch.triangle_count; ++t)
      parts.of_face[mesh.triangle_source[patch.first_triangle + t]] = p;
  }
  return parts;
}

/// What at least two of them are, else kNoIndex.
std::uint32_t commonOf(const std::array<std::uint32_t, 3>& groups) {
  const auto [a, b, c] = groups;
  if (a == b || a == c) return a;
  return b == c ? b : kNoIndex;
}

/// Planes and lines of a mesh by number, whatever patch their runs are in.
class GroupNumbers {
 public:
  /// kNoIndex for vertices in full. frame  of the patch, in which equal planes are other ones
  std::uint32_t of(const grouping::VertexRun& run, std::uint32_t frame) {
    if (run.kind == grouping::RunKind::kFull) return kNoIndex;
    const auto [entry, is_new] = numbers_.try_emplace({run.axis, run.plane, run.line, frame}, count());
    return entry->second;
  }
  std::uint32_t count() const { return static_cast<std::uint32_t>(numbers_.size()); }

 private:
  std::map<std::tuple<std::uint8_t, float, std::uint32_t, std::uint32_t>, std::uint32_t> numbers_;
};

Parts groupsOf(const PreparedMesh& mesh, std::size_t face_count) {
  Parts parts{std::vector<std::uint32_t>(face_count, kNoIndex)};
  GroupNumbers numbers;
  std::vector<std::uint32_t> group_of_vertex;  // of one patch
  for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
    const grouping::PatchRuns& runs = mesh.vertices.patches[p];
    group_of_vertex.clear();
    for (std::uint32_t r = 0; r < runs.run_count; ++r) {
      const grouping::VertexRun& run = mesh.vertices.runs[runs.first_run + r];
      group_of_vertex.insert(group_of_vertex.end(), run.vertex_count, numbers.of(run, runs.frame));
    }
    const grouping::Patch& patch = mesh.patches[p];
    for (std::uint32_t slot = patch.first_triangle; slot < patch.first_triangle + patch.triangle_count; ++slot) {
      std::array<std::uint32_t, 3> group{};
      for (std::size_t k = 0; k < 3; ++k) group[k] = group_of_vertex[mesh.corners[k][slot]];
      parts.of_face[mesh.triangle_source[slot]] = commonOf(group);
    }
  }
  parts.count = numbers.count();
  return parts;
}

/// The parts of all instances are told apart together, since instances may touch.
TriangleColors colorsOf(const PreparedScene& scene, const SceneSurface& surface,
                        Parts (*parts_of)(const PreparedMesh&, std::size_t face_count)) {
  assert(surface.face_count.size() == scene.instances.size());
  std::vector<Parts> parts_of_mesh(scene.meshes.size());
  Parts all;
  all.of_face.reserve(surface.joined.triangleCount());
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const std::uint32_t mesh = scene.instances[i].mesh;
    Parts& parts = parts_of_mesh[mesh];
    if (parts.of_face.empty()) parts = parts_of(scene.meshes[mesh], surface.face_count[i]);
    for (const std::uint32_t part : parts.of_face) all.of_face.push_back(part == kNoIndex ? part : all.count + part);
    all.count += parts.count;
  }
  const std::vector<std::uint32_t> color_of_part =
      grouping::colorParts(surface.joined, all.of_face, all.count, scenes::kPartColors);
  return colorsByPart(all.of_face, color_of_part, surface.face_count);
}

}  // namespace

void whitenSurfaces(scenes::Scene& scene) {
  for (scenes::Material& material : scene.materials) {
    material.base_color = Vec4(1.0F);
    material.base_color_texture = {};
    material.solid = scenes::Solid::kNone;
    if (material.shading == scenes::Shading::kUnlit) material.shading = scenes::Shading::kSmooth;
  }
  scene.textures.clear();
  for (mesh::Mesh& mesh : scene.meshes) {
    mesh.texcoords = {};
    mesh.colors = {};
  }
}

std::vector<std::size_t> faceCountsOf(const scenes::Scene& scene) {
  std::vector<std::size_t> counts;
  for (const scenes::Instance& instance : scene.instances)
    counts.push_back(scene.meshes[instance.mesh].triangleCount());
  return counts;
}

SceneSurface surfaceOf(const scenes::Scene& scene) {
  return {mesh::surfaceOf(scenes::joinedMesh(scene)), faceCountsOf(scene)};
}

TriangleColors colorsByPart(std::span<const std::uint32_t> part_of_face, std::span<const std::uint32_t> color_of_part,
                            std::span<const std::size_t> face_count) {
  TriangleColors colors;
  for (const std::size_t count : face_count) {
    std::vector<std::uint8_t>& list = colors.emplace_back();
    list.reserve(count);
    for (const std::uint32_t part : part_of_face.first(count))
      list.push_back(part == kNoIndex ? kUncolored : static_cast<std::uint8_t>(color_of_part[part]));
    part_of_face = part_of_face.subspan(count);
  }
  assert(part_of_face.empty());
  return colors;
}

std::vector<std::uint32_t> groupOfFace(const grouping::VertexGroups& groups,
                                       std::span<const mesh::Triangle> triangles) {
  std::vector<std::uint32_t> group_of_face;
  group_of_face.reserve(triangles.size());
  for (const mesh::Triangle& t : triangles)
    group_of_face.push_back(commonOf({groups.owner[t[0]], groups.owner[t[1]], groups.owner[t[2]]}));
  return group_of_face;
}

TriangleColors colorsByPatch(const PreparedScene& scene, const SceneSurface& surface) {
  return colorsOf(scene, surface, patchesOf);
}

TriangleColors colorsByGroup(const PreparedScene& scene, const SceneSurface& surface) {
  return colorsOf(scene, surface, groupsOf);
}

void colorPixels(const TriangleColors& colors, Frame& frame, TaskPool& pool) {
  assert(!frame.linear.empty() && !frame.instance_id.empty() && !frame.triangle_id.empty());
  std::array<Vec4, scenes::kPartColors> palette;
  for (std::uint32_t c = 0; c < palette.size(); ++c) palette[c] = Vec4(scenes::partColor(c), 1.0F);
  pool.parallelFor(frame.linear.height(), [&](int y, int) {
    for (int x = 0; x < frame.linear.width(); ++x) {
      const std::uint32_t instance = frame.instance_id.at(x, y);  // beyond all of them where nothing is
      if (instance >= colors.size()) continue;
      const std::uint8_t color = colors[instance][frame.triangle_id.at(x, y)];
      if (color == kUncolored) continue;
      Vec4& pixel = frame.linear.at(x, y);
      pixel *= palette[color];
      if (!frame.color.empty())
        frame.color.at(x, y) = {raster::encodeSrgb(pixel.r), raster::encodeSrgb(pixel.g), raster::encodeSrgb(pixel.b),
                                0xFF};
    }
  });
}

}  // namespace sheaf::pipeline
