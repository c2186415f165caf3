#include "mesh/simplify.h"

#include <doctest/doctest.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "mesh/distance.h"
#include "mesh/normals.h"
#include "mesh/weld.h"
#include "tests/mesh/meshes.h"

namespace sheaf::mesh {
namespace {

SimplifyOptions toTriangles(std::size_t count, bool attributes = false) {
  SimplifyOptions o;
  o.target_triangles = count;
  o.attributes = attributes;
  return o;
}

struct Topology {
  std::ptrdiff_t euler = 0;
  std::size_t border_edges = 0;
  std::size_t branching_edges = 0;  // three or more triangles
};

// Of the positions: vertices at one place count once.
Topology topologyOf(const Mesh& mesh) {
  Mesh m;
  m.positions = mesh.positions;
  m.triangles = mesh.triangles;
  weldVertices(m);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::set<std::uint32_t> vertices;
  for (const Triangle& t : m.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      vertices.insert(t[k]);
      ++edges[std::minmax(t[k], t[(k + 1) % 3])];
    }
  Topology out;
  out.euler = static_cast<std::ptrdiff_t>(vertices.size()) - static_cast<std::ptrdiff_t>(edges.size()) +
              static_cast<std::ptrdiff_t>(m.triangleCount());
  for (const auto& [edge, count] : edges) {
    if (count == 1) ++out.border_edges;
    if (count > 2) ++out.branching_edges;
  }
  return out;
}

// What holds for every result, whatever the input.
void checkResult(const SimplifyResult& r, const Mesh& input) {
  const Mesh& m = r.mesh;
  std::vector<std::uint8_t> used(m.vertexCount(), 0);
  std::set<Triangle> seen;
  for (Triangle t : m.triangles) {
    for (const std::uint32_t v : t) {
      REQUIRE(v < m.vertexCount());
      used[v] = 1;
    }
    CHECK(m.positions[t[0]] != m.positions[t[1]]);
    CHECK(m.positions[t[1]] != m.positions[t[2]]);
    CHECK(m.positions[t[2]] != m.positions[t[0]]);
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    CHECK(seen.insert(t).second);
  }
  CHECK(std::count(used.begin(), used.end(), 0) == 0);
  for (const Vec3& p : m.positions) CHECK(isFinite(p));
  CHECK(m.triangleCount() + r.dropped_triangles <= input.triangleCount());
  assertValid(m);
}

SimplifyResult checkedSimplify(const Mesh& m, const SimplifyOptions& options) {
  SimplifyResult r = simplify(m, options);
  checkResult(r, m);
  return r;
}

Mesh makeTorus(std::uint32_t rings, std::uint32_t segments) {
  Mesh m;
  for (std::uint32_t r = 0; r < rings; ++r)
    for (std::uint32_t s = 0; s < segments; ++s) {
      const double a = 2.0 * kPi * r / rings, b = 2.0 * kPi * s / segments, radius = 1.0 + 0.3 * std::cos(b);
      m.positions.emplace_back(radius * std::cos(a), radius * std::sin(a), 0.3 * std::sin(b));
      const auto at = [&](std::uint32_t i, std::uint32_t k) { return i % rings * segments + k % segments; };
      m.triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
      m.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    }
  return m;
}

Mesh makeBumpySphere() {
  Mesh m = makeSphere(60, 90);
  for (Vec3& p : m.positions) p *= 1.0F + 0.06F * std::sin(9.0F * p.x) * std::sin(8.0F * p.y) * std::cos(7.0F * p.z);
  return m;
}

double areaOf(const Mesh& m) {
  double sum = 0.0;
  for (const Triangle& t : m.triangles) {
    const DVec3 p0(m.positions[t[0]]);
    sum += 0.5 * glm::length(glm::cross(DVec3(m.positions[t[1]]) - p0, DVec3(m.positions[t[2]]) - p0));
  }
  return sum;
}

}  // namespace

TEST_CASE("mesh/simplify: a closed surface keeps its Euler characteristic at every size") {
  const Mesh sphere = makeSphere(30, 40), torus = makeTorus(40, 20);
  for (const std::size_t target : {2000U, 500U, 100U, 20U, 1U}) {
    CAPTURE(target);
    const SimplifyResult a = checkedSimplify(sphere, toTriangles(target)),
                         b = checkedSimplify(torus, toTriangles(target));
    CHECK(topologyOf(a.mesh).euler == 2);
    CHECK(topologyOf(b.mesh).euler == 0);
    for (const SimplifyResult* r : {&a, &b}) {
      CHECK(topologyOf(r->mesh).border_edges == 0);
      CHECK(topologyOf(r->mesh).branching_edges == 0);
      CHECK((r->stop == SimplifyStop::kTargetReached) == (r->mesh.triangleCount() <= target));
      CHECK(r->positions == r->mesh.vertexCount());
    }
  }
  CHECK(simplify(sphere, toTriangles(1)).stop == SimplifyStop::kTopology);
}

TEST_CASE("mesh/simplify: the target is met and hardly overshot") {
  const Mesh m = makeBumpySphere();
  for (const std::size_t target : {9000U, 5001U, 300U}) {
    const SimplifyResult r = checkedSimplify(m, toTriangles(target));
    CHECK(r.stop == SimplifyStop::kTargetReached);
    CHECK(r.mesh.triangleCount() <= target);
    CHECK(r.mesh.triangleCount() + 2 > target);
    SimplifyOptions by_vertices;
    by_vertices.target_vertices = target / 3;
    CHECK(checkedSimplify(m, by_vertices).mesh.vertexCount() == target / 3);
  }
}

TEST_CASE("mesh/simplify: a target above the size changes nothing") {
  const Mesh m = makeBumpySphere();
  const SimplifyResult r = checkedSimplify(m, toTriangles(m.triangleCount()));
  CHECK(r.mesh.positions == m.positions);
  CHECK(r.mesh.triangles == m.triangles);
}

TEST_CASE("mesh/simplify: a flat square loses no area, bends nowhere and keeps its corners") {
  const Mesh m = makeGrid(30);
  const SimplifyResult r = checkedSimplify(m, toTriangles(10));
  CHECK(r.stop == SimplifyStop::kTargetReached);
  double area = 0.0;
  for (const Triangle& t : r.mesh.triangles) {
    const Vec3 n =
        glm::cross(r.mesh.positions[t[1]] - r.mesh.positions[t[0]], r.mesh.positions[t[2]] - r.mesh.positions[t[0]]);
    CHECK(n.z > 0.0F);
    area += 0.5 * static_cast<double>(n.z);
  }
  CHECK(area == doctest::Approx(1.0).epsilon(1e-5));
  for (const Vec3& p : r.mesh.positions) CHECK(std::abs(p.z) < 1e-7F);
  TaskPool pool(2);
  CHECK(distanceBetween(m, r.mesh, 1000, pool).hausdorff() < 1e-6);
}

TEST_CASE("mesh/simplify: holes stay, with their outline") {
  Mesh m = makeGrid(24);
  std::erase_if(m.triangles, [&](const Triangle& t) {
    const Vec3 c = (m.positions[t[0]] + m.positions[t[1]] + m.positions[t[2]]) / 3.0F;
    return c.x > 0.25F && c.x < 0.5F && c.y > 0.25F && c.y < 0.75F;
  });
  const double area = areaOf(m);
  const SimplifyResult r = checkedSimplify(m, toTriangles(16));
  CHECK(topologyOf(r.mesh).euler == 0);
  CHECK(areaOf(r.mesh) == doctest::Approx(area).epsilon(1e-4));
}

TEST_CASE("mesh/simplify: the rim of a thin sheet does not shrink") {
  // A lens, 2 wide and 0.004 thick.
  Mesh m = makeSphere(40, 60);
  for (Vec3& p : m.positions) p.y *= 0.002F;
  const SimplifyResult r = checkedSimplify(m, toTriangles(300));
  TaskPool pool(2);
  CHECK(distanceBetween(m, r.mesh, 20'000, pool).hausdorff() < 0.02);
}

TEST_CASE("mesh/simplify: a thin strip at a border is not drawn in") {
  // Hills, and a needle as long as an edge and a thousandth as wide that hangs at their border in four pieces.
  Mesh m = makeGrid(40);
  for (Vec3& p : m.positions) p.z += 0.05F * std::sin(9.0F * p.x) * std::cos(7.0F * p.y);
  const std::uint32_t root = 0, other = 1;
  const DVec3 a(m.positions[root]), along = a - DVec3(m.positions[41 + 1]);
  const DVec3 across = 0.001 * (DVec3(m.positions[other]) - a);
  std::uint32_t left = root, right = static_cast<std::uint32_t>(m.vertexCount());
  m.positions.emplace_back(a + across);
  m.triangles.push_back({root, right, other});
  for (int k = 1; k <= 4; ++k) {
    const auto next = static_cast<std::uint32_t>(m.vertexCount());
    m.positions.emplace_back(a + 0.25 * k * along);
    m.positions.emplace_back(a + 0.25 * k * along + across);
    m.triangles.push_back({left, next, right});
    m.triangles.push_back({right, next, next + 1});
    left = next, right = next + 1;
  }
  const double edge = glm::length(along);
  TaskPool pool(2);
  const SimplifyResult r = checkedSimplify(m, toTriangles(m.triangleCount() / 8));
  CHECK(distanceToSurface(m, r.mesh, 20'000, pool).max / edge < 0.4);
}

TEST_CASE("mesh/simplify: no triangle is turned over") {
  const Mesh m = makeBumpySphere();  // seen from its centre all triangles are turned away
  for (const std::size_t target : {3000U, 600U, 150U}) {
    const SimplifyResult r = checkedSimplify(m, toTriangles(target));
    for (const Triangle& t : r.mesh.triangles) {
      const Vec3 &a = r.mesh.positions[t[0]], &b = r.mesh.positions[t[1]], &c = r.mesh.positions[t[2]];
      CHECK(glm::dot(glm::cross(b - a, c - a), a + b + c) > 0.0F);
    }
  }
}

TEST_CASE("mesh/simplify: the error grows as triangles go, and stays below meshoptimizer's") {
  const Mesh m = makeBumpySphere();
  TaskPool pool(2);
  double before = 0.0;
  for (const std::size_t target : {5000U, 2000U, 800U, 300U}) {
    CAPTURE(target);
    const SimplifyResult r = checkedSimplify(m, toTriangles(target));
    const SurfaceDistance ours = distanceBetween(m, r.mesh, 20'000, pool);
    CHECK(ours.rms() > before);
    before = ours.rms();
    Mesh peer = m;
    const std::size_t indices =
        meshopt_simplify(&peer.triangles[0][0], &m.triangles[0][0], 3 * m.triangleCount(), &m.positions[0].x,
                         m.vertexCount(), sizeof(Vec3), 3 * r.mesh.triangleCount(), 1.0F, 0, nullptr);
    peer.triangles.resize(indices / 3);
    const SurfaceDistance theirs = distanceBetween(m, peer, 20'000, pool);
    CHECK(ours.rms() <= theirs.rms());
    CHECK(ours.hausdorff() <= theirs.hausdorff());
  }
}

TEST_CASE("mesh/simplify: vertices at one place are one") {
  const Mesh sphere = makeSphere(20, 30);
  Mesh soup = sphere;
  makeFlatNormals(soup);
  const SimplifyResult a = checkedSimplify(sphere, toTriangles(200)), b = checkedSimplify(soup, toTriangles(200));
  CHECK(b.mesh.normals.empty());
  CHECK(b.mesh.vertexCount() == a.mesh.vertexCount());
  CHECK(topologyOf(b.mesh).euler == 2);
}

TEST_CASE("mesh/simplify: the same input gives the same output") {
  const Mesh m = makeGrid(40);  // every cost is equal
  const SimplifyResult a = simplify(m, toTriangles(100)), b = simplify(m, toTriangles(100));
  CHECK(a.mesh.positions == b.mesh.positions);
  CHECK(a.mesh.triangles == b.mesh.triangles);
}

TEST_CASE("mesh/simplify: small and degenerate meshes") {
  CHECK(checkedSimplify(Mesh{}, toTriangles(1)).mesh.triangles.empty());

  Mesh one;
  one.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}};
  one.triangles = {{0, 1, 2}};
  SimplifyOptions to_one_vertex;
  to_one_vertex.target_vertices = 1;
  const SimplifyResult kept = checkedSimplify(one, to_one_vertex);
  CHECK(kept.mesh.triangleCount() == 1);
  CHECK(kept.mesh.vertexCount() == 3);
  CHECK(kept.stop == SimplifyStop::kTopology);

  Mesh tetrahedron;
  tetrahedron.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  CHECK(checkedSimplify(tetrahedron, toTriangles(1)).mesh.triangleCount() == 4);

  Mesh point;
  point.positions.assign(9, Vec3(2.0F));
  point.triangles = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
  const SimplifyResult nothing = checkedSimplify(point, toTriangles(1));
  CHECK(nothing.mesh.triangles.empty());
  CHECK(nothing.dropped_triangles == 3);

  Mesh line;
  for (std::uint32_t i = 0; i < 50; ++i) line.positions.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
  for (std::uint32_t i = 0; i + 2 < 50; ++i) line.triangles.push_back({i, i + 1, i + 2});
  checkedSimplify(line, toTriangles(3));
}

TEST_CASE("mesh/simplify: what cannot be used is dropped and counted") {
  Mesh m = makeGrid(10);
  const std::size_t sound = m.triangleCount();
  m.positions.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);
  m.positions.push_back(m.positions[0]);
  const auto n = static_cast<std::uint32_t>(m.vertexCount());
  m.triangles.push_back({0, 1, n - 2});                                              // NaN
  m.triangles.push_back({5, 5, 6});                                                  // a vertex twice
  m.triangles.push_back({0, n - 1, 5});                                              // a position twice
  m.triangles.push_back({m.triangles[7][1], m.triangles[7][2], m.triangles[7][0]});  // repeats another
  const SimplifyResult r = checkedSimplify(m, toTriangles(sound));
  CHECK(r.dropped_triangles == 4);
  CHECK(r.mesh.triangleCount() == sound);
  checkedSimplify(m, toTriangles(20));
}

TEST_CASE("mesh/simplify: three sheets on one edge stay joined") {
  Mesh m;
  const Mesh sheet = makeGrid(8);
  for (int i = 0; i < 3; ++i) {
    const double phi = 2.0 * kPi * i / 3;
    const auto first = static_cast<std::uint32_t>(m.vertexCount());
    for (const Vec3& p : sheet.positions)
      m.positions.emplace_back(p.x * static_cast<float>(std::cos(phi)), p.y, p.x * static_cast<float>(std::sin(phi)));
    for (const Triangle& t : sheet.triangles) m.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  const Topology before = topologyOf(m);
  CHECK(before.branching_edges == 8);
  const SimplifyResult r = checkedSimplify(m, toTriangles(30));
  CHECK(r.stop == SimplifyStop::kTargetReached);
  CHECK(topologyOf(r.mesh).euler == before.euler);
  CHECK(topologyOf(r.mesh).branching_edges >= 1);
  CHECK(areaOf(r.mesh) == doctest::Approx(3.0).epsilon(1e-3));
}

TEST_CASE("mesh/simplify: two spheres that touch in one vertex") {
  Mesh m = makeSphere(16, 24);
  const auto n = static_cast<std::uint32_t>(m.vertexCount());
  const std::size_t faces = m.triangleCount();
  for (std::uint32_t v = 0; v < n; ++v) m.positions.push_back(m.positions[v] + Vec3(0.0F, 2.0F, 0.0F));
  m.positions[2 * n - 1] = m.positions[0];
  for (std::size_t f = 0; f < faces; ++f) {
    const Triangle t = m.triangles[f];
    m.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  }
  CHECK(topologyOf(m).euler == 3);
  CHECK(topologyOf(checkedSimplify(m, toTriangles(100)).mesh).euler == 3);
}

TEST_CASE("mesh/simplify: random triangles come out sound") {
  std::mt19937 rng(21);
  std::uniform_real_distribution<float> coordinate(-1.0F, 1.0F);
  std::uniform_int_distribution<std::uint32_t> index(0, 59);
  for (const float extent : {1.0F, 1e-30F, 1e37F}) {
    Mesh m;
    for (int i = 0; i < 60; ++i) {
      const float x = coordinate(rng), y = coordinate(rng), z = coordinate(rng);
      m.positions.push_back(extent * Vec3(x, y, z));
      m.normals.emplace_back(0.0F, 1.0F, 0.0F);
    }
    for (int i = 0; i < 600; ++i) {
      const std::uint32_t a = index(rng), b = index(rng), c = index(rng);
      m.triangles.push_back({a, b, c});
    }
    checkedSimplify(m, toTriangles(50));
    checkedSimplify(m, toTriangles(50, true));
  }
}

TEST_CASE("mesh/simplify: attributes that run evenly over a plane are carried over exactly") {
  Mesh m = makeGrid(20);
  for (const Vec3& p : m.positions) {
    m.normals.emplace_back(0.0F, 0.0F, 1.0F);
    m.texcoords.emplace_back(2.0F * p.x + p.y, 3.0F - p.y);
    m.colors.emplace_back(p.x, p.y, 0.25F, 1.0F);
  }
  const SimplifyResult r = checkedSimplify(m, toTriangles(12, true));
  CHECK(r.stop == SimplifyStop::kTargetReached);
  REQUIRE(r.mesh.colors.size() == r.mesh.vertexCount());
  for (std::size_t v = 0; v < r.mesh.vertexCount(); ++v) {
    const Vec3 p = r.mesh.positions[v];
    CHECK(glm::length(r.mesh.normals[v] - Vec3(0.0F, 0.0F, 1.0F)) < 1e-5F);
    CHECK(glm::length(r.mesh.texcoords[v] - Vec2(2.0F * p.x + p.y, 3.0F - p.y)) < 1e-5F);
    CHECK(glm::length(r.mesh.colors[v] - Vec4(p.x, p.y, 0.25F, 1.0F)) < 1e-5F);
  }
}

TEST_CASE("mesh/simplify: detail in the colours holds triangles where the shape needs none") {
  Mesh m = makeGrid(40);
  for (const Vec3& p : m.positions) {
    const float r = std::hypot(p.x - 0.25F, p.y - 0.25F);
    m.colors.emplace_back(Vec3(std::clamp(4.0F * (0.2F - r), 0.0F, 1.0F)), 1.0F);
  }
  const SimplifyResult r = checkedSimplify(m, toTriangles(200, true));
  const auto near = std::count_if(r.mesh.positions.begin(), r.mesh.positions.end(),
                                  [](const Vec3& p) { return p.x < 0.5F && p.y < 0.5F; });
  CHECK(4 * near > 3 * static_cast<std::ptrdiff_t>(r.mesh.vertexCount()));
  for (const Vec4& c : r.mesh.colors) CHECK((c.x >= 0.0F && c.x <= 0.8F));
}

TEST_CASE("mesh/simplify: a seam keeps its place and its two sides") {
  // Left half red, right half blue; along x = 0.5 each position is a vertex of either colour.
  const std::uint32_t n = 16;
  Mesh m = makeGrid(n);
  const Vec4 red(1.0F, 0.0F, 0.0F, 1.0F), blue(0.0F, 0.0F, 1.0F, 1.0F);
  for (const Vec3& p : m.positions) m.colors.push_back(p.x <= 0.5F ? red : blue);
  std::map<std::uint32_t, std::uint32_t> twin;
  for (Triangle& t : m.triangles) {
    const bool right = m.positions[t[0]].x + m.positions[t[1]].x + m.positions[t[2]].x > 1.5F;
    for (std::uint32_t& v : t) {
      if (!right || m.positions[v].x != 0.5F) continue;
      const auto [it, is_new] = twin.try_emplace(v, static_cast<std::uint32_t>(m.vertexCount()));
      if (is_new) {
        m.positions.push_back(m.positions[v]);
        m.colors.push_back(blue);
      }
      v = it->second;
    }
  }
  const SimplifyResult r = checkedSimplify(m, toTriangles(8, true));
  CHECK(r.stop == SimplifyStop::kTargetReached);
  CHECK(r.positions < r.mesh.vertexCount());
  CHECK(topologyOf(r.mesh).euler == 1);
  double area[2] = {0.0, 0.0};
  for (const Triangle& t : r.mesh.triangles) {
    const bool is_blue = r.mesh.colors[t[0]].z > 0.5F;
    for (const std::uint32_t v : t) {
      CHECK(glm::length(r.mesh.colors[v] - (is_blue ? blue : red)) < 1e-4F);
      CHECK((is_blue ? r.mesh.positions[v].x > 0.4999F : r.mesh.positions[v].x < 0.5001F));
    }
    const Vec3 cross =
        glm::cross(r.mesh.positions[t[1]] - r.mesh.positions[t[0]], r.mesh.positions[t[2]] - r.mesh.positions[t[0]]);
    area[is_blue ? 1 : 0] += 0.5 * static_cast<double>(cross.z);
  }
  CHECK(area[0] == doctest::Approx(0.5).epsilon(1e-3));
  CHECK(area[1] == doctest::Approx(0.5).epsilon(1e-3));
}

TEST_CASE("mesh/simplify: normals stay unit and near the surface's") {
  Mesh m = makeSphere(40, 60);
  makeSmoothNormals(m, kPi);
  const SimplifyResult r = checkedSimplify(m, toTriangles(400, true));
  for (std::size_t v = 0; v < r.mesh.vertexCount(); ++v) {
    CHECK(glm::length(r.mesh.normals[v]) == doctest::Approx(1.0));
    CHECK(glm::dot(r.mesh.normals[v], glm::normalize(r.mesh.positions[v])) > 0.99F);
  }
}

TEST_CASE("mesh/simplify: a cone whose tip is a vertex per side") {
  Mesh m = makeFan(400);
  makeSmoothNormals(m, 0.0);
  CHECK(m.vertexCount() > 800);
  const SimplifyResult r = checkedSimplify(m, toTriangles(50, true));
  CHECK(topologyOf(r.mesh).euler == 1);
  for (const Vec3& n : r.mesh.normals) CHECK(glm::length(n) == doctest::Approx(1.0));
}

}  // namespace sheaf::mesh
