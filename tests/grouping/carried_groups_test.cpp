#include "grouping/carried_groups.h"

#include <doctest/doctest.h>

#include <map>
#include <random>
#include <set>

#include "grouping/group_quality.h"
#include "grouping/linear_groups.h"
#include "grouping/planar_groups.h"
#include "grouping/vertex_runs.h"
#include "tests/grouping/shapes.h"

namespace sheaf::grouping {
namespace {

// A mesh that has the faces of another in a different order of vertices, some of them twice, and one of nobody.
struct Copies {
  mesh::Mesh mesh;
  std::vector<std::uint32_t> source;
};

Copies copiesOf(const mesh::Mesh& mesh, std::size_t face_count) {
  std::mt19937 rng(0xca44);
  Copies copies;
  std::map<std::pair<std::uint32_t, bool>, std::uint32_t> copy;
  for (std::size_t f = 0; f < face_count; ++f) {
    mesh::Triangle t{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[f][k];
      const auto [at, is_new] = copy.try_emplace({v, rng() % 4 == 0}, static_cast<std::uint32_t>(copies.source.size()));
      if (is_new) {
        copies.source.push_back(v);
        copies.mesh.positions.push_back(mesh.positions[v]);
      }
      t[k] = at->second;
    }
    copies.mesh.triangles.push_back(t);
  }
  copies.source.push_back(kNoIndex);
  copies.mesh.positions.emplace_back(7.0F);
  return copies;
}

mesh::Mesh ball() {
  std::mt19937 rng(0xca45);
  return lumpyBall(rng, 30, 40, 0.01F);
}

std::vector<VertexGroups> assortedGroups(const mesh::Mesh& mesh) {
  PlanarOptions quadric;
  quadric.metric = Metric::kQuadric;
  quadric.epsilon = 0.02;
  quadric.planes = axisAndDodecahedronPlanes();
  LinearOptions segments;
  segments.segment_only = true;
  segments.epsilon = 0.02;
  return {groupPlanar(mesh, {}), groupPlanar(mesh, quadric), groupLinear(mesh, {}), groupLinear(mesh, segments)};
}

}  // namespace

TEST_CASE("grouping/carried_groups: every copy is in its vertex' group and lies where that has it") {
  const mesh::Mesh mesh = ball();
  for (const VertexGroups& groups : assortedGroups(mesh))
    for (const std::size_t faces : {mesh.triangleCount(), mesh.triangleCount() / 3}) {
      const Copies copies = copiesOf(mesh, faces);
      VertexGroups carried = GroupCarrier(groups).carry(copies.mesh, copies.source);
      measure(copies.mesh.positions, copies.mesh.triangles, carried);
      CHECK(findInconsistency(carried) == "");
      REQUIRE(carried.state.size() == copies.source.size());
      std::map<std::uint32_t, std::uint32_t> group_of;  // before, by group now
      for (std::size_t v = 0; v + 1 < copies.source.size(); ++v) {
        const std::uint32_t from = copies.source[v];
        CHECK(carried.positions[v] == groups.positions[from]);
        CHECK((carried.state[v] == VertexState::kGrouped) == (groups.state[from] == VertexState::kGrouped));
        if (carried.owner[v] == kNoIndex) continue;
        const auto [entry, is_new] = group_of.try_emplace(carried.owner[v], groups.owner[from]);
        CHECK(entry->second == groups.owner[from]);
      }
      CHECK(group_of.size() == carried.groups.size());
      CHECK(carried.state.back() == VertexState::kUnused);
      CHECK(carried.positions.back() == Vec3(7.0F));
      CHECK(carried.stats.displacement_max <= groups.stats.displacement_max);
      CHECK(carried.stats.search_ms == groups.stats.search_ms);
    }
}

TEST_CASE("grouping/carried_groups: a mesh whose vertices are its own copies has the groups that it had") {
  const mesh::Mesh mesh = ball();
  std::vector<std::uint32_t> same(mesh.vertexCount());
  for (std::uint32_t v = 0; v < same.size(); ++v) same[v] = v;
  for (const VertexGroups& groups : assortedGroups(mesh)) {
    VertexGroups carried = GroupCarrier(groups).carry(mesh, same);
    measure(mesh.positions, mesh.triangles, carried);
    carried.stats.restored_vertices = groups.stats.restored_vertices;
    carried.warnings = groups.warnings;
    CHECK(carried == groups);
  }
}

TEST_CASE("grouping/carried_groups: what was carried before leaves no trace") {
  const mesh::Mesh mesh = ball();
  const std::size_t all = mesh.triangleCount();
  for (const VertexGroups& groups : assortedGroups(mesh)) {
    GroupCarrier carrier(groups);
    for (const std::size_t faces : {all, all / 3, all / 2, all}) {
      const Copies copies = copiesOf(mesh, faces);
      CHECK(carrier.carry(copies.mesh, copies.source) == GroupCarrier(groups).carry(copies.mesh, copies.source));
    }
  }
}

TEST_CASE("grouping/carried_groups: by patch, groups have their patch's frame, and no vertex moves") {
  TaskPool pool(1);
  const Copies copies = copiesOf(ball(), ball().triangleCount());
  PlanarOptions options;
  options.planes = dodecahedronPlanes();
  const VertexGroups on_ball = groupPlanar(ball(), options);
  const VertexGroups found = GroupCarrier(on_ball).carry(copies.mesh, copies.source);
  const PatchSet set = splitIntoPatches(copies.mesh, {}, pool);
  VertexGroups framed = framedByPatch(found, set);
  measure(copies.mesh.positions, copies.mesh.triangles, framed);
  CHECK(findInconsistency(framed) == "");
  CHECK(framed.positions == found.positions);
  REQUIRE(framed.planes.size() == set.patches.size());
  CHECK(framed.stats.grouped > copies.mesh.vertexCount() / 20);
  std::vector<std::set<std::uint32_t>> patches_of(copies.mesh.vertexCount());
  for (std::uint32_t p = 0; p < set.patches.size(); ++p)
    for (const std::uint32_t v : set.verticesOf(set.patches[p])) patches_of[v].insert(p);
  for (std::size_t v = 0; v < framed.owner.size(); ++v) {
    if (framed.owner[v] == kNoIndex) continue;
    const VertexGroup &group = framed.groups[framed.owner[v]], &before = found.groups[found.owner[v]];
    CHECK(patches_of[v] == std::set<std::uint32_t>{group.plane});
    CHECK(framed.planes[group.plane] == found.planes[before.plane]);
    CHECK(group.base == before.base);
  }
  // Vertices at one place stay together, whatever the grid does to them.
  const PlacedVertices placed = placeInFrames(copies.mesh, framed, set, ParameterForm::k16Bit);
  std::map<std::uint32_t, Vec3> place_of;
  for (std::size_t v = 0; v + 1 < copies.source.size(); ++v)
    CHECK(place_of.try_emplace(copies.source[v], placed.positions[v]).first->second == placed.positions[v]);
}

}  // namespace sheaf::grouping
