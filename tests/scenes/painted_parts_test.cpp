#include "scenes/painted_parts.h"

#include <doctest/doctest.h>

#include <array>
#include <set>

namespace sheaf::scenes {

TEST_CASE("scenes/painted_parts: each part has vertices of its own in its colour, and the surface is the same") {
  // A strip of four triangles over six vertices; a seventh is not used.
  mesh::Mesh mesh;
  for (int i = 0; i < 7; ++i) {
    mesh.positions.emplace_back(i / 2, i % 2, 0.0F);
    mesh.normals.emplace_back(0.0F, 0.0F, i % 2 == 0 ? 1.0F : -1.0F);
    mesh.texcoords.emplace_back(0.0F, 0.0F);
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {2, 4, 3}, {3, 4, 5}};
  const std::array<std::uint32_t, 4> part_of_face = {1, 0, 0, 1};
  const mesh::Mesh painted = paintedParts(mesh, part_of_face, std::array<std::uint32_t, 2>{5, 2});
  CHECK(painted.vertexCount() == 4 + 6);  // the two triangles of part 1 share no vertex
  CHECK(painted.texcoords.empty());
  REQUIRE(painted.colors.size() == 10);
  REQUIRE(painted.triangleCount() == 4);
  for (std::size_t f = 0; f < 4; ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t before = mesh.triangles[f][k], after = painted.triangles[f][k];
      CHECK(painted.positions[after] == mesh.positions[before]);
      CHECK(painted.normals[after] == mesh.normals[before]);
      CHECK((painted.colors[after] == painted.colors[painted.triangles[0][0]]) == (part_of_face[f] == 1));
    }
  CHECK(paintedParts({}, {}, {}).vertexCount() == 0);
}

TEST_CASE("scenes/painted_parts: colours differ from each other") {
  mesh::Mesh mesh;
  mesh.positions.resize(3, Vec3(0.0F));
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t i = 0; i < kPartColors; ++i) {
    mesh.triangles.push_back({0, 1, 2});
    numbers.push_back(i);
  }
  std::set<std::array<float, 3>> colors;
  for (const Vec4& c : paintedParts(mesh, numbers, numbers).colors) colors.insert({c.r, c.g, c.b});
  CHECK(colors.size() == kPartColors);
}

}  // namespace sheaf::scenes
