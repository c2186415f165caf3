#include "grouping/patches.h"

#include <doctest/doctest.h>

#include <limits>

#include "tests/grouping/patch_checks.h"
#include "tests/mesh/meshes.h"

namespace sheaf::grouping {
namespace {

using mesh::Mesh;
using mesh::Triangle;

PatchSet checkedSplit(const Mesh& m, const PatchLimits& limits = {}) {
  TaskPool pool(2);
  PatchSet set = splitIntoPatches(m, limits, pool);
  checkRuns(set, limits);
  checkPartition(set, m);
  checkCones(set, m);
  return set;
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
