#include "grouping/linear_groups.h"

#include <doctest/doctest.h>

#include <limits>

#include "core/error.h"
#include "grouping/naive_groups.h"
#include "grouping/quadric.h"
#include "tests/grouping/shapes.h"

namespace sheaf::grouping {
namespace {

VertexGroups timeless(VertexGroups groups) {
  groups.stats.search_ms = 0.0;
  return groups;
}

mesh::Mesh flatPoints(std::mt19937& rng, std::uint32_t count) {
  return randomPoints(rng, count, Vec3(1.0F, 0.7F, 0.0F));
}

}  // namespace

TEST_CASE("grouping/linear_groups: the fast search equals the naive one") {
  std::mt19937 rng(0x11e1);
  for (const mesh::Mesh& mesh : {randomPoints(rng, 90), latticePoints(rng, 90, 4), lumpyBall(rng, 8, 12, 0.01F),
                                 hills(rng, 10), triangleSoup(rng, 60, 100), flatPoints(rng, 90)})
    for (const double epsilon : {0.0, 0.004, 0.02, 0.3})
      for (const bool segment_only : {false, true})
        for (const auto& [metric, limit] :
             {std::pair(Metric::kDistance, Limit::kSafe), std::pair(Metric::kQuadric, Limit::kSafe),
              std::pair(Metric::kQuadric, Limit::kPaper)}) {
          LinearOptions options;
          options.epsilon = epsilon;
          options.segment_only = segment_only;
          options.metric = metric;
          options.limit = limit;
          CAPTURE(mesh.vertexCount());
          CAPTURE(mesh.triangleCount());
          CAPTURE(epsilon);
          CAPTURE(segment_only);
          CAPTURE(int(metric));
          CAPTURE(int(limit));
          const VertexGroups fast = groupLinear(mesh, options);
          CHECK(timeless(fast) == timeless(naiveGroupLinear(mesh, options)));
          CHECK(findInconsistency(fast) == "");
        }
}

TEST_CASE("grouping/linear_groups: a flat set gives the same groups as a plane in space") {
  std::mt19937 rng(0x11e2);
  const mesh::Mesh mesh = flatPoints(rng, 300);
  LinearOptions options;
  const VertexGroups in_space = groupLinear(mesh, options);
  options.dimensions = 2;
  VertexGroups flat = groupLinear(mesh, options);
  CHECK(flat.dimensions == 2);
  for (const Vec3& p : flat.positions) CHECK(p.z == 0.0F);
  flat.dimensions = 3;
  CHECK(timeless(flat) == timeless(in_space));
  CHECK(flat.stats.eliminated > 0.5);
}

TEST_CASE("grouping/linear_groups: members keep within epsilon of their line and its range") {
  std::mt19937 rng(0x11e3);
  for (const bool segment_only : {false, true})
    for (const mesh::Mesh& mesh : {randomPoints(rng, 400), lumpyBall(rng, 16, 20, 0.01F)}) {
      LinearOptions options;
      options.epsilon = 0.01;
      options.segment_only = segment_only;
      const VertexGroups groups = groupLinear(mesh, options);
      REQUIRE(groups.stats.grouped > 0);
      CHECK(groups.stats.displacement_max <= 0.01 + 1e-6);
      CHECK(findInconsistency(groups) == "");
      for (const VertexGroup& g : groups.groups) {
        CHECK(groups.state[g.origin] == VertexState::kDefining);
        CHECK(groups.state[g.end] == VertexState::kDefining);
        if (segment_only) CHECK((g.s_min == 0.0F && g.s_max == 1.0F));
      }
    }
}

TEST_CASE("grouping/linear_groups: exactly collinear vertices group at epsilon 0") {
  mesh::Mesh mesh;
  mesh.positions = {{0.0F, 0.0F, 0.0F}, {2.0F, 4.0F, 6.0F}, {1.0F, 2.0F, 3.0F}};
  LinearOptions options;
  options.epsilon = 0.0;
  const VertexGroups groups = groupLinear(mesh, options);
  REQUIRE(groups.groups.size() == 1);
  // All three lines take one vertex; the tie goes to the first pair.
  CHECK(groups.groups[0].origin == 0);
  CHECK(groups.groups[0].end == 1);
  CHECK(groups.state[2] == VertexState::kGrouped);
  CHECK(groups.s[0] == 0.5F);
  CHECK(groups.positions == mesh.positions);
}

TEST_CASE("grouping/linear_groups: ranges hold both ends and members beyond them") {
  mesh::Mesh mesh;
  mesh.positions = {{1.0F, 0.0F, 0.0F}, {2.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 0.0F}, {4.0F, 0.0F, 0.0F}};
  const VertexGroups groups = groupLinear(mesh, {});
  REQUIRE(groups.groups.size() == 1);
  CHECK(groups.groups[0].s_min == -1.0F);
  CHECK(groups.groups[0].s_max == 3.0F);
  LinearOptions segment;
  segment.segment_only = true;
  const VertexGroups between = groupLinear(mesh, segment);
  REQUIRE(between.groups.size() == 1);
  CHECK(between.groups[0].origin == 2);
  CHECK(between.groups[0].end == 3);
}

TEST_CASE("grouping/linear_groups: larger sets are cut into cells") {
  std::mt19937 rng(0x11e4);
  const mesh::Mesh mesh = lumpyBall(rng, 40, 50, 0.005F);
  LinearOptions options;
  options.max_cell_vertices = 300;
  const VertexGroups groups = groupLinear(mesh, options);
  CHECK(findInconsistency(groups) == "");
  CHECK(groups.stats.displacement_max <= 0.005 + 1e-6);
  CHECK(groups.stats.eliminated > 0.5);
  CHECK(groups.stats.eliminated < groupLinear(mesh, {}).stats.eliminated);
  // Duplicates cannot be told apart by position: the cut falls between them by index and ends all the same.
  mesh::Mesh equal;
  equal.positions.assign(2000, {1.0F, 1.0F, 1.0F});
  CHECK(groupLinear(equal, options).stats.free == 2000);
}

TEST_CASE("grouping/linear_groups: progress rises to 1") {
  std::mt19937 rng(0x11e5);
  LinearOptions options;
  options.max_cell_vertices = 200;
  std::vector<double> seen;
  options.progress = [&](double done) {
    seen.push_back(done);
    return true;
  };
  groupLinear(randomPoints(rng, 700), options);
  REQUIRE(seen.size() > 8);
  for (std::size_t i = 1; i < seen.size(); ++i) CHECK(seen[i] >= seen[i - 1]);
  CHECK(seen.front() >= 0.0);
  CHECK(seen.back() == 1.0);
}

TEST_CASE("grouping/linear_groups: stopping at any report leaves a valid result that says so") {
  std::mt19937 rng(0x11e6);
  const mesh::Mesh mesh = randomPoints(rng, 700);
  LinearOptions options;
  options.max_cell_vertices = 200;
  options.epsilon = 0.02;
  std::uint32_t before = 0;
  for (int stop_at = 0; stop_at < 12; stop_at += 3) {
    int reports = 0;
    options.progress = [&](double) { return reports++ < stop_at; };
    const VertexGroups groups = groupLinear(mesh, options);
    CHECK(groups.interrupted);
    CHECK(reports == stop_at + 1);
    CHECK(findInconsistency(groups) == "");
    CHECK(groups.stats.grouped >= before);
    before = groups.stats.grouped;
  }
  CHECK(before > 0);
}

TEST_CASE("grouping/linear_groups: sets without spread") {
  for (const std::uint32_t count : {0U, 1U, 2U, 9U}) {
    mesh::Mesh mesh;
    mesh.positions.assign(count, {1.0F, 2.0F, 3.0F});
    const VertexGroups groups = groupLinear(mesh, {});
    CHECK(groups.stats.free == count);  // equal vertices give no line
    CHECK(findInconsistency(groups) == "");
  }
  std::mt19937 rng(0x11e7);
  mesh::Mesh line = randomPoints(rng, 60, Vec3(1.0F, 0.0F, 0.0F));
  CHECK(groupLinear(line, {}).stats.grouped == 58);
  mesh::Mesh bad;
  bad.positions = {{0.0F, 0.0F, std::numeric_limits<float>::quiet_NaN()}};
  CHECK_THROWS_AS(groupLinear(bad, {}), Error);
}

TEST_CASE("grouping/linear_groups: the safe limit keeps every face upright") {
  std::mt19937 rng(0x11e8);
  for (const mesh::Mesh& mesh : {lumpyBall(rng, 16, 20, 0.01F), hills(rng, 18), triangleSoup(rng, 100, 150)}) {
    LinearOptions options;
    options.metric = Metric::kQuadric;
    options.epsilon = 0.025;
    const VertexGroups groups = groupLinear(mesh, options);
    CHECK(groups.stats.flipped_faces == 0);
    CHECK(groups.stats.collapsed_faces == 0);
    CHECK(groups.stats.restored_vertices == 0);
  }
}

TEST_CASE("grouping/linear_groups: texture coordinates become a flat mesh") {
  mesh::Mesh mesh;
  mesh.positions.assign(3, Vec3(9.0F));
  mesh.texcoords = {{0.0F, 0.0F}, {1.0F, 1.0F}, {0.5F, 0.5F}};
  mesh.triangles = {{0, 1, 2}};
  const mesh::Mesh flat = texcoordMesh(mesh);
  CHECK(flat.positions[1] == Vec3(1.0F, 1.0F, 0.0F));
  LinearOptions options;
  options.dimensions = 2;
  CHECK(groupLinear(flat, options).stats.grouped == 1);
}

TEST_CASE("grouping/linear_groups: quadric members lie at the least error along their line, within epsilon squared") {
  std::mt19937 rng(0x11e9);
  for (const Limit limit : {Limit::kSafe, Limit::kPaper})
    for (const mesh::Mesh& mesh : {lumpyBall(rng, 16, 20, 0.01F), hills(rng, 18)}) {
      LinearOptions options;
      options.metric = Metric::kQuadric;
      options.limit = limit;
      options.epsilon = 0.02;
      const VertexGroups groups = groupLinear(mesh, options);
      REQUIRE(groups.stats.grouped > 0);
      const std::vector<Sym3> ellipsoids = vertexEllipsoids(mesh, groups.epsilon * groups.extent, limit);
      for (const std::uint32_t v : groups.members) {
        CAPTURE(v);
        const Sym3 a = inverse(ellipsoids[v]);  // errors in units of epsilon squared
        const DVec3 x = DVec3(groups.positions[v]) - DVec3(mesh.positions[v]);
        const DVec3 along = glm::normalize(DVec3(groups.groups[groups.owner[v]].axis_s));
        const double error = glm::dot(x, a.times(x)), curvature = glm::dot(along, a.times(along));
        CHECK(error <= 1.01);  // the slack is for float positions against thin ellipsoids
        // What moving on to the very minimum would still gain.
        const double slope = glm::dot(along, a.times(x));
        CHECK(slope * slope / curvature <= 1e-2);
      }
    }
}

TEST_CASE("grouping/linear_groups: vertices that no face uses are left alone and not counted") {
  std::mt19937 rng(0x11ea);
  mesh::Mesh mesh = lumpyBall(rng, 10, 12);
  const auto used = static_cast<std::uint32_t>(mesh.vertexCount());
  const VertexGroups without = groupLinear(mesh, {});
  mesh.positions.push_back({5.0F, 5.0F, 5.0F});
  mesh.positions.push_back({std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F});
  const VertexGroups with = groupLinear(mesh, {});
  CHECK(with.stats.vertices == used);
  CHECK(with.state[used] == VertexState::kUnused);
  CHECK(with.positions[used] == Vec3(5.0F));
  CHECK(with.groups == without.groups);
  CHECK(with.members == without.members);
}

}  // namespace sheaf::grouping
