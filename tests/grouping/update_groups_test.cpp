#include "grouping/update_groups.h"

#include <doctest/doctest.h>

#include <limits>

#include "core/error.h"
#include "grouping/direction_groups.h"
#include "grouping/linear_groups.h"
#include "grouping/planar_groups.h"
#include "tests/grouping/shapes.h"

namespace sheaf::grouping {
namespace {

mesh::Mesh ball() {
  std::mt19937 rng(0x0bda);
  return lumpyBall(rng, 24, 32, 0.01F);
}

std::uint32_t firstOf(const VertexGroups& groups, VertexState state) {
  std::uint32_t v = 0;
  while (groups.state[v] != state) ++v;
  return v;
}

const VertexGroup& groupOf(const VertexGroups& groups, std::uint32_t v) {
  return groups.groups[groups.owner[v]];
}

}  // namespace

TEST_CASE("grouping/update_groups: nothing moved, nothing changed") {
  const mesh::Mesh mesh = ball();
  VertexGroups groups = groupPlanar(mesh, {});
  VertexGroups before = groups;
  const UpdateReport report = updateGroups(mesh, {}, groups);
  CHECK(report.projected + report.reinserted + report.ejected + report.released + report.kept_bases == 0);
  groups.stats.search_ms = before.stats.search_ms;
  CHECK(groups == before);
}

TEST_CASE("grouping/update_groups: a vertex that moves in its plane changes its parameters only") {
  mesh::Mesh mesh = ball();
  VertexGroups groups = groupPlanar(mesh, {});
  const std::uint32_t v = firstOf(groups, VertexState::kGrouped), owner = groups.owner[v];
  const VertexGroup g = groupOf(groups, v);
  mesh.positions[v] += 0.01F * g.axis_s;
  const UpdateReport report = updateGroups(mesh, std::vector{v}, groups);
  CHECK(report.projected == 1);
  CHECK(groups.owner[v] == owner);
  CHECK(glm::length(groups.positions[v] - mesh.positions[v]) <= 0.0051F * float(groups.extent));
  CHECK(findInconsistency(groups) == "");
}

TEST_CASE("grouping/update_groups: a vertex far away is set free, and comes back to a plane that is near") {
  mesh::Mesh mesh = ball();
  VertexGroups groups = groupPlanar(mesh, {});
  const std::uint32_t v = firstOf(groups, VertexState::kGrouped);
  const Vec3 home = mesh.positions[v];
  mesh.positions[v] = {10.0F, 20.0F, 30.0F};
  CHECK(updateGroups(mesh, std::vector{v}, groups).ejected == 1);
  CHECK(groups.state[v] == VertexState::kFree);
  CHECK(groups.positions[v] == mesh.positions[v]);
  CHECK(findInconsistency(groups) == "");
  mesh.positions[v] = home;
  CHECK(updateGroups(mesh, std::vector{v}, groups).reinserted == 1);
  CHECK(groups.state[v] == VertexState::kGrouped);
  CHECK(findInconsistency(groups) == "");
}

TEST_CASE("grouping/update_groups: a plane stays when the vertex that defines it leaves") {
  mesh::Mesh mesh = ball();
  VertexGroups groups = groupPlanar(mesh, {});
  const std::uint32_t v = groups.groups[0].origin;
  const Vec3 base = mesh.positions[v];
  const std::vector<Vec3> before = groups.positions;
  mesh.positions[v] = {10.0F, 20.0F, 30.0F};
  const UpdateReport report = updateGroups(mesh, std::vector{v}, groups);
  CHECK(report.released == 1);
  CHECK(report.kept_bases == 1);
  CHECK(groups.state[v] == VertexState::kFree);
  CHECK(groups.groups[0].origin == kNoIndex);
  CHECK(groups.groups[0].base == base);
  for (const std::uint32_t member : groups.members) CHECK(groups.positions[member] == before[member]);
  CHECK(findInconsistency(groups) == "");
}

TEST_CASE("grouping/update_groups: random movement keeps every promise, for every kind and metric") {
  for (const GroupKind kind : {GroupKind::kPlane, GroupKind::kLine})
    for (const Metric metric : {Metric::kDistance, Metric::kQuadric})
      for (const float distance : {0.001F, 0.02F, 0.3F}) {
        CAPTURE(int(kind));
        CAPTURE(int(metric));
        CAPTURE(distance);
        std::mt19937 rng(0x0bdb);
        mesh::Mesh mesh = ball();
        PlanarOptions planar;
        LinearOptions linear;
        planar.metric = linear.metric = metric;
        VertexGroups groups = kind == GroupKind::kPlane ? groupPlanar(mesh, planar) : groupLinear(mesh, linear);
        std::uniform_int_distribution<std::uint32_t> pick(0, static_cast<std::uint32_t>(mesh.vertexCount()) - 1);
        std::uniform_real_distribution<float> shift(-distance, distance);
        for (int round = 0; round < 5; ++round) {
          std::vector<std::uint32_t> moved;
          for (int i = 0; i < 40; ++i) {
            moved.push_back(pick(rng));
            const float dx = shift(rng), dy = shift(rng), dz = shift(rng);
            mesh.positions[moved.back()] += Vec3(dx, dy, dz);
          }
          updateGroups(mesh, moved, groups);
          CHECK(findInconsistency(groups) == "");
          if (metric == Metric::kDistance)
            CHECK(groups.stats.displacement_max <= 0.005 + 1e-6);
          else
            CHECK(groups.stats.flipped_faces == 0);
          for (std::size_t v = 0; v < mesh.vertexCount(); ++v)
            if (groups.state[v] != VertexState::kGrouped) CHECK(groups.positions[v] == mesh.positions[v]);
        }
      }
}

TEST_CASE("grouping/update_groups: positions that are not finite are refused, and change nothing") {
  mesh::Mesh mesh = ball();
  VertexGroups groups = groupPlanar(mesh, {});
  const VertexGroups before = groups;
  mesh.positions[3].y = std::numeric_limits<float>::infinity();
  CHECK_THROWS_AS(updateGroups(mesh, std::vector{3U}, groups), Error);
  CHECK(groups == before);
}

TEST_CASE("grouping/direction_groups: equal normals are one direction, and none turns by more than asin(2 epsilon)") {
  std::mt19937 rng(0x0bdc);
  std::normal_distribution<float> normal;
  std::vector<Vec3> normals;
  for (int i = 0; i < 2000; ++i) {
    const float x = normal(rng), y = normal(rng), z = normal(rng);
    normals.push_back(glm::normalize(Vec3(x, y, z)));
  }
  normals.insert(normals.end(), normals.begin(), normals.begin() + 500);
  normals.push_back({1.0F, 0.0F, 0.0F});
  normals.push_back({1.0F, -0.0F, 0.0F});
  const DirectionGroups result = groupDirections(normals, {});
  CHECK(result.directions.size() == 2001);
  REQUIRE(result.direction.size() == normals.size());
  for (std::size_t i = 0; i < normals.size(); ++i) CHECK(result.directions[result.direction[i]] == normals[i]);
  CHECK(result.groups.extent == 2.0);
  CHECK(result.groups.stats.eliminated > 0.9);
  CHECK(result.angle_max_rad > 0.0);
  CHECK(result.angle_max_rad <= std::asin(0.01) + 1e-6);
  CHECK(groupDirections({}, {}).directions.empty());
}

}  // namespace sheaf::grouping
