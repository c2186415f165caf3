#include "mesh/weld.h"

#include <doctest/doctest.h>

#include <limits>

#include "mesh/normals.h"
#include "tests/mesh/meshes.h"

namespace sheaf::mesh {

TEST_CASE("mesh/weld: unsharing and welding gives the same surface with the first vertices kept in order") {
  const Mesh sphere = makeSphere(40, 60);
  Mesh m = sphere;
  makeFlatNormals(m);
  m.normals.clear();
  const std::size_t corners = m.vertexCount();
  CHECK(weldVertices(m) == corners - sphere.vertexCount());
  REQUIRE(m.vertexCount() == sphere.vertexCount());
  std::uint32_t seen = 0;
  for (std::size_t f = 0; f < m.triangleCount(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      CHECK(m.positions[m.triangles[f][k]] == sphere.positions[sphere.triangles[f][k]]);
      CHECK(m.triangles[f][k] <= seen);
      if (m.triangles[f][k] == seen) ++seen;
    }
  CHECK(weldVertices(m) == 0);
}

TEST_CASE("mesh/weld: every attribute counts") {
  Mesh m;
  m.positions.assign(6, Vec3(1.0F));
  m.normals.assign(6, Vec3(0.0F, 1.0F, 0.0F));
  m.texcoords.assign(6, Vec2(0.5F));
  m.colors.assign(6, Vec4(1.0F));
  m.normals[1] = {1.0F, 0.0F, 0.0F};
  m.texcoords[2].y = 0.25F;
  m.colors[3].w = 0.5F;
  m.positions[4].z = 2.0F;
  m.triangles = {{0, 1, 2}, {3, 4, 5}};
  CHECK(weldVertices(m) == 1);
  CHECK(m.triangles[1] == Triangle{3, 4, 0});
  CHECK(m.colors[3].w == 0.5F);
}

TEST_CASE("mesh/weld: zeros of both signs are one, NaN is none") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Mesh m;
  m.positions = {{0.0F, 0.0F, 0.0F}, {-0.0F, 0.0F, -0.0F}, {nan, 0.0F, 0.0F}, {nan, 0.0F, 0.0F}};
  m.triangles = {{0, 1, 2}, {1, 2, 3}};
  CHECK(weldVertices(m) == 1);
  CHECK(m.vertexCount() == 3);
  CHECK(m.triangles[0] == Triangle{0, 0, 1});
  CHECK(m.triangles[1] == Triangle{0, 1, 2});
}

TEST_CASE("mesh/weld: many vertices at one place and no vertex at all") {
  Mesh m;
  CHECK(weldVertices(m) == 0);
  m.positions.assign(100'000, Vec3(3.0F));
  CHECK(weldVertices(m) == 99'999);
}

TEST_CASE("mesh/weld: the first vertex at a place stands for all that are there, NaN for itself") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Vec3> positions = {
      {1.0F, 0.0F, 2.0F}, {nan, 0.0F, 0.0F}, {1.0F, -0.0F, 2.0F},
      {1.0F, 0.0F, 3.0F}, {nan, 0.0F, 0.0F}, {1.0F, 0.0F, 2.0F},
  };
  CHECK(firstAtSamePlace(positions) == std::vector<std::uint32_t>{0, 1, 0, 3, 4, 0});
  CHECK(firstAtSamePlace({}).empty());
}

TEST_CASE("mesh/weld: triangles that cannot be drawn are dropped, the others keep their order") {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  Mesh m = makeGrid(1);
  m.positions.insert(m.positions.end(), {{nan, 0, 0}, {0, inf, 0}, {0, 0, -inf}});
  m.triangles = {{0, 1, 4}, {0, 1, 3}, {5, 1, 3}, {0, 3, 2}, {0, 6, 2}};
  CHECK(dropUnusableTriangles(m) == 3);
  REQUIRE(m.triangleCount() == 2);
  CHECK(m.triangles[0] == Triangle{0, 1, 3});
  CHECK(m.triangles[1] == Triangle{0, 3, 2});
  CHECK(m.vertexCount() == 7);
  CHECK(dropUnusableTriangles(m) == 0);
}

TEST_CASE("mesh/weld: a surface is the same however its vertices are numbered, split and decorated") {
  Mesh cube = makeCube();
  cube.positions.insert(cube.positions.begin() + 3, Vec3(77.0F));  // unused
  for (Triangle& t : cube.triangles)
    for (std::uint32_t& v : t) v += v >= 3 ? 1 : 0;
  const Mesh surface = surfaceOf(cube);
  CHECK(surface.vertexCount() == 8);
  CHECK(surface.triangles[0] == Triangle{0, 1, 2});
  REQUIRE(surface.triangleCount() == cube.triangleCount());
  for (std::size_t f = 0; f < cube.triangleCount(); ++f)
    for (std::size_t k = 0; k < 3; ++k)
      CHECK(surface.positions[surface.triangles[f][k]] == cube.positions[cube.triangles[f][k]]);
  Mesh creased = cube;
  makeSmoothNormals(creased, 0.1);
  creased.colors.assign(creased.vertexCount(), Vec4(0.5F));
  REQUIRE(creased.vertexCount() > cube.vertexCount());
  const Mesh again = surfaceOf(creased);
  CHECK(again.positions == surface.positions);
  CHECK(again.triangles == surface.triangles);
  CHECK(again.normals.empty());
  CHECK(again.colors.empty());
  CHECK(surfaceOf({}).positions.empty());
}

}  // namespace sheaf::mesh
