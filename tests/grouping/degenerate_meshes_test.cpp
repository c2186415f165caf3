// Both searches and both metrics on meshes that are hard on them, and on the built-in scenes.
#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "core/error.h"
#include "grouping/groups_file.h"
#include "grouping/naive_groups.h"
#include "scenes/builtin.h"
#include "tests/grouping/shapes.h"

namespace sheaf::grouping {
namespace {

struct NamedMesh {
  const char* name;
  mesh::Mesh mesh;
};

mesh::Mesh flattened(mesh::Mesh mesh, const std::function<Vec3(const Vec3&)>& onto) {
  for (Vec3& p : mesh.positions) p = onto(p);
  return mesh;
}

mesh::Mesh threeSheetsOnOneEdge() {
  mesh::Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0.003F, 0.5F}, {-1, 0.5F, 0.5F}, {0.2F, -1, 0.497F}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}};
  return mesh;
}

mesh::Mesh ballsThatTouch(std::mt19937& rng) {
  mesh::Mesh mesh = lumpyBall(rng, 6, 8, 0.01F);
  const mesh::Mesh other = mesh;
  const auto first = static_cast<std::uint32_t>(mesh.vertexCount());
  const Vec3 apart = mesh.positions.front() - mesh.positions.back();
  for (const Vec3& p : other.positions) mesh.positions.push_back(p + apart);
  // The other's last vertex is this one's first.
  for (mesh::Triangle t : other.triangles) {
    for (std::uint32_t& v : t) v = v + 1 == first ? 0 : v + first;
    mesh.triangles.push_back(t);
  }
  return mesh;
}

std::vector<NamedMesh> hardMeshes() {
  std::mt19937 rng(0xdead);
  const mesh::Mesh ball = lumpyBall(rng, 7, 9, 0.02F);
  mesh::Mesh one_vertex;
  one_vertex.positions = {{1, 2, 3}};
  one_vertex.triangles = {{0, 0, 0}};
  mesh::Mesh twice = ball;
  twice.triangles.insert(twice.triangles.end(), ball.triangles.begin(), ball.triangles.end());
  for (mesh::Triangle t : ball.triangles) twice.triangles.push_back({t[0], t[2], t[1]});
  mesh::Mesh unused = ball;
  unused.positions.insert(unused.positions.begin() + 5, Vec3(std::numeric_limits<float>::quiet_NaN()));
  for (mesh::Triangle& t : unused.triangles)
    for (std::uint32_t& v : t) v += v >= 5 ? 1 : 0;
  mesh::Mesh points = ball;
  points.triangles.clear();
  return {{"nothing", {}},
          {"one vertex in one face", one_vertex},
          {"all in one point", flattened(ball, [](const Vec3&) { return Vec3(1, -2, 3); })},
          {"on a slanting line", flattened(ball, [](const Vec3& p) { return p.y * Vec3(0.3F, 1.0F, -0.7F); })},
          {"on an axis", flattened(ball, [](const Vec3& p) { return Vec3(0.0F, p.y, 0.0F); })},
          {"in an axis plane", flattened(ball, [](const Vec3& p) { return Vec3(p.x, 0.5F, p.z); })},
          {"in a slanting plane", flattened(ball, [](const Vec3& p) { return Vec3(p.x, p.y, p.x - p.y); })},
          {"far away and tiny", flattened(ball, [](const Vec3& p) { return Vec3(1e6F) + p; })},
          {"every face three times, turned over once", twice},
          {"three sheets on one edge", threeSheetsOnOneEdge()},
          {"two balls that touch in a vertex", ballsThatTouch(rng)},
          {"soup", triangleSoup(rng, 40, 80)},
          {"a vertex of no number that no face uses", unused},
          {"no faces", points}};
}

// Small versions of all of them.
std::vector<NamedMesh> builtinMeshes() {
  std::vector<NamedMesh> meshes;
  for (const char* spec : {"gallery", "teapot?n=4", "sphere?n=7", "torusknot?u=40&v=6", "terrain?n=17", "city?blocks=2",
                           "cornell?n=4", "fill?layers=5"})
    for (mesh::Mesh& mesh : scenes::buildBuiltin(spec).meshes) meshes.push_back({spec, std::move(mesh)});
  return meshes;
}

VertexGroups timeless(VertexGroups groups) {
  groups.stats.search_ms = 0.0;
  return groups;
}

// What every result has to keep.
void checkPromises(const mesh::Mesh& mesh, const VertexGroups& groups) {
  CHECK(findInconsistency(groups) == "");
  const GroupingStats& stats = groups.stats;
  CHECK(stats.free + stats.defining + stats.grouped == stats.vertices);
  for (std::size_t v = 0; v < groups.state.size(); ++v)
    if (groups.state[v] != VertexState::kUnused) CHECK(isFinite(groups.positions[v]));
  double farthest = 0.0;
  for (const std::uint32_t v : groups.members)
    for (int k = 0; k < 3; ++k) farthest = std::max(farthest, std::abs(double(mesh.positions[v][k])));
  if (groups.metric == Metric::kDistance)
    CHECK(stats.displacement_max * groups.extent <= groups.epsilon * groups.extent + 1e-6 * (groups.extent + farthest));
  else if (groups.limit == Limit::kSafe)
    CHECK(stats.flipped_faces + stats.collapsed_faces == 0);
  if (groups.metric == Metric::kQuadric) CHECK(mesh.triangleCount() > 0);
}

template <class Options>
std::vector<Options> everyMetric() {
  std::vector<Options> all;
  for (const double epsilon : {0.0, 0.01, 0.2})
    for (const auto& [metric, limit] :
         {std::pair(Metric::kDistance, Limit::kSafe), std::pair(Metric::kQuadric, Limit::kSafe),
          std::pair(Metric::kQuadric, Limit::kPaper)}) {
      Options options;
      options.epsilon = epsilon;
      options.metric = metric;
      options.limit = limit;
      all.push_back(options);
    }
  return all;
}

}  // namespace

TEST_CASE("grouping/degenerate_meshes: by planes every promise is kept, and the fast search equals the naive one") {
  for (const auto& [name, mesh] : hardMeshes())
    for (PlanarOptions options : everyMetric<PlanarOptions>())
      for (const TableKey key : {TableKey::kUnion, TableKey::kSum, TableKey::kDynamic}) {
        options.key = key;
        CAPTURE(name);
        CAPTURE(options.epsilon);
        CAPTURE(int(options.metric));
        CAPTURE(int(options.limit));
        const VertexGroups groups = groupPlanar(mesh, options);
        checkPromises(mesh, groups);
        // As bytes, since one position is no number and equals nothing.
        CHECK(encodeGroups(timeless(groups)) == encodeGroups(timeless(naiveGroupPlanar(mesh, options))));
      }
}

TEST_CASE("grouping/degenerate_meshes: by lines every promise is kept, and the fast search equals the naive one") {
  for (const auto& [name, mesh] : hardMeshes())
    for (LinearOptions options : everyMetric<LinearOptions>())
      for (const bool segment_only : {false, true}) {
        options.segment_only = segment_only;
        CAPTURE(name);
        CAPTURE(options.epsilon);
        CAPTURE(int(options.metric));
        CAPTURE(int(options.limit));
        const VertexGroups groups = groupLinear(mesh, options);
        checkPromises(mesh, groups);
        CHECK(encodeGroups(timeless(groups)) == encodeGroups(timeless(naiveGroupLinear(mesh, options))));
      }
}

TEST_CASE("grouping/degenerate_meshes: a used vertex that is no number is refused, whatever the metric") {
  mesh::Mesh mesh = threeSheetsOnOneEdge();
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 2e30F}) {
    mesh.positions[3].y = bad;
    for (const PlanarOptions& options : everyMetric<PlanarOptions>()) {
      CHECK_THROWS_WITH_AS(groupPlanar(mesh, options), doctest::Contains("vertex 3: position"), Error);
    }
    for (const LinearOptions& options : everyMetric<LinearOptions>()) {
      CHECK_THROWS_WITH_AS(groupLinear(mesh, options), doctest::Contains("vertex 3: position"), Error);
    }
  }
}

TEST_CASE("grouping/degenerate_meshes: built-in scenes keep every promise, by planes and by lines") {
  for (const auto& [spec, mesh] : builtinMeshes()) {
    CAPTURE(spec);
    CAPTURE(mesh.vertexCount());
    for (const PlanarOptions& options : everyMetric<PlanarOptions>()) {
      const VertexGroups groups = groupPlanar(mesh, options);
      checkPromises(mesh, groups);
      if (mesh.vertexCount() < 1000) CHECK(timeless(groups) == timeless(naiveGroupPlanar(mesh, options)));
    }
    if (mesh.vertexCount() > 400) continue;  // the naive search for lines takes the cube of it
    for (const LinearOptions& options : everyMetric<LinearOptions>()) {
      const VertexGroups groups = groupLinear(mesh, options);
      checkPromises(mesh, groups);
      CHECK(timeless(groups) == timeless(naiveGroupLinear(mesh, options)));
    }
  }
}

}  // namespace sheaf::grouping
