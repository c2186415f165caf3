#include "mesh/normals.h"

#include <doctest/doctest.h>

#include <limits>
#include <random>

#include "tests/mesh/meshes.h"

namespace sheaf::mesh {
namespace {

constexpr double kNoCrease = kPi;

void checkUnit(const Mesh& m) {
  REQUIRE(m.normals.size() == m.vertexCount());
  for (const Vec3& n : m.normals) CHECK(glm::length(n) == doctest::Approx(1.0).epsilon(1e-5));
}

Vec3 faceNormal(const Mesh& m, const Triangle& t) {
  return glm::normalize(glm::cross(m.positions[t[1]] - m.positions[t[0]], m.positions[t[2]] - m.positions[t[0]]));
}

}  // namespace

TEST_CASE("mesh/normals: a smooth sphere's normals point away from its centre") {
  Mesh m = makeSphere(32, 48);
  makeSmoothNormals(m, radians(60.0));
  CHECK(m.vertexCount() == makeSphere(32, 48).vertexCount());
  checkUnit(m);
  for (std::size_t v = 0; v < m.vertexCount(); ++v) CHECK(glm::dot(m.normals[v], m.positions[v]) > 0.999F);
}

TEST_CASE("mesh/normals: a cube's corner is split by its creases, not by how its faces are cut") {
  Mesh m = makeCube();
  makeSmoothNormals(m, radians(45.0));
  checkUnit(m);
  CHECK(m.vertexCount() == 24);
  for (const Triangle& t : m.triangles)
    for (const std::uint32_t v : t) CHECK(glm::dot(m.normals[v], faceNormal(m, t)) > 0.9999F);
  const Mesh cube = makeCube();
  for (std::size_t f = 0; f < cube.triangleCount(); ++f)
    for (std::size_t k = 0; k < 3; ++k) CHECK(m.positions[m.triangles[f][k]] == cube.positions[cube.triangles[f][k]]);
}

TEST_CASE("mesh/normals: the angle at the corner is the weight") {
  Mesh m = makeCube();
  makeSmoothNormals(m, kNoCrease);
  CHECK(m.vertexCount() == 8);
  for (std::size_t v = 0; v < 8; ++v) CHECK(glm::dot(m.normals[v], glm::normalize(m.positions[v])) > 0.999999F);
}

TEST_CASE("mesh/normals: a crease equal to the limit is smoothed") {
  Mesh m = makeCube();
  makeSmoothNormals(m, radians(90.0));
  CHECK(m.vertexCount() == 8);
  m = makeCube();
  makeSmoothNormals(m, radians(89.9));
  CHECK(m.vertexCount() == 24);
}

TEST_CASE("mesh/normals: a flat grid is not split at a crease angle of 0") {
  Mesh m = makeGrid(5);
  makeSmoothNormals(m, 0.0);
  CHECK(m.vertexCount() == 36);
  for (const Vec3& n : m.normals) CHECK(n == Vec3(0.0F, 0.0F, 1.0F));
}

TEST_CASE("mesh/normals: a dart that ends inside a surface does not split its end") {
  // Around a vertex with one creased edge the fan stays in one piece: there is a smooth way round.
  Mesh m;
  m.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  for (std::uint32_t i = 1; i <= 4; ++i) m.triangles.push_back({0, i, i % 4 + 1});
  m.positions.push_back({0.1F, -0.1F, -0.3F});
  m.triangles.back() = {0, 4, 5};  // falls steeply below the plane, open to vertex 1
  makeSmoothNormals(m, radians(30.0));
  checkUnit(m);
  // Vertices 0 and 4 fall into a flat and a steep part.
  CHECK(m.vertexCount() == 8);
}

TEST_CASE("mesh/normals: appended vertices carry every attribute") {
  Mesh m = makeCube();
  for (std::size_t v = 0; v < 8; ++v) {
    m.texcoords.emplace_back(static_cast<float>(v), 0.5F);
    m.colors.emplace_back(static_cast<float>(v), 0.0F, 0.0F, 1.0F);
  }
  makeSmoothNormals(m, radians(30.0));
  REQUIRE(m.texcoords.size() == 24);
  REQUIRE(m.colors.size() == 24);
  const Mesh cube = makeCube();
  for (std::size_t f = 0; f < cube.triangleCount(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      CHECK(m.texcoords[m.triangles[f][k]].x == static_cast<float>(cube.triangles[f][k]));
      CHECK(m.colors[m.triangles[f][k]].x == static_cast<float>(cube.triangles[f][k]));
    }
}

TEST_CASE("mesh/normals: useless triangles contribute nothing and break nothing") {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  Mesh m = makeGrid(2);
  const auto n = static_cast<std::uint32_t>(m.vertexCount());
  m.positions.insert(m.positions.end(),
                     {{nan, 0, 0}, {inf, 0, 0}, {5, 5, 5}, {1e30F, 0, 0}, {0, 1e30F, 0}, {0, 0, 1e30F}});
  m.triangles.push_back({0, 0, 1});              // a vertex twice
  m.triangles.push_back({0, 1, 2});              // collinear
  m.triangles.push_back({0, 1, n});              // NaN
  m.triangles.push_back({3, 4, n + 1});          // infinite
  m.triangles.push_back({n + 3, n + 4, n + 5});  // large, but sound
  for (const double crease : {0.0, 0.5, kNoCrease}) {
    Mesh copy = m;
    makeSmoothNormals(copy, crease);
    checkUnit(copy);
    CHECK(copy.vertexCount() == m.vertexCount());
    CHECK(copy.normals[0] == Vec3(0.0F, 0.0F, 1.0F));
    CHECK(copy.normals[n] == Vec3(0.0F, 1.0F, 0.0F));
    CHECK(copy.normals[n + 2] == Vec3(0.0F, 1.0F, 0.0F));
    CHECK(copy.normals[n + 3].x == doctest::Approx(std::sqrt(1.0 / 3.0)));
  }
  makeFlatNormals(m);
  checkUnit(m);
}

TEST_CASE("mesh/normals: the two sides of a folded sheet cancel or part, without NaN") {
  Mesh m;
  m.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  m.triangles = {{0, 1, 2}, {0, 2, 1}};
  Mesh smooth = m;
  makeSmoothNormals(smooth, kNoCrease);
  checkUnit(smooth);
  CHECK(smooth.vertexCount() == 3);
  makeSmoothNormals(m, radians(60.0));
  checkUnit(m);
  CHECK(m.vertexCount() == 6);
  for (const Triangle& t : m.triangles) CHECK(m.normals[t[0]] == faceNormal(m, t));
}

TEST_CASE("mesh/normals: a large creased fan takes no quadratic time and a wide one stays whole") {
  Mesh m = makeFan(200'000);
  makeSmoothNormals(m, radians(1.0));
  CHECK(m.vertexCount() == 200'001);
  CHECK(m.normals[0].z > 0.999F);
}

TEST_CASE("mesh/normals: smoothing a random soup ends with unit normals, whatever the crease") {
  std::mt19937 rng(7);
  std::uniform_real_distribution<float> coordinate(-1.0F, 1.0F);
  std::uniform_int_distribution<std::uint32_t> index(0, 39);
  Mesh m;
  for (int i = 0; i < 40; ++i) m.positions.emplace_back(coordinate(rng), coordinate(rng), coordinate(rng));
  for (int i = 0; i < 400; ++i) m.triangles.push_back({index(rng), index(rng), index(rng)});
  for (const double crease : {0.1, 1.0, 2.0, 3.0}) {
    Mesh copy = m;
    makeSmoothNormals(copy, crease);
    checkUnit(copy);
    for (std::size_t f = 0; f < m.triangleCount(); ++f)
      for (std::size_t k = 0; k < 3; ++k) CHECK(copy.positions[copy.triangles[f][k]] == m.positions[m.triangles[f][k]]);
  }
}

TEST_CASE("mesh/normals: flat normals unshare every vertex") {
  Mesh m = makeCube();
  m.texcoords.resize(8);
  m.texcoords[7] = {0.25F, 0.75F};
  makeFlatNormals(m);
  checkUnit(m);
  REQUIRE(m.vertexCount() == 36);
  REQUIRE(m.texcoords.size() == 36);
  const Mesh cube = makeCube();
  for (std::uint32_t f = 0; f < 12; ++f) {
    CHECK(m.triangles[f] == Triangle{3 * f, 3 * f + 1, 3 * f + 2});
    for (std::uint32_t k = 0; k < 3; ++k) {
      CHECK(m.normals[3 * f + k] == faceNormal(m, m.triangles[f]));
      CHECK(m.positions[3 * f + k] == cube.positions[cube.triangles[f][k]]);
      CHECK(m.texcoords[3 * f + k].y == (cube.triangles[f][k] == 7 ? 0.75F : 0.0F));
    }
  }
}

TEST_CASE("mesh/normals: an empty mesh stays empty") {
  Mesh m;
  makeSmoothNormals(m, 0.5);
  makeFlatNormals(m);
  CHECK(m.vertexCount() == 0);
  CHECK(m.normals.empty());
}

}  // namespace sheaf::mesh
