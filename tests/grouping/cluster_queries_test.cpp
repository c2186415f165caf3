#include "grouping/cluster_queries.h"

#include <doctest/doctest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "grouping/dual_graph.h"
#include "mesh/triangle_queries.h"
#include "scenes/builtin.h"
#include "tests/embree_scene.h"
#include "tests/grouping/shapes.h"

namespace sheaf::grouping {
namespace {

struct Model {
  mesh::Mesh mesh;
  FaceClusters clusters;
};

Model makeModel(mesh::Mesh mesh) {
  TaskPool pool(1);
  FaceClusters clusters = clusterFaces(mesh, {}, pool);
  return {std::move(mesh), std::move(clusters)};
}

// A closed ball, a field with a border, faces through each other in many pieces, faces without area or number; one far
// away from the origin, and one a million away.
std::vector<Model> models() {
  std::mt19937 rng(0x9e51);
  std::vector<Model> models;
  models.push_back(makeModel(lumpyBall(rng, 40, 50, 0.01F)));
  models.push_back(makeModel(hills(rng, 30)));
  mesh::Mesh soup = triangleSoup(rng, 60, 150);
  soup.positions[7].x = std::numeric_limits<float>::quiet_NaN();
  soup.triangles.push_back({3, 3, 4});
  models.push_back(makeModel(soup));
  mesh::Mesh far = lumpyBall(rng, 20, 20);
  for (Vec3& p : far.positions) p += Vec3(5000.0F, -3000.0F, 1000.0F);
  models.push_back(makeModel(far));
  for (Vec3& p : far.positions) p = 50.0F * (p - Vec3(5000.0F, -3000.0F, 1000.0F)) + Vec3(1e6F, -1e6F, 1e6F);
  models.push_back(makeModel(far));
  return models;
}

mesh::Corners cornersOf(const mesh::Mesh& mesh, std::uint32_t face) {
  const mesh::Triangle& t = mesh.triangles[face];
  return {DVec3(mesh.positions[t[0]]), DVec3(mesh.positions[t[1]]), DVec3(mesh.positions[t[2]])};
}

std::optional<RayHit> plainHit(const mesh::Mesh& mesh, const Ray& ray) {
  std::optional<RayHit> best;
  for (std::uint32_t f = 0; f < mesh.triangleCount(); ++f) {
    if (!hasFiniteCorners(mesh, mesh.triangles[f])) continue;
    const auto t = mesh::meetLine(cornersOf(mesh, f), ray.origin, ray.direction);
    if (t && *t >= ray.t_min && *t <= ray.t_max && (!best || *t < best->t)) best = RayHit{f, *t};
  }
  return best;
}

std::optional<SurfacePoint> plainPoint(const mesh::Mesh& mesh, const DVec3& p, double most) {
  std::optional<SurfacePoint> best;
  for (std::uint32_t f = 0; f < mesh.triangleCount(); ++f) {
    if (!hasFiniteCorners(mesh, mesh.triangles[f])) continue;
    const DVec3 nearest = mesh::closestPoint(cornersOf(mesh, f), p);
    const double distance = glm::distance(nearest, p);
    if (distance <= most && (!best || distance < best->distance)) best = SurfacePoint{f, nearest, distance};
  }
  return best;
}

std::vector<FacePair> plainOverlap(const mesh::Mesh& a, const mesh::Mesh& b, const DMat4& a_from_b) {
  std::vector<FacePair> pairs;
  for (std::uint32_t f = 0; f < a.triangleCount(); ++f)
    for (std::uint32_t g = 0; g < b.triangleCount(); ++g) {
      if (!hasFiniteCorners(a, a.triangles[f]) || !hasFiniteCorners(b, b.triangles[g])) continue;
      mesh::Corners other = cornersOf(b, g);
      for (DVec3& p : other) p = DVec3(a_from_b * DVec4(p, 1.0));
      if (mesh::overlap(cornersOf(a, f), other)) pairs.push_back({f, g});
    }
  return pairs;
}

// In twice the mesh's box.
DVec3 pointAround(const mesh::Mesh& mesh, std::mt19937& rng) {
  Box3 box;
  for (const Vec3& p : mesh.positions)
    if (isFinite(p)) box.extend(p);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const double x = unit(rng), y = unit(rng), z = unit(rng);
  return DVec3(box.center()) + DVec3(box.size()) * DVec3(x, y, z);
}

}  // namespace

TEST_CASE("grouping/cluster_queries: a ray hits what a loop over all faces hits") {
  std::mt19937 rng(0x9e52);
  for (const Model& m : models()) {
    int hits = 0;
    for (int i = 0; i < 1500; ++i) {
      CAPTURE(i);
      Ray ray;
      ray.origin = pointAround(m.mesh, rng);
      const DVec3 to = pointAround(m.mesh, rng);
      ray.direction = (i % 3 == 0 ? 10.0 : 1.0) * (to - ray.origin);
      if (i % 5 == 0) ray.direction[i % 3] = 0.0;
      if (i % 7 == 0) ray.direction = {0.0, i % 2 == 0 ? 1.0 : -1.0, 0.0};
      if (i % 4 == 0) ray.t_max = 0.7;
      if (i % 11 == 0) ray.t_min = 0.3;
      const auto hit = closestHit(m.mesh, m.clusters, ray);
      CHECK(hit == plainHit(m.mesh, ray));
      hits += hit.has_value();
    }
    CHECK(hits > 100);
  }
}

TEST_CASE("grouping/cluster_queries: rays at vertices and along edges hit what a loop hits") {
  std::mt19937 rng(0x9e53);
  for (const Model& m : models())
    for (std::uint32_t v = 0; v < m.mesh.vertexCount(); v += 3) {
      CAPTURE(v);
      const Vec3 p = m.mesh.positions[v], q = m.mesh.positions[(v + 1) % m.mesh.vertexCount()];
      if (!isFinite(p) || !isFinite(q)) continue;
      Ray ray;
      ray.origin = pointAround(m.mesh, rng);
      ray.direction = DVec3(p) - ray.origin;
      CHECK(closestHit(m.mesh, m.clusters, ray) == plainHit(m.mesh, ray));
      ray.origin = DVec3(p);
      ray.direction = DVec3(q) - DVec3(p);
      if (ray.direction != DVec3(0.0)) CHECK(closestHit(m.mesh, m.clusters, ray) == plainHit(m.mesh, ray));
    }
}

TEST_CASE("grouping/cluster_queries: a ray hits what Embree hits") {
  std::mt19937 rng(0x9e56);
  std::vector<mesh::Mesh> meshes = {lumpyBall(rng, 60, 80, 0.005F), hills(rng, 60), triangleSoup(rng, 200, 400)};
  const scenes::Scene teapot = scenes::buildBuiltin("teapot?n=10");
  meshes.insert(meshes.end(), teapot.meshes.begin(), teapot.meshes.end());
  for (const mesh::Mesh& mesh : meshes) {
    const Model m = makeModel(mesh);
    EmbreeScene embree;
    embree.makeRobust();
    embree.add(0, mesh);
    embree.commit();
    const double extent = double{mesh::boundsOf(mesh).longestEdge()};
    constexpr int kRays = 20000;
    int hits = 0, apart = 0;
    for (int i = 0; i < kRays; ++i) {
      // What Embree is given are floats.
      const DVec3 origin(Vec3(pointAround(mesh, rng)));
      const DVec3 direction(Vec3(pointAround(mesh, rng) - origin));
      const auto ours = closestHit(m.mesh, m.clusters, {.origin = origin, .direction = direction});
      const EmbreeHit theirs = embree.cast(origin, direction);
      hits += ours.has_value();
      const bool same = ours.has_value() == bool(theirs) &&
                        (!ours || std::abs(ours->t - theirs.t) * glm::length(direction) < 1e-5 * extent);
      apart += same ? 0 : 1;
      // Not only as far away: the same face, but at edges, or where two are that near to each other.
      if (same && ours && ours->face != theirs.triangle) {
        const auto t = mesh::meetLine(cornersOf(mesh, theirs.triangle), origin, direction);
        const bool at_edge = !t.has_value();
        CHECK((at_edge || std::abs(*t - ours->t) * glm::length(direction) < 1e-5 * extent));
      }
    }
    CAPTURE(mesh.triangleCount());
    CHECK(hits > kRays / 20);
    CHECK(apart <= kRays / 5000);  // rays that graze an edge
  }
}

TEST_CASE("grouping/cluster_queries: the closest point is that of a loop over all faces") {
  std::mt19937 rng(0x9e54);
  for (const Model& m : models())
    for (int i = 0; i < 600; ++i) {
      CAPTURE(i);
      DVec3 p = pointAround(m.mesh, rng);
      if (i % 4 == 0) p = DVec3(m.mesh.positions[8 + rng() % (m.mesh.vertexCount() - 8)]);  // many faces at 0
      const double most = i % 3 == 0 ? 0.1 : std::numeric_limits<double>::infinity();
      CHECK(closestPoint(m.mesh, m.clusters, p, most) == plainPoint(m.mesh, p, most));
    }
}

TEST_CASE("grouping/cluster_queries: two meshes overlap in the faces that a loop over all pairs finds") {
  std::mt19937 rng(0x9e55);
  const Model ball = makeModel(lumpyBall(rng, 14, 18, 0.01F)), field = makeModel(hills(rng, 14));
  const Model soup = makeModel(triangleSoup(rng, 30, 40));
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::size_t pairs = 0, empty = 0;
  for (int i = 0; i < 12; ++i) {
    CAPTURE(i);
    const DVec3 axis(unit(rng), unit(rng), 0.3), shift(1.5 * unit(rng), 1.5 * unit(rng), 1.5 * unit(rng));
    const DMat4 a_from_b = glm::translate(DMat4(1.0), shift) * glm::rotate(DMat4(1.0), 3.0 * unit(rng), axis);
    const Model& a = i % 2 == 0 ? ball : soup;
    const Model& b = i % 3 == 0 ? ball : field;
    const std::vector<FacePair> expected = plainOverlap(a.mesh, b.mesh, a_from_b);
    CHECK(overlappingFaces({a.mesh, a.clusters}, {b.mesh, b.clusters}, a_from_b) == expected);
    const auto any = overlappingFaces({a.mesh, a.clusters}, {b.mesh, b.clusters}, a_from_b, 1);
    CHECK(any.size() == std::min<std::size_t>(1, expected.size()));
    for (const FacePair& pair : any) CHECK(std::ranges::binary_search(expected, pair));
    pairs += expected.size();
    empty += expected.empty();
  }
  CHECK(pairs > 100);
  CHECK(empty < 12);
  const DMat4 away = glm::translate(DMat4(1.0), DVec3(5.0, 0.0, 0.0));
  CHECK(overlappingFaces({ball.mesh, ball.clusters}, {ball.mesh, ball.clusters}, away).empty());
  CHECK(overlappingFaces({ball.mesh, ball.clusters}, {ball.mesh, ball.clusters}) ==
        plainOverlap(ball.mesh, ball.mesh, DMat4(1.0)));
}

TEST_CASE("grouping/cluster_queries: nothing is found in nothing") {
  const Model none = makeModel({});
  CHECK(!closestHit(none.mesh, none.clusters, {}));
  CHECK(!closestPoint(none.mesh, none.clusters, DVec3(0.0)));
  CHECK(overlappingFaces({none.mesh, none.clusters}, {none.mesh, none.clusters}).empty());
}

}  // namespace sheaf::grouping
