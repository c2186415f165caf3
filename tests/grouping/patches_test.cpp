#include "grouping/patches.h"

#include <doctest/doctest.h>

#include <limits>
#include <random>

#include "tests/mesh/meshes.h"

namespace sheaf::grouping {
namespace {

using mesh::Mesh;
using mesh::Triangle;

bool usesVertexTwice(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

DVec3 areaNormal(const Mesh& m, const Triangle& t) {
  const DVec3 p0(m.positions[t[0]]);
  return glm::cross(DVec3(m.positions[t[1]]) - p0, DVec3(m.positions[t[2]]) - p0);
}

void checkRuns(const PatchSet& set, const PatchLimits& limits) {
  std::uint32_t vertices = 0, triangles = 0;
  for (const Patch& p : set.patches) {
    CHECK(p.first_vertex == vertices);
    CHECK(p.first_triangle == triangles);
    CHECK(p.vertex_count >= 1);
    CHECK(p.vertex_count <= limits.max_vertices);
    CHECK(p.triangle_count >= 1);
    CHECK(p.triangle_count <= limits.max_triangles);
    vertices += (p.vertex_count + kRunAlignment - 1) / kRunAlignment * kRunAlignment;
    triangles += (p.triangle_count + kRunAlignment - 1) / kRunAlignment * kRunAlignment;
    bool padded = true;
    REQUIRE(vertices <= set.vertex_source.size());
    REQUIRE(triangles <= set.triangle_source.size());
    for (std::uint32_t v = p.first_vertex + p.vertex_count; v < vertices; ++v)
      padded = padded && set.vertex_source[v] == set.vertex_source[p.first_vertex + p.vertex_count - 1];
    for (std::uint32_t t = p.first_triangle + p.triangle_count; t < triangles; ++t) {
      padded = padded && set.triangle_source[t] == kNoIndex;
      for (const auto& corner : set.corners) padded = padded && corner[t] == 0;
    }
    CHECK(padded);
  }
  CHECK(set.vertex_source.size() == vertices);
  CHECK(set.triangle_source.size() == triangles);
  for (const auto& corner : set.corners) CHECK(corner.size() == triangles);
}

void checkPartition(const PatchSet& set, const Mesh& m) {
  std::vector<int> uses(m.triangleCount(), 0);
  std::size_t wrong_corners = 0, outside = 0, unordered = 0;
  for (const Patch& p : set.patches) {
    std::uint32_t seen = 0;
    for (std::uint32_t i = 0; i < p.triangle_count; ++i) {
      const std::uint32_t slot = p.first_triangle + i, source = set.triangle_source[slot];
      REQUIRE(source < m.triangleCount());
      ++uses[source];
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t local = set.corners[k][slot];
        REQUIRE(local < p.vertex_count);
        if (local > seen) ++unordered;
        if (local == seen) ++seen;
        const std::uint32_t v = set.vertex_source[p.first_vertex + local];
        if (v != m.triangles[source][k]) ++wrong_corners;
        const Vec3& x = m.positions[v];
        if (glm::min(p.bounds.lo, x) != p.bounds.lo || glm::max(p.bounds.hi, x) != p.bounds.hi) ++outside;
      }
    }
    CHECK(seen == p.vertex_count);
    Box3 box;
    for (std::uint32_t v = 0; v < p.vertex_count; ++v) box.extend(m.positions[set.vertex_source[p.first_vertex + v]]);
    CHECK(box.lo == p.bounds.lo);
    CHECK(box.hi == p.bounds.hi);
  }
  CHECK(wrong_corners == 0);
  CHECK(outside == 0);
  CHECK(unordered == 0);
  std::size_t wrong_uses = 0;
  for (std::size_t f = 0; f < m.triangleCount(); ++f)
    if (uses[f] != (usesVertexTwice(m.triangles[f]) ? 0 : 1)) ++wrong_uses;
  CHECK(wrong_uses == 0);
}

void checkCones(const PatchSet& set, const Mesh& m) {
  for (const Patch& p : set.patches) {
    REQUIRE(isFinite(p.cone.axis));
    REQUIRE(p.cone.sin_angle >= 0.0F);
    if (p.cone.sin_angle >= 1.0F) continue;
    const double sine = p.cone.sin_angle, least = std::sqrt(1.0 - sine * sine);
    std::size_t outside = 0;
    for (std::uint32_t i = 0; i < p.triangle_count; ++i) {
      const DVec3 n = areaNormal(m, m.triangles[set.triangle_source[p.first_triangle + i]]);
      if (glm::length(n) > 0.0 && glm::dot(glm::normalize(n), DVec3(p.cone.axis)) < least) ++outside;
    }
    CHECK(outside == 0);
  }
}

PatchSet checkedSplit(const Mesh& m, const PatchLimits& limits = {}) {
  TaskPool pool(2);
  PatchSet set = splitIntoPatches(m, limits, pool);
  checkRuns(set, limits);
  checkPartition(set, m);
  checkCones(set, m);
  return set;
}

bool equal(const PatchSet& a, const PatchSet& b) {
  if (a.vertex_source != b.vertex_source || a.corners != b.corners || a.triangle_source != b.triangle_source ||
      a.patches.size() != b.patches.size())
    return false;
  for (std::size_t i = 0; i < a.patches.size(); ++i) {
    const Patch &p = a.patches[i], &q = b.patches[i];
    if (p.first_vertex != q.first_vertex || p.vertex_count != q.vertex_count || p.first_triangle != q.first_triangle ||
        p.triangle_count != q.triangle_count || p.bounds.lo != q.bounds.lo || p.bounds.hi != q.bounds.hi ||
        p.cone.axis != q.cone.axis || p.cone.sin_angle != q.cone.sin_angle)
      return false;
  }
  return true;
}

Mesh randomSoup(std::uint32_t vertices, std::uint32_t triangles, float extent) {
  std::mt19937 rng(11);
  std::uniform_real_distribution<float> coordinate(-extent, extent);
  std::uniform_int_distribution<std::uint32_t> index(0, vertices - 1);
  Mesh m;
  for (std::uint32_t i = 0; i < vertices; ++i) {
    const float x = coordinate(rng), y = coordinate(rng), z = coordinate(rng);
    m.positions.emplace_back(x, y, z);
  }
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const std::uint32_t a = index(rng), b = index(rng), c = index(rng);
    m.triangles.push_back({a, b, c});
  }
  return m;
}

}  // namespace

TEST_CASE("grouping/patches: a closed surface is partitioned into nearly full patches with narrow cones") {
  const Mesh m = mesh::makeSphere(200, 300);
  const PatchSet set = checkedSplit(m);
  CHECK(set.patches.size() < 1.25 * m.triangleCount() / 400.0);
  std::size_t wide = 0;
  for (const Patch& p : set.patches)
    if (p.cone.sin_angle > 0.5F) ++wide;
  CHECK(wide == 0);
}

TEST_CASE("grouping/patches: the cone of a flat patch is narrow, of a closed patch useless") {
  const PatchSet flat = checkedSplit(mesh::makeGrid(10));
  REQUIRE(flat.patches.size() == 1);
  CHECK(flat.patches[0].cone.sin_angle < 2e-3F);
  CHECK(flat.patches[0].cone.axis.z == doctest::Approx(1.0));
  const PatchSet closed = checkedSplit(mesh::makeCube());
  REQUIRE(closed.patches.size() == 1);
  CHECK(closed.patches[0].cone.sin_angle >= 1.0F);
}

TEST_CASE("grouping/patches: the two sheets of a thin plate part") {
  Mesh m = mesh::makeGrid(40);
  const auto n = static_cast<std::uint32_t>(m.vertexCount());
  for (std::uint32_t v = 0; v < n; ++v) m.positions.push_back(m.positions[v] - Vec3(0.0F, 0.0F, 0.001F));
  const std::size_t faces = m.triangleCount();
  for (std::size_t f = 0; f < faces; ++f) {
    const Triangle t = m.triangles[f];
    m.triangles.push_back({t[0] + n, t[2] + n, t[1] + n});
  }
  for (const Patch& p : checkedSplit(m).patches) CHECK(p.cone.sin_angle < 2e-3F);
}

TEST_CASE("grouping/patches: any limits hold") {
  const Mesh m = mesh::makeSphere(40, 60);
  for (const PatchLimits limits : {PatchLimits{3, 512}, PatchLimits{256, 1}, PatchLimits{4, 2}, PatchLimits{17, 100},
                                   PatchLimits{256, 16}, PatchLimits{100, 512}}) {
    CAPTURE(limits.max_vertices);
    CAPTURE(limits.max_triangles);
    checkedSplit(m, limits);
  }
}

TEST_CASE("grouping/patches: 1, 2 and 7 threads give the same") {
  const Mesh sphere = mesh::makeSphere(250, 400), soup = randomSoup(5000, 60'000, 1.0F);
  for (const Mesh* m : {&sphere, &soup}) {
    TaskPool one(1), two(2), seven(7);
    const PatchSet expected = splitIntoPatches(*m, {}, one);
    CHECK(equal(splitIntoPatches(*m, {}, two), expected));
    CHECK(equal(splitIntoPatches(*m, {}, seven), expected));
  }
}

TEST_CASE("grouping/patches: meshes with next to nothing in them") {
  CHECK(checkedSplit(Mesh{}).patches.empty());
  Mesh m;
  m.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  CHECK(checkedSplit(m).patches.empty());
  m.triangles = {{0, 1, 2}};
  const PatchSet one = checkedSplit(m);
  REQUIRE(one.patches.size() == 1);
  CHECK(one.vertex_source[15] == 2);
  CHECK(one.triangle_source[1] == kNoIndex);
  m.triangles = {{0, 0, 1}, {2, 2, 2}, {0, 1, 0}};
  CHECK(checkedSplit(m).patches.empty());
}

TEST_CASE("grouping/patches: all triangles in one point, none with area") {
  Mesh m;
  m.positions.assign(3000, Vec3(1.0F, 2.0F, 3.0F));
  for (std::uint32_t i = 0; i < 20'000; ++i) m.triangles.push_back({i % 3000, (i + 1) % 3000, (i + 2) % 3000});
  for (const Patch& p : checkedSplit(m).patches) CHECK(p.cone.sin_angle >= 1.0F);
}

TEST_CASE("grouping/patches: ten thousand triangles around one vertex") {
  checkedSplit(mesh::makeFan(10'000));
}

TEST_CASE("grouping/patches: the same triangle many times, in both orientations") {
  Mesh m;
  m.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (int i = 0; i < 2000; ++i) m.triangles.push_back(i % 2 == 0 ? Triangle{0, 1, 2} : Triangle{0, 2, 1});
  checkedSplit(m);
}

TEST_CASE("grouping/patches: triangles that share no vertices") {
  Mesh m = mesh::makeSphere(60, 60), soup;
  for (const Triangle& t : m.triangles) {
    for (const std::uint32_t v : t) soup.positions.push_back(m.positions[v]);
    const auto n = static_cast<std::uint32_t>(soup.vertexCount());
    soup.triangles.push_back({n - 3, n - 2, n - 1});
  }
  checkedSplit(soup);
}

TEST_CASE("grouping/patches: random triangles at every scale of float") {
  for (const float extent : {1e-38F, 1e-20F, 1.0F, 1e18F, 3e38F}) {
    CAPTURE(extent);
    checkedSplit(randomSoup(1000, 5000, extent));
  }
}

TEST_CASE("grouping/patches: a corner that is not finite does not break the partition") {
  Mesh m = mesh::makeSphere(60, 60);
  m.positions[5].x = std::numeric_limits<float>::quiet_NaN();
  m.positions[700].y = std::numeric_limits<float>::infinity();
  TaskPool pool(2);
  const PatchSet set = splitIntoPatches(m, {}, pool);
  checkRuns(set, {});
  std::size_t triangles = 0;
  for (const Patch& p : set.patches) triangles += p.triangle_count;
  CHECK(triangles == m.triangleCount());
}

}  // namespace sheaf::grouping
