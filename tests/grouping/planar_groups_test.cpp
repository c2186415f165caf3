#include "grouping/planar_groups.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <limits>

#include "core/error.h"
#include "grouping/naive_groups.h"
#include "grouping/quadric.h"
#include "tests/grouping/shapes.h"

namespace sheaf::grouping {
namespace {

// Times differ from run to run; everything else has to be equal.
VertexGroups timeless(VertexGroups groups) {
  groups.stats.search_ms = 0.0;
  return groups;
}

std::vector<std::uint32_t> verticesOf(const VertexGroups& groups, VertexState state) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t v = 0; v < groups.state.size(); ++v)
    if (groups.state[v] == state) found.push_back(v);
  return found;
}

void checkDisplacements(const mesh::Mesh& mesh, const VertexGroups& groups) {
  // Beside epsilon there is the rounding of positions and parameters to float.
  double largest = 0.0;
  for (const std::uint32_t v : groups.members)
    for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(double(mesh.positions[v][k])));
  const double slack = 1e-6 * (groups.extent + largest);
  const double eps = groups.epsilon * groups.extent;
  for (const std::uint32_t v : groups.members) {
    CAPTURE(v);
    CHECK(glm::length(DVec3(groups.positions[v]) - DVec3(mesh.positions[v])) <= eps + slack);
  }
}

std::vector<mesh::Mesh> assortedMeshes(std::mt19937& rng) {
  return {randomPoints(rng, 300),
          randomPoints(rng, 200, Vec3(1.0F, 0.1F, 0.01F)),
          latticePoints(rng, 300, 9),
          lumpyBall(rng, 14, 20, 0.02F),
          hills(rng, 16),
          triangleSoup(rng, 120, 300)};
}

}  // namespace

TEST_CASE("grouping/planar_groups: the fast search equals the naive one") {
  std::mt19937 rng(0x5eed1);
  for (const mesh::Mesh& mesh : assortedMeshes(rng))
    for (const TableKey key : {TableKey::kUnion, TableKey::kSum, TableKey::kDynamic})
      for (const double epsilon : {0.0, 0.003, 0.02, 0.4})
        for (const auto& planes : {axisPlanes(), axisAndDodecahedronPlanes()})
          for (const auto& [metric, limit] :
               {std::pair(Metric::kDistance, Limit::kSafe), std::pair(Metric::kQuadric, Limit::kSafe),
                std::pair(Metric::kQuadric, Limit::kPaper)}) {
            PlanarOptions options;
            options.key = key;
            options.epsilon = epsilon;
            options.planes = planes;
            options.metric = metric;
            options.limit = limit;
            CAPTURE(mesh.vertexCount());
            CAPTURE(mesh.triangleCount());
            CAPTURE(int(key));
            CAPTURE(epsilon);
            CAPTURE(planes.size());
            CAPTURE(int(metric));
            CAPTURE(int(limit));
            const VertexGroups fast = groupPlanar(mesh, options);
            CHECK(timeless(fast) == timeless(naiveGroupPlanar(mesh, options)));
            CHECK(findInconsistency(fast) == "");
          }
}

TEST_CASE("grouping/planar_groups: large sets take the sum of hits and still equal the naive search") {
  std::mt19937 rng(0x5eed2);
  const mesh::Mesh mesh = randomPoints(rng, kAutoUnionVertices + 1);
  PlanarOptions options;
  options.epsilon = 0.0005;
  CHECK(timeless(groupPlanar(mesh, options)) == timeless(naiveGroupPlanar(mesh, options)));
}

TEST_CASE("grouping/planar_groups: no member moves further than epsilon, by the distance metric") {
  std::mt19937 rng(0x5eed3);
  for (const mesh::Mesh& mesh : assortedMeshes(rng))
    for (const auto& planes : {axisPlanes(), dodecahedronPlanes()}) {
      PlanarOptions options;
      options.epsilon = 0.01;
      options.planes = planes;
      const VertexGroups groups = groupPlanar(mesh, options);
      checkDisplacements(mesh, groups);
      CHECK(groups.stats.displacement_max <= 0.01 + 1e-5);
    }
}

TEST_CASE("grouping/planar_groups: retained vertices differ by more than epsilon in every coordinate") {
  std::mt19937 rng(0x5eed4);
  for (const mesh::Mesh& mesh : assortedMeshes(rng))
    for (const TableKey key : {TableKey::kUnion, TableKey::kSum, TableKey::kDynamic}) {
      PlanarOptions options;
      options.epsilon = 0.01;
      options.key = key;
      const VertexGroups groups = groupPlanar(mesh, options);
      std::vector<std::uint32_t> retained = verticesOf(groups, VertexState::kFree);
      for (const std::uint32_t v : verticesOf(groups, VertexState::kDefining)) retained.push_back(v);
      const float eps = static_cast<float>(groups.epsilon * groups.extent);
      double shortest = std::numeric_limits<double>::infinity();
      for (int k = 0; k < 3; ++k) {
        std::vector<float> x;
        for (const std::uint32_t v : retained) x.push_back(mesh.positions[v][k]);
        std::sort(x.begin(), x.end());
        for (std::size_t i = 1; i < x.size(); ++i) CHECK(x[i] - x[i - 1] > eps);
        shortest = std::min(shortest, double(x.back()) - double(x.front()));
      }
      CHECK(double(retained.size()) <= std::floor(shortest / double(eps)) + 1.0);
    }
}

TEST_CASE("grouping/planar_groups: at epsilon 0 only exactly coplanar vertices are grouped") {
  std::mt19937 rng(0x5eed5);
  PlanarOptions options;
  options.epsilon = 0.0;
  CHECK(groupPlanar(randomPoints(rng, 50), options).stats.grouped == 0);
  const mesh::Mesh lattice = latticePoints(rng, 400, 5);
  const VertexGroups groups = groupPlanar(lattice, options);
  CHECK(groups.stats.grouped >= 394);
  CHECK(groups.positions == lattice.positions);
}

TEST_CASE("grouping/planar_groups: an epsilon of the shortest edge leaves one vertex") {
  std::mt19937 rng(0x5eed6);
  PlanarOptions options;
  options.epsilon = 0.3;
  const VertexGroups groups = groupPlanar(randomPoints(rng, 200, Vec3(1.0F, 0.5F, 0.25F)), options);
  CHECK(groups.stats.grouped == 199);
  CHECK(groups.stats.defining == 1);
}

TEST_CASE("grouping/planar_groups: permuted axes give equal counts") {
  std::mt19937 rng(0x5eed7);
  const mesh::Mesh mesh = lumpyBall(rng, 20, 24, 0.01F);
  const VertexGroups before = groupPlanar(mesh, {});
  std::array<int, 3> axes = {0, 1, 2};
  while (std::next_permutation(axes.begin(), axes.end())) {
    mesh::Mesh turned = mesh;
    for (Vec3& p : turned.positions) p = Vec3(p[axes[0]], p[axes[1]], p[axes[2]]);
    CHECK(groupPlanar(turned, {}).state == before.state);
  }
}

TEST_CASE("grouping/planar_groups: denser sampling of one shape eliminates a larger share") {
  std::mt19937 rng(0x5eed8);
  double before = 0.0;
  for (const std::uint32_t rings : {10U, 20U, 40U, 80U}) {
    const double now = groupPlanar(lumpyBall(rng, rings, 2 * rings, 0.002F), {}).stats.eliminated;
    CHECK(now > before);
    before = now;
  }
  CHECK(before > 0.97);
}

TEST_CASE("grouping/planar_groups: a member goes to the nearest plane") {
  mesh::Mesh mesh;
  mesh.positions = {{0.0F, 0.0F, 0.0F}, {0.004F, 0.001F, 0.5F}, {1.0F, 1.0F, 1.0F}};
  const VertexGroups groups = groupPlanar(mesh, {});
  REQUIRE(groups.groups.size() == 1);
  CHECK(groups.groups[0].origin == 0);
  CHECK(groups.groups[0].plane == 1);
  CHECK(groups.positions[1] == Vec3(0.004F, 0.0F, 0.5F));
  CHECK(groups.s[0] == 0.5F);  // across y, s runs along z and t along x
  CHECK(groups.t[0] == 0.004F);
}

TEST_CASE("grouping/planar_groups: sets without spread") {
  SUBCASE("nothing") {
    const VertexGroups groups = groupPlanar({}, {});
    CHECK(groups.stats.vertices == 0);
    CHECK(findInconsistency(groups) == "");
  }
  SUBCASE("one vertex stays free") {
    mesh::Mesh mesh;
    mesh.positions = {{1.0F, 2.0F, 3.0F}};
    const VertexGroups groups = groupPlanar(mesh, {});
    CHECK(groups.stats.free == 1);
    CHECK(groups.extent == 0.0);
  }
  SUBCASE("equal vertices share one, also at extent 0") {
    mesh::Mesh mesh;
    mesh.positions.assign(7, {1.0F, 2.0F, 3.0F});
    const VertexGroups groups = groupPlanar(mesh, {});
    CHECK(groups.stats.grouped == 6);
    CHECK(groups.positions == mesh.positions);
  }
  SUBCASE("coplanar vertices across an axis are one group") {
    std::mt19937 rng(0x5eed9);
    mesh::Mesh mesh = randomPoints(rng, 100, Vec3(1.0F, 0.0F, 1.0F));
    const VertexGroups groups = groupPlanar(mesh, {});
    CHECK(groups.stats.grouped == 99);
    CHECK(groups.stats.displacement_max < 1e-7);
  }
  SUBCASE("collinear vertices") {
    mesh::Mesh mesh;
    for (int i = 0; i < 50; ++i) mesh.positions.push_back(float(i) * Vec3(1.0F, 2.0F, 3.0F));
    const VertexGroups groups = groupPlanar(mesh, {});
    CHECK(groups.stats.grouped == 0);  // even along x every step is 0.68 % of the extent
    CHECK(findInconsistency(groups) == "");
  }
}

TEST_CASE("grouping/planar_groups: vertices that no face uses are left alone and not counted") {
  std::mt19937 rng(0x5eeda);
  mesh::Mesh mesh = lumpyBall(rng, 10, 12);
  const auto used = static_cast<std::uint32_t>(mesh.vertexCount());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  mesh.positions.push_back({5.0F, 5.0F, 5.0F});
  mesh.positions.push_back({nan, 0.0F, 0.0F});
  const VertexGroups groups = groupPlanar(mesh, {});
  CHECK(groups.stats.vertices == used);
  CHECK(groups.state[used] == VertexState::kUnused);
  CHECK(groups.positions[used] == Vec3(5.0F));
  CHECK(groups.extent < 5.0);
}

TEST_CASE("grouping/planar_groups: positions that are not finite are refused") {
  mesh::Mesh mesh;
  mesh.positions = {{0.0F, 0.0F, 0.0F}, {1.0F, std::numeric_limits<float>::quiet_NaN(), 0.0F}};
  CHECK_THROWS_WITH_AS(groupPlanar(mesh, {}), doctest::Contains("vertex 1: position"), Error);
  mesh.positions[1] = {1.0F, 0.0F, std::numeric_limits<float>::infinity()};
  CHECK_THROWS_AS(groupPlanar(mesh, {}), Error);
  mesh.positions[1] = {3e38F, 0.0F, 0.0F};
  CHECK_THROWS_AS(groupPlanar(mesh, {}), Error);
}

TEST_CASE("grouping/planar_groups: the quadric metric without faces falls back to distance and says so") {
  std::mt19937 rng(0x5eedb);
  const mesh::Mesh points = randomPoints(rng, 200);
  PlanarOptions options;
  options.metric = Metric::kQuadric;
  const VertexGroups groups = groupPlanar(points, options);
  CHECK(groups.metric == Metric::kDistance);
  REQUIRE(groups.warnings.size() == 1);
  CHECK(groups.warnings[0].find("distance") != std::string::npos);
  CHECK(groups.state == groupPlanar(points, {}).state);
}

TEST_CASE("grouping/planar_groups: with the safe limit no face flips or collapses") {
  std::mt19937 rng(0x5eedc);
  for (const mesh::Mesh& mesh : {lumpyBall(rng, 30, 40, 0.01F), hills(rng, 30), triangleSoup(rng, 100, 200)})
    for (const double epsilon : {0.005, 0.01, 0.025, 0.2})
      for (const auto& planes : {axisPlanes(), axisAndDodecahedronPlanes()}) {
        PlanarOptions options;
        options.metric = Metric::kQuadric;
        options.epsilon = epsilon;
        options.planes = planes;
        const VertexGroups groups = groupPlanar(mesh, options);
        CHECK(groups.stats.flipped_faces == 0);
        CHECK(groups.stats.collapsed_faces == 0);
        CHECK(groups.stats.restored_vertices == 0);  // by construction, not by repair
      }
}

TEST_CASE("grouping/planar_groups: restoring leaves no flipped face") {
  std::mt19937 rng(0x5eedd);
  const mesh::Mesh mesh = lumpyBall(rng, 40, 60, 0.02F);
  PlanarOptions options;
  options.epsilon = 0.02;
  REQUIRE(groupPlanar(mesh, options).stats.flipped_faces > 0);
  options.restore_flipped = true;
  const VertexGroups groups = groupPlanar(mesh, options);
  CHECK(groups.stats.flipped_faces == 0);
  CHECK(groups.stats.collapsed_faces == 0);
  CHECK(groups.stats.restored_vertices > 0);
  CHECK(groups.stats.grouped > 0);
  CHECK(findInconsistency(groups) == "");
}

TEST_CASE("grouping/planar_groups: no member of a quadric group has an error above epsilon squared") {
  std::mt19937 rng(0x5eede);
  for (const Limit limit : {Limit::kSafe, Limit::kPaper})
    for (const mesh::Mesh& mesh : {lumpyBall(rng, 24, 30, 0.01F), hills(rng, 20)}) {
      PlanarOptions options;
      options.metric = Metric::kQuadric;
      options.limit = limit;
      options.epsilon = 0.01;
      const VertexGroups groups = groupPlanar(mesh, options);
      REQUIRE(groups.stats.grouped > 0);
      const double eps = groups.epsilon * groups.extent;
      const std::vector<Sym3> ellipsoids = vertexEllipsoids(mesh, eps, limit);
      for (const std::uint32_t v : groups.members) {
        const DVec3 x = DVec3(groups.positions[v]) - DVec3(mesh.positions[v]);
        const double error = glm::dot(x, inverse(ellipsoids[v]).times(x));  // in units of eps^2
        CHECK(error <= 1.01);  // the slack is for float positions against thin ellipsoids
      }
    }
}

}  // namespace sheaf::grouping
