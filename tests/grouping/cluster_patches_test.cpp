#include "grouping/cluster_patches.h"

#include <doctest/doctest.h>

#include <limits>
#include <map>
#include <numeric>

#include "grouping/cluster_cuts.h"
#include "tests/grouping/patch_checks.h"
#include "tests/mesh/meshes.h"

namespace sheaf::grouping {
namespace {

using mesh::Mesh;
using mesh::Triangle;

PatchSet cut(const Mesh& m, const PatchLimits& limits, int threads) {
  TaskPool pool(threads);
  return clusterPatches(m, m, clusterFaces(m, {}, pool), limits, pool);
}

PatchSet checkedPatches(const Mesh& m, const PatchLimits& limits = {}) {
  PatchSet set = cut(m, limits, 2);
  checkRuns(set, limits);
  checkPartition(set, m);
  checkCones(set, m);
  return set;
}

// How many parts the patch's triangles make, where those with a common edge hang together.
std::size_t partsOf(const Patch& patch, const PatchSet& set) {
  std::vector<std::uint32_t> part(patch.triangle_count);
  std::iota(part.begin(), part.end(), 0U);
  const auto find = [&](std::uint32_t t) {
    while (part[t] != t) t = part[t];
    return t;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> first_with;
  for (std::uint32_t t = 0; t < patch.triangle_count; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = set.corners[k][patch.first_triangle + t];
      const std::uint32_t b = set.corners[(k + 1) % 3][patch.first_triangle + t];
      const auto [at, is_new] = first_with.emplace(std::minmax(a, b), t);
      if (!is_new) part[find(t)] = find(at->second);
    }
  std::size_t parts = 0;
  for (std::uint32_t t = 0; t < patch.triangle_count; ++t) parts += part[t] == t ? 1 : 0;
  return parts;
}

Mesh twoOf(const Mesh& m, const Vec3& shift) {
  Mesh both = m;
  const auto n = static_cast<std::uint32_t>(m.vertexCount());
  for (const Vec3& p : m.positions) both.positions.push_back(p + shift);
  for (const Triangle& t : m.triangles) both.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  return both;
}

}  // namespace

TEST_CASE("grouping/cluster_patches: a closed surface is partitioned into connected, nearly full patches") {
  const Mesh m = mesh::makeSphere(200, 300);
  const PatchSet set = checkedPatches(m);
  CHECK(set.patches.size() < 1.25 * static_cast<double>(m.triangleCount()) / 400.0);
  std::size_t wide = 0, torn = 0;
  for (const Patch& p : set.patches) {
    if (p.cone.sin_angle > 0.5F) ++wide;
    if (partsOf(p, set) != 1) ++torn;
  }
  CHECK(wide == 0);
  CHECK(torn == 0);
}

TEST_CASE("grouping/cluster_patches: fewer than the clusters within the same limits") {
  const Mesh m = mesh::makeSphere(120, 170);
  TaskPool pool(1);
  const FaceClusters clusters = clusterFaces(m, {}, pool);
  const ClusterCut plain = cutBySize(m, clusters, {.max_faces = 512, .max_vertices = 256});
  CHECK(static_cast<double>(clusterPatches(m, m, clusters, {}, pool).patches.size()) <
        0.9 * static_cast<double>(plain.size()));
}

TEST_CASE("grouping/cluster_patches: any limits hold") {
  const Mesh m = mesh::makeSphere(40, 60);
  for (const PatchLimits limits : {PatchLimits{3, 512}, PatchLimits{256, 1}, PatchLimits{4, 2}, PatchLimits{17, 100},
                                   PatchLimits{256, 16}, PatchLimits{100, 512}}) {
    CAPTURE(limits.max_vertices);
    CAPTURE(limits.max_triangles);
    const PatchSet set = checkedPatches(m, limits);
    for (const Patch& p : set.patches) CHECK(partsOf(p, set) == 1);
  }
}

TEST_CASE("grouping/cluster_patches: 1, 2 and 7 threads give the same") {
  const Mesh sphere = mesh::makeSphere(100, 150), soup = randomSoup(5000, 20'000, 1.0F);
  for (const Mesh* m : {&sphere, &soup}) {
    const PatchSet expected = cut(*m, {}, 1);
    CHECK(equal(cut(*m, {}, 2), expected));
    CHECK(equal(cut(*m, {}, 7), expected));
  }
}

TEST_CASE("grouping/cluster_patches: meshes with next to nothing in them") {
  CHECK(checkedPatches(Mesh{}).patches.empty());
  Mesh m;
  m.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  CHECK(checkedPatches(m).patches.empty());
  m.triangles = {{0, 1, 2}};
  CHECK(checkedPatches(m).patches.size() == 1);
  CHECK(checkedPatches(m, {3, 1}).patches.size() == 1);
  m.triangles = {{0, 0, 1}, {2, 2, 2}, {0, 1, 0}};
  CHECK(checkedPatches(m).patches.empty());
  m.triangles.push_back({0, 1, 2});
  CHECK(checkedPatches(m).patches.size() == 1);
}

TEST_CASE("grouping/cluster_patches: large pieces of a mesh share no patch, small ones do") {
  const Mesh large = twoOf(mesh::makeSphere(20, 30), {5, 0, 0});
  const PatchSet apart = checkedPatches(large);
  for (const Patch& p : apart.patches) CHECK(partsOf(p, apart) == 1);
  Mesh cubes = mesh::makeCube();
  for (int i = 0; i < 6; ++i) cubes = twoOf(cubes, Vec3(std::exp2(static_cast<float>(i)) * 2.0F, 0, 0));
  CHECK(checkedPatches(cubes).patches.size() <= 3);  // 64 cubes of 12 triangles
}

TEST_CASE("grouping/cluster_patches: triangles that share no vertices do not make a patch each") {
  const Mesh m = mesh::makeSphere(60, 60);
  Mesh soup;
  for (const Triangle& t : m.triangles) {
    for (const std::uint32_t v : t) soup.positions.push_back(m.positions[v]);
    const auto n = static_cast<std::uint32_t>(soup.vertexCount());
    soup.triangles.push_back({n - 3, n - 2, n - 1});
  }
  CHECK(checkedPatches(soup).patches.size() <= soup.triangleCount() / 60);
}

TEST_CASE("grouping/cluster_patches: clusters of the welded mesh reach over its seams") {
  // Two halves of a grid whose vertices in the middle stand twice.
  const Mesh half = mesh::makeGrid(30), m = twoOf(half, {1, 0, 0});
  Mesh joined = m;
  std::map<std::pair<float, float>, std::uint32_t> at;
  for (Triangle& t : joined.triangles)
    for (std::uint32_t& v : t) v = at.emplace(std::pair(m.positions[v].x, m.positions[v].y), v).first->second;
  TaskPool pool(1);
  const PatchSet set = clusterPatches(m, joined, clusterFaces(joined, {}, pool), {}, pool);
  checkRuns(set, {});
  checkPartition(set, m);
  const auto reachesOver = [half_faces = static_cast<std::uint32_t>(half.triangleCount())](const PatchSet& patches) {
    return std::any_of(patches.patches.begin(), patches.patches.end(), [&](const Patch& patch) {
      const auto faces = patches.trianglesOf(patch);
      const auto left = std::count_if(faces.begin(), faces.end(), [&](std::uint32_t f) { return f < half_faces; });
      return left > 0 && left < static_cast<std::ptrdiff_t>(faces.size());
    });
  };
  CHECK(reachesOver(set));
  CHECK(reachesOver(clusterPatches(m, {}, pool)));
}

TEST_CASE("grouping/cluster_patches: non-manifold meshes, and ten thousand triangles around one vertex") {
  checkedPatches(mesh::makeFan(10'000));
  Mesh book = mesh::makeGrid(20);  // many pages on one edge
  for (int i = 0; i < 12; ++i) {
    book.positions.emplace_back(0.5F, static_cast<float>(i), 1.0F);
    book.triangles.push_back({0, 1, static_cast<std::uint32_t>(book.vertexCount() - 1)});
  }
  checkedPatches(book);
  Mesh same;
  same.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (int i = 0; i < 2000; ++i) same.triangles.push_back(i % 2 == 0 ? Triangle{0, 1, 2} : Triangle{0, 2, 1});
  checkedPatches(same);
}

TEST_CASE("grouping/cluster_patches: triangles without area, at every scale of float") {
  Mesh point;
  point.positions.assign(3000, Vec3(1.0F, 2.0F, 3.0F));
  for (std::uint32_t i = 0; i < 5000; ++i) point.triangles.push_back({i % 3000, (i + 1) % 3000, (i + 2) % 3000});
  for (const Patch& p : checkedPatches(point).patches) CHECK(p.cone.sin_angle >= 1.0F);
  for (const float extent : {1e-38F, 1e-20F, 1.0F, 1e18F, 3e38F}) {
    CAPTURE(extent);
    checkedPatches(randomSoup(1000, 5000, extent));
  }
}

TEST_CASE("grouping/cluster_patches: a corner that is not finite does not break the partition") {
  Mesh m = mesh::makeSphere(60, 60);
  m.positions[5].x = std::numeric_limits<float>::quiet_NaN();
  m.positions[700].y = std::numeric_limits<float>::infinity();
  const PatchSet set = cut(m, {}, 2);
  checkRuns(set, {});
  std::size_t triangles = 0;
  for (const Patch& p : set.patches) triangles += p.triangle_count;
  CHECK(triangles == m.triangleCount());
}

}  // namespace sheaf::grouping
