#include "pipeline/triangle_colors.h"

#include <array>
#include <cassert>
#include <map>
#include <numeric>
#include <tuple>

#include "grouping/cluster_colors.h"
#include "mesh/weld.h"
#include "raster/srgb.h"
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
      parts.of_face[mesh.triangle_source[slot]] = group[0] == group[1] || group[0] == group[2] ? group[0]
                                                  : group[1] == group[2]                       ? group[1]
                                                                                               : kNoIndex;
    }
  }
  parts.count = numbers.count();
  return parts;
}

std::vector<std::uint8_t> colorsOf(const mesh::Mesh& surface, const Parts& parts) {
  const std::vector<std::uint32_t> color_of_part =
      grouping::colorParts(surface, parts.of_face, parts.count, scenes::kPartColors);
  std::vector<std::uint8_t> colors;
  colors.reserve(parts.of_face.size());
  for (const std::uint32_t part : parts.of_face)
    colors.push_back(part == kNoIndex ? kUncolored : static_cast<std::uint8_t>(color_of_part[part]));
  return colors;
}

/// One list per mesh.
TriangleColors colorsByMesh(const PreparedScene& scene, std::span<const mesh::Mesh> surfaces,
                            Parts (*parts_of)(const PreparedMesh&, std::size_t face_count)) {
  assert(surfaces.size() == scene.meshes.size());
  TriangleColors colors;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    colors.lists.push_back(colorsOf(surfaces[m], parts_of(scene.meshes[m], surfaces[m].triangleCount())));
  for (const scenes::Instance& instance : scene.instances) colors.list_of_instance.push_back(instance.mesh);
  return colors;
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

std::vector<mesh::Mesh> surfacesOf(const scenes::Scene& scene) {
  std::vector<mesh::Mesh> surfaces;
  for (const mesh::Mesh& mesh : scene.meshes) surfaces.push_back(mesh::surfaceOf(mesh));
  return surfaces;
}

TriangleColors colorsByPart(const scenes::Scene& scene, std::span<const std::uint32_t> part_of_face,
                            std::span<const std::uint32_t> color_of_part) {
  assert(part_of_face.size() == scene.triangleCount());
  TriangleColors colors;
  for (const scenes::Instance& instance : scene.instances) {
    const std::size_t count = scene.meshes[instance.mesh].triangleCount();
    std::vector<std::uint8_t>& list = colors.lists.emplace_back();
    list.reserve(count);
    for (const std::uint32_t part : part_of_face.first(count))
      list.push_back(static_cast<std::uint8_t>(color_of_part[part]));
    part_of_face = part_of_face.subspan(count);
  }
  colors.list_of_instance.resize(scene.instances.size());
  std::iota(colors.list_of_instance.begin(), colors.list_of_instance.end(), 0U);
  return colors;
}

TriangleColors colorsByPatch(const PreparedScene& scene, std::span<const mesh::Mesh> surfaces) {
  return colorsByMesh(scene, surfaces, patchesOf);
}

TriangleColors colorsByGroup(const PreparedScene& scene, std::span<const mesh::Mesh> surfaces) {
  return colorsByMesh(scene, surfaces, groupsOf);
}

void colorPixels(const TriangleColors& colors, Frame& frame, TaskPool& pool) {
  assert(!frame.linear.empty() && !frame.instance_id.empty() && !frame.triangle_id.empty());
  std::array<Vec4, scenes::kPartColors> palette;
  for (std::uint32_t c = 0; c < palette.size(); ++c) palette[c] = Vec4(scenes::partColor(c), 1.0F);
  pool.parallelFor(frame.linear.height(), [&](int y, int) {
    for (int x = 0; x < frame.linear.width(); ++x) {
      const std::uint32_t instance = frame.instance_id.at(x, y);  // beyond all of them where nothing is
      if (instance >= colors.list_of_instance.size()) continue;
      const std::uint8_t color = colors.lists[colors.list_of_instance[instance]][frame.triangle_id.at(x, y)];
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
