#include "scenes/painted_parts.h"

#include <array>
#include <cassert>
#include <limits>
#include <numeric>
#include <vector>

#include "core/image.h"
#include "scenes/import.h"

namespace sheaf::scenes {
namespace {

// Far apart in hue, so that shading does not turn one into another.
constexpr std::array<Rgba8, kPartColors> kPalette = {{{214, 76, 72},
                                                      {242, 160, 61},
                                                      {247, 225, 92},
                                                      {92, 178, 84},
                                                      {64, 196, 200},
                                                      {66, 118, 214},
                                                      {143, 90, 200},
                                                      {236, 134, 190}}};

/// Stably by part.
std::vector<std::uint32_t> facesByPart(std::span<const std::uint32_t> part_of_face, std::size_t part_count) {
  std::vector<std::uint32_t> next(part_count + 1, 0);
  for (const std::uint32_t part : part_of_face) ++next[part + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<std::uint32_t> faces(part_of_face.size());
  for (std::uint32_t f = 0; f < faces.size(); ++f) faces[next[part_of_face[f]]++] = f;
  return faces;
}

}  // namespace

Vec3 partColor(std::uint32_t number) {
  const Rgba8 c = kPalette.at(number);
  return {linearFromSrgb8(c.r), linearFromSrgb8(c.g), linearFromSrgb8(c.b)};
}

mesh::Mesh paintedParts(const mesh::Mesh& mesh, std::span<const std::uint32_t> part_of_face,
                        std::span<const std::uint32_t> color_of_part) {
  assert(part_of_face.size() == mesh.triangleCount());
  // With the faces part by part, a vertex needs to know only of the last part that had it.
  struct Copy {
    std::uint32_t part = std::numeric_limits<std::uint32_t>::max();
    std::uint32_t vertex = 0;
  };
  std::vector<Copy> last(mesh.vertexCount());
  mesh::Mesh painted;
  painted.triangles.resize(mesh.triangleCount());
  for (const std::uint32_t f : facesByPart(part_of_face, color_of_part.size()))
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[f][k], part = part_of_face[f];
      if (last[v].part != part) {
        last[v] = {part, static_cast<std::uint32_t>(painted.vertexCount())};
        painted.positions.push_back(mesh.positions[v]);
        if (!mesh.normals.empty()) painted.normals.push_back(mesh.normals[v]);
        painted.colors.emplace_back(partColor(color_of_part[part]), 1.0F);
      }
      painted.triangles[f][k] = last[v].vertex;
    }
  return painted;
}

}  // namespace sheaf::scenes
