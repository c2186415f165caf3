#include "grouping/patch_groups.h"

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "core/error.h"
#include "grouping/quadric.h"
#include "grouping/vertex_runs.h"
#include "tests/grouping/shapes.h"

namespace sheaf::grouping {
namespace {

// By vertex, the patches it is in.
std::vector<std::set<std::uint32_t>> patchesOf(const mesh::Mesh& mesh, const PatchSet& set) {
  std::vector<std::set<std::uint32_t>> patches(mesh.vertexCount());
  for (std::uint32_t p = 0; p < set.patches.size(); ++p)
    for (std::uint32_t i = 0; i < set.patches[p].vertex_count; ++i)
      patches[set.vertex_source[set.patches[p].first_vertex + i]].insert(p);
  return patches;
}

double offPlane(const VertexGroups& groups, std::uint32_t v) {
  const VertexGroup& g = groups.groups[groups.owner[v]];
  return glm::dot(DVec3(groups.positions[v]) - DVec3(g.base), DVec3(groups.planes[g.plane].normal));
}

}  // namespace

TEST_CASE("grouping/patch_groups: members are inside one patch, on a plane of its frame and within epsilon") {
  const mesh::Mesh mesh = tiltedHills(60, 0.1F);
  for (const int threads : {1, 3}) {
    TaskPool pool(threads);
    const PatchSet set = splitIntoPatches(mesh, {}, pool);
    const VertexGroups groups = groupInPatches(mesh, set, {}, pool);
    CHECK(findInconsistency(groups) == "");
    CHECK(groups.planes.size() == set.patches.size());
    const auto patches = patchesOf(mesh, set);
    for (const std::uint32_t v : groups.members) {
      const VertexGroup& g = groups.groups[groups.owner[v]];
      CHECK(patches[v] == std::set{g.plane});
      CHECK(patches[g.origin].contains(g.plane));
      CHECK(std::abs(offPlane(groups, v)) < 1e-6);
      CHECK(glm::distance(groups.positions[v], mesh.positions[v]) <= groups.epsilon * groups.extent * (1 + 1e-5));
    }
    CHECK(groups.stats.eliminated > 0.5);
    CHECK(groups.stats.flipped_faces == 0);
    TaskPool one(1);
    CHECK(groups.positions == groupInPatches(mesh, set, {}, one).positions);
  }
}

TEST_CASE("grouping/patch_groups: planes that take fewer than min_members are left out") {
  TaskPool pool(1);
  const mesh::Mesh mesh = tiltedHills(60, 0.3F);
  const PatchSet set = splitIntoPatches(mesh, {}, pool);
  std::uint32_t all = 0;
  for (const std::uint32_t least : {1U, 10U, 40U, 300U}) {
    const VertexGroups groups = groupInPatches(mesh, set, {.min_members = least}, pool);
    for (const VertexGroup& g : groups.groups) CHECK(g.member_count >= least);
    if (least == 1) all = groups.stats.grouped;
    CHECK(groups.stats.grouped <= all);
    if (least == 300) CHECK(groups.stats.grouped == 0);
  }
  CHECK(all > 1000);
}

TEST_CASE("grouping/patch_groups: by quadric, members keep to their ellipsoids and no face folds over") {
  TaskPool pool(2);
  const mesh::Mesh mesh = tiltedHills(50, 0.2F);
  const PatchSet set = splitIntoPatches(mesh, {}, pool);
  const VertexGroups groups = groupInPatches(mesh, set, {.epsilon = 0.01, .metric = Metric::kQuadric}, pool);
  const std::vector<Sym3> ellipsoids = vertexEllipsoids(mesh, 0.01 * groups.extent, Limit::kSafe);
  CHECK(groups.stats.grouped > 200);
  CHECK(groups.stats.flipped_faces + groups.stats.collapsed_faces == 0);
  for (const std::uint32_t v : groups.members) {
    const DVec3 moved = DVec3(groups.positions[v]) - DVec3(mesh.positions[v]);
    if (ellipsoids[v].determinant() > 1e-18) CHECK(glm::dot(moved, inverse(ellipsoids[v]).times(moved)) <= 1.0 + 1e-2);
    CHECK(std::abs(offPlane(groups, v)) < 1e-6);
  }
}

TEST_CASE("grouping/patch_groups: vertices at a seam between patches stay, even where no vertex is shared") {
  TaskPool pool(1);
  mesh::Mesh mesh = tiltedHills(40, 0.05F);
  // The right half gets its own vertices along the middle.
  std::map<std::uint32_t, std::uint32_t> twin;
  for (mesh::Triangle& t : mesh.triangles) {
    const bool right = (t[0] % 40 >= 20) || (t[1] % 40 > 20) || (t[2] % 40 > 20);
    for (std::uint32_t& v : t)
      if (right && v % 40 == 20) {
        const auto [at, is_new] = twin.try_emplace(v, static_cast<std::uint32_t>(mesh.positions.size()));
        if (is_new) mesh.positions.push_back(mesh.positions[v]);
        v = at->second;
      }
  }
  CHECK(twin.size() == 40);
  const PatchSet set = splitIntoPatches(mesh, {}, pool);
  for (const Metric metric : {Metric::kDistance, Metric::kQuadric}) {
    const VertexGroups groups = groupInPatches(mesh, set, {.epsilon = 0.02, .metric = metric}, pool);
    for (const auto& [left, right] : twin)
      if (groups.state[left] != VertexState::kUnused) CHECK(groups.positions[left] == groups.positions[right]);
    CHECK(groups.stats.grouped > 100);
  }
}

TEST_CASE("grouping/patch_groups: vertices at a seam inside a patch stay together when they are placed") {
  TaskPool pool(1);
  mesh::Mesh mesh = tiltedHills(12, 0.02);
  const auto side = static_cast<std::uint32_t>(mesh.vertexCount());
  mesh.positions.insert(mesh.positions.end(), mesh.positions.begin(), mesh.positions.end());
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 3)
    for (std::uint32_t& v : mesh.triangles[t]) v += side;
  const PatchSet set = splitIntoPatches(mesh, {.max_vertices = 256, .max_triangles = 512}, pool);
  const VertexGroups groups = groupInPatches(mesh, set, {.epsilon = 0.05}, pool);
  const PlacedVertices placed = placeInFrames(mesh, groups, set, ParameterForm::k16Bit);
  for (std::uint32_t v = 0; v < side; ++v)
    if (groups.state[v] != VertexState::kUnused && groups.state[v + side] != VertexState::kUnused)
      CHECK(placed.positions[v] == placed.positions[v + side]);
}

TEST_CASE("grouping/patch_groups: a flat patch is one plane") {
  TaskPool pool(1);
  mesh::Mesh mesh = tiltedHills(12, 0.0F);
  const PatchSet set = splitIntoPatches(mesh, {}, pool);
  REQUIRE(set.patches.size() == 1);
  const VertexGroups flat = groupInPatches(mesh, set, {.epsilon = 1e-6}, pool);
  CHECK(flat.groups.size() == 1);
  CHECK(flat.stats.grouped == mesh.vertexCount() - 1);
}

TEST_CASE("grouping/patch_groups: no faces, one face, huge epsilon, vertices that are not finite") {
  TaskPool pool(1);
  CHECK(groupInPatches({}, {}, {}, pool).groups.empty());
  mesh::Mesh one;
  one.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  one.triangles = {{0, 1, 2}};
  const PatchSet set = splitIntoPatches(one, {}, pool);
  const VertexGroups groups = groupInPatches(one, set, {.epsilon = kMaxEpsilon}, pool);
  CHECK(findInconsistency(groups) == "");
  CHECK(groups.stats.grouped == 2);
  one.positions[1].x = std::numeric_limits<float>::quiet_NaN();
  CHECK_THROWS_AS(groupInPatches(one, set, {}, pool), Error);
}

TEST_CASE("grouping/patch_groups: what is stored of a vertex in its patch's frame is where it is said to be drawn") {
  TaskPool pool(1);
  mesh::Mesh mesh = tiltedHills(60, 0.1F);
  for (Vec3& p : mesh.positions) p += Vec3(100.0F, -50.0F, 3.0F);
  PatchSet set = splitIntoPatches(mesh, {}, pool);
  const VertexGroups groups = groupInPatches(mesh, set, {}, pool);
  for (const ParameterForm form : {ParameterForm::k16Bit, ParameterForm::kFloat}) {
    PatchSet sorted = set;
    const PlacedVertices placed = placeInFrames(mesh, groups, set, form);
    const VertexRuns runs = buildVertexRuns(placed, 20, sorted, pool);
    std::size_t on_planes = 0;
    for (std::size_t p = 0; p < sorted.patches.size(); ++p) {
      const PatchRuns& at = runs.patches[p];
      std::uint32_t slot = sorted.patches[p].first_vertex, parameter = at.first_parameter;
      for (std::uint32_t r = at.first_run; r < at.first_run + at.run_count; ++r)
        for (std::uint32_t i = 0; i < runs.runs[r].vertex_count; ++i, ++slot) {
          const VertexRun& run = runs.runs[r];
          if (run.kind != RunKind::kPlane) continue;
          REQUIRE(at.frame != kNoIndex);
          const PatchFrame& frame = runs.frames[at.frame];
          Vec2 st;
          if (form == ParameterForm::kFloat) {
            st = runs.parameters[parameter];
          } else {
            const std::uint32_t word = runs.quantised[parameter];
            st.x = static_cast<float>(at.corner[0] + static_cast<std::int32_t>(word & 0xFFFFU)) * runs.step;
            st.y = static_cast<float>(at.corner[1] + static_cast<std::int32_t>(word >> 16)) * runs.step;
          }
          ++parameter, ++on_planes;
          CHECK((st.x >= run.corner_lo.x && st.x <= run.corner_hi.x && st.y >= run.corner_lo.y &&
                 st.y <= run.corner_hi.y && run.plane >= run.corner_lo.z && run.plane <= run.corner_hi.z));
          const Vec3 p_object =
              frame.origin + st.x * frame.axes.axis_s + st.y * frame.axes.axis_t + run.plane * frame.axes.normal;
          const std::uint32_t v = sorted.vertex_source[slot];
          CHECK(glm::distance(p_object, placed.positions[v]) < 3e-5F);
          CHECK(glm::distance(placed.positions[v], groups.positions[v]) < 3e-5F);
        }
    }
    CHECK(on_planes > 1000);
  }
}

}  // namespace sheaf::grouping
