#include "grouping/vertex_runs.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <random>

#include "grouping/linear_groups.h"
#include "grouping/planar_groups.h"
#include "tests/grouping/shapes.h"

namespace sheaf::grouping {
namespace {

// A bumpy closed-form surface z(x, y), away from the origin by `offset`.
mesh::Mesh hills(std::uint32_t side, float offset = 0.0F) {
  return sheet(side, [=](float u, float v) {
    return Vec3(offset) + Vec3(u, v, 0.2F * std::sin(9.0F * u) * std::cos(7.0F * v));
  });
}

struct Built {
  VertexGroups groups;
  PatchSet before, after;
  PlacedVertices placed;
  VertexRuns runs;
};

Built build(const mesh::Mesh& mesh, const VertexGroups& groups, ParameterForm form, std::uint32_t min_plane_run,
            int threads = 1) {
  TaskPool pool(threads);
  Built built{groups, splitIntoPatches(mesh, {}, pool), {}, {}, {}};
  built.after = built.before;
  built.placed = placeGrouped(mesh, groups, built.before, form);
  built.runs = buildVertexRuns(built.placed, min_plane_run, built.after, pool);
  return built;
}

VertexGroups planar(const mesh::Mesh& mesh, double epsilon) {
  PlanarOptions options;
  options.epsilon = epsilon;
  return groupPlanar(mesh, options);
}

// A vertex's position from what is stored of it.
Vec3 decoded(const Built& b, const PatchRuns& patch, const VertexRun& run, std::uint32_t full,
             std::uint32_t parameter) {
  const VertexRuns& runs = b.runs;
  if (run.kind == RunKind::kFull)
    return {runs.full[full], runs.full[full + runs.full_stride], runs.full[full + 2 * runs.full_stride]};
  if (run.kind == RunKind::kLine) {
    const RunLine& line = runs.lines[run.line];
    const float s = runs.form == ParameterForm::kFloat
                        ? runs.parameters[parameter].x
                        : line.s0 + static_cast<float>(runs.quantised[parameter]) * line.ds;
    return line.base + s * line.direction;
  }
  Vec3 p;
  p[run.axis] = run.plane;
  const auto [i, j] = axesBeside(run.axis);
  if (runs.form == ParameterForm::kFloat) {
    p[static_cast<int>(i)] = runs.parameters[parameter].x;
    p[static_cast<int>(j)] = runs.parameters[parameter].y;
  } else {
    const std::uint32_t word = runs.quantised[parameter];
    p[static_cast<int>(i)] =
        static_cast<float>(patch.corner[i] + static_cast<std::int32_t>(word & 0xFFFFU)) * runs.step;
    p[static_cast<int>(j)] = static_cast<float>(patch.corner[j] + static_cast<std::int32_t>(word >> 16)) * runs.step;
  }
  return p;
}

std::map<std::uint32_t, mesh::Triangle> trianglesOf(const PatchSet& set, const Patch& patch) {
  std::map<std::uint32_t, mesh::Triangle> triangles;
  for (std::uint32_t t = patch.first_triangle; t < patch.first_triangle + patch.triangle_count; ++t)
    for (std::size_t k = 0; k < 3; ++k)
      triangles[set.triangle_source[t]][k] = set.vertex_source[patch.first_vertex + set.corners[k][t]];
  return triangles;
}

// All that runs promise.
void checkRuns(const Built& b) {
  REQUIRE(b.runs.patches.size() == b.after.patches.size());
  for (std::size_t p = 0; p < b.after.patches.size(); ++p) {
    const Patch& patch = b.after.patches[p];
    const PatchRuns& at = b.runs.patches[p];
    CHECK(trianglesOf(b.after, patch) == trianglesOf(b.before, b.before.patches[p]));
    std::uint32_t vertex = 0, triangle = 0, full = at.first_full, parameter = at.first_parameter;
    for (std::uint32_t r = at.first_run; r < at.first_run + at.run_count; ++r) {
      const VertexRun& run = b.runs.runs[r];
      CHECK(run.vertex_count > 0);
      CHECK((run.kind != RunKind::kFull || r == at.first_run));  // at most one, and first
      for (std::uint32_t i = 0; i < run.vertex_count; ++i) {
        const std::uint32_t v = b.after.vertex_source[patch.first_vertex + vertex + i];
        CHECK(decoded(b, at, run, full + i, parameter + i) == b.placed.positions[v]);
        if (run.kind == RunKind::kLine) continue;
        CHECK(b.placed.positions[v] == glm::clamp(b.placed.positions[v], run.corner_lo, run.corner_hi));
      }
      for (std::uint32_t t = triangle; t < triangle + run.triangle_count; ++t)
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t corner = b.after.corners[k][patch.first_triangle + t];
          CHECK((corner >= vertex && corner < vertex + run.vertex_count));
        }
      vertex += run.vertex_count;
      triangle += run.triangle_count;
      (run.kind == RunKind::kFull ? full : parameter) += run.vertex_count;
    }
    CHECK(vertex == patch.vertex_count);
    CHECK(triangle <= patch.triangle_count);
  }
}

std::size_t inFull(const Built& b) {
  std::size_t count = 0;
  for (const VertexRun& run : b.runs.runs) count += run.kind == RunKind::kFull ? run.vertex_count : 0;
  return count;
}

std::size_t verticesOf(const PatchSet& set) {
  std::size_t count = 0;
  for (const Patch& patch : set.patches) count += patch.vertex_count;
  return count;
}

}  // namespace

TEST_CASE("grouping/vertex_runs: sorting keeps every triangle, and what is stored is where the vertex was placed") {
  std::mt19937 rng(11);
  for (const mesh::Mesh& mesh : {hills(41), hills(41, 1e6F), hills(2), triangleSoup(rng, 300, 900)})
    for (const ParameterForm form : {ParameterForm::k16Bit, ParameterForm::kFloat})
      for (const double epsilon : {0.0, 0.004, 0.1, 3.0})
        for (const std::uint32_t min_plane_run : {1U, 20U, 1000U}) {
          CAPTURE(epsilon);
          CAPTURE(min_plane_run);
          checkRuns(build(mesh, planar(mesh, epsilon), form, min_plane_run));
        }
}

TEST_CASE("grouping/vertex_runs: lines too") {
  const mesh::Mesh mesh = hills(15);
  LinearOptions options;
  options.epsilon = 0.02;
  const VertexGroups groups = groupLinear(mesh, options);
  REQUIRE(groups.stats.grouped > 20);
  for (const ParameterForm form : {ParameterForm::k16Bit, ParameterForm::kFloat}) {
    const Built built = build(mesh, groups, form, 1);
    checkRuns(built);
    CHECK(inFull(built) < mesh.vertexCount());
  }
}

TEST_CASE(
    "grouping/vertex_runs: a vertex moves by epsilon across its plane at most, and along it by half a grid step") {
  const mesh::Mesh mesh = hills(61);
  const VertexGroups groups = planar(mesh, 0.01);
  const Built built = build(mesh, groups, ParameterForm::k16Bit, 1);
  const double eps = groups.epsilon * groups.extent * (1.0 + 1e-6);
  CHECK(built.placed.step < 1e-4);
  for (std::uint32_t v = 0; v < mesh.vertexCount(); ++v) {
    const VertexPlace& place = built.placed.places[v];
    const DVec3 moved = glm::abs(DVec3(built.placed.positions[v]) - DVec3(mesh.positions[v]));
    if (place.kind == RunKind::kFull) CHECK(moved == DVec3(0.0));
    for (int k = 0; k < 3 && place.kind == RunKind::kPlane; ++k)
      CHECK(moved[k] <= (k == place.axis ? eps : 0.5 * built.placed.step * (1.0 + 1e-6)));
    if (groups.state[v] == VertexState::kGrouped) CHECK(place.kind == RunKind::kPlane);
    if (groups.state[v] == VertexState::kDefining) CHECK(moved[place.axis] == 0.0);
  }
}

TEST_CASE("grouping/vertex_runs: patches have few planes, fewer than by nearest plane") {
  const mesh::Mesh mesh = hills(101);
  const VertexGroups groups = planar(mesh, 0.005);
  const Built built = build(mesh, groups, ParameterForm::k16Bit, 1);
  std::size_t by_nearest = 0;
  for (const Patch& patch : built.before.patches) {
    std::vector<std::uint32_t> owners;
    for (std::uint32_t i = 0; i < patch.vertex_count; ++i)
      owners.push_back(groups.owner[built.before.vertex_source[patch.first_vertex + i]]);
    std::sort(owners.begin(), owners.end());
    by_nearest += static_cast<std::size_t>(std::unique(owners.begin(), owners.end()) - owners.begin());
  }
  CHECK(built.runs.runs.size() < by_nearest);
}

TEST_CASE("grouping/vertex_runs: short runs on planes are stored in full, all of them if so asked, and by slot then") {
  const mesh::Mesh mesh = hills(41);
  const VertexGroups groups = planar(mesh, 0.005);
  std::size_t last = 0;
  for (const std::uint32_t min_plane_run : {1U, 16U, 64U, 1000U}) {
    const Built built = build(mesh, groups, ParameterForm::k16Bit, min_plane_run);
    for (const VertexRun& run : built.runs.runs)
      if (run.kind == RunKind::kPlane) CHECK(run.vertex_count >= min_plane_run);
    CHECK(inFull(built) >= last);
    last = inFull(built);
    CHECK(built.runs.isFullBySlot() == (inFull(built) == verticesOf(built.after)));
  }
  const Built built = build(mesh, groups, ParameterForm::k16Bit, 1000);
  for (std::size_t slot = 0; slot < built.after.vertex_source.size(); ++slot)
    for (int k = 0; k < 3; ++k)
      CHECK(built.runs.full[slot + static_cast<std::size_t>(k) * built.runs.full_stride] ==
            built.placed.positions[built.after.vertex_source[slot]][k]);
}

TEST_CASE("grouping/vertex_runs: any number of threads gives the same runs") {
  const mesh::Mesh mesh = hills(71);
  const VertexGroups groups = planar(mesh, 0.005);
  const Built one = build(mesh, groups, ParameterForm::k16Bit, 16);
  const Built seven = build(mesh, groups, ParameterForm::k16Bit, 16, 7);
  CHECK(one.runs.quantised == seven.runs.quantised);
  CHECK(one.runs.full == seven.runs.full);
  CHECK(one.after.corners == seven.after.corners);
}

}  // namespace sheaf::grouping
