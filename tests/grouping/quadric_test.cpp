#include "grouping/quadric.h"

#include <doctest/doctest.h>

#include <numeric>

#include "grouping/open_edges.h"
#include "grouping/plane_sets.h"
#include "grouping/slabs.h"
#include "tests/grouping/shapes.h"

namespace sheaf::grouping {
namespace {

DVec3 randomVector(std::mt19937& rng) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const double x = unit(rng), y = unit(rng), z = unit(rng);
  return {x, y, z};
}

Sym3 randomQuadric(std::mt19937& rng) {
  Sym3 a;
  for (int i = 0; i < 5; ++i) a.addOuter(glm::normalize(randomVector(rng)));
  return a;
}

double errorAt(const Sym3& a, const DVec3& x) {
  return glm::dot(x, a.times(x));
}

double largestDifference(const Sym3& a, const Sym3& b) {
  return std::max({std::abs(a.xx - b.xx), std::abs(a.xy - b.xy), std::abs(a.xz - b.xz), std::abs(a.yy - b.yy),
                   std::abs(a.yz - b.yz), std::abs(a.zz - b.zz)});
}

// Two triangles over a square, both in the plane y = 0.
mesh::Mesh square() {
  mesh::Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}};
  return mesh;
}

}  // namespace

TEST_CASE("grouping/quadric: the inverse times the matrix is the identity") {
  std::mt19937 rng(0x9a01);
  for (int i = 0; i < 100; ++i) {
    const Sym3 a = randomQuadric(rng), b = inverse(a);
    const DVec3 v = randomVector(rng);
    CHECK(glm::length(b.times(a.times(v)) - v) < 1e-9);
  }
}

TEST_CASE("grouping/quadric: the eigen-decomposition composes to the matrix, in descending order") {
  std::mt19937 rng(0x9a02);
  for (int i = 0; i < 100; ++i) {
    const Sym3 a = randomQuadric(rng);
    const Eigen3 e = eigenDecomposition(a);
    CHECK(e.values[0] >= e.values[1]);
    CHECK(e.values[1] >= e.values[2]);
    CHECK(largestDifference(compose(e), a) < 1e-12);
  }
  CHECK(eigenDecomposition({}).values == DVec3(0.0));
}

TEST_CASE("grouping/quadric: the placement on a plane is on it, and no point of it has less error") {
  std::mt19937 rng(0x9a03);
  for (int i = 0; i < 200; ++i) {
    CAPTURE(i);
    const Sym3 a = randomQuadric(rng);
    const DVec3 n = glm::normalize(randomVector(rng));
    const double delta = randomVector(rng).x;
    const DVec3 reach = inverse(a).times(n);
    const DVec3 x = placeOnPlane(n, reach, delta);
    CHECK(glm::dot(n, x) == doctest::Approx(delta));
    // The gradient 2 A x has no part along the plane, and the error has its closed form.
    const DVec3 gradient = a.times(x);
    CHECK(glm::length(gradient - glm::dot(gradient, n) * n) < 1e-9 * (1.0 + glm::length(gradient)));
    CHECK(errorAt(a, x) == doctest::Approx(delta * delta / glm::dot(n, reach)));
  }
}

TEST_CASE("grouping/quadric: across an axis the placement equals the closed form by the 2x2 block") {
  std::mt19937 rng(0x9a04);
  for (int i = 0; i < 100; ++i) {
    const Sym3 a = randomQuadric(rng);
    const double delta = randomVector(rng).x;
    // Plane x = delta: minimise over y and z alone.
    const double d = a.yy * a.zz - a.yz * a.yz;
    const DVec3 expected(delta, -delta * (a.zz * a.xy - a.yz * a.xz) / d, -delta * (a.yy * a.xz - a.yz * a.xy) / d);
    const DVec3 x_axis(1.0, 0.0, 0.0);
    CHECK(glm::length(placeOnPlane(x_axis, inverse(a).times(x_axis), delta) - expected) < 1e-9);
  }
}

TEST_CASE("grouping/quadric: the placement on a line has no gradient along it") {
  std::mt19937 rng(0x9a05);
  for (int i = 0; i < 200; ++i) {
    const Sym3 a = randomQuadric(rng);
    const DVec3 from = randomVector(rng), along = randomVector(rng);
    const double t = placeOnLine(a, from, along);
    const DVec3 x = from + t * along;
    CHECK(std::abs(glm::dot(a.times(x), along)) < 1e-10);
    for (const double step : {-0.01, 0.01}) CHECK(errorAt(a, x + step * along) >= errorAt(a, x));
  }
  // A line in the null space: the nearest point.
  Sym3 flat;
  flat.addOuter({0.0, 1.0, 0.0});
  CHECK(placeOnLine(flat, {-3.0, 1.0, 0.0}, {1.0, 0.0, 0.0}) == doctest::Approx(3.0));
}

TEST_CASE("grouping/quadric: a sphere reaches as far as the distance metric") {
  const Sym3 sphere = Sym3::scaledIdentity(0.25);
  const DVec3 n = glm::normalize(DVec3(1.0, 2.0, 3.0));
  CHECK(std::sqrt(glm::dot(n, sphere.times(n))) == doctest::Approx(0.5));
  const DVec3 x = placeOnPlane(n, sphere.times(n), 0.1);
  CHECK(glm::length(x - 0.1 * n) < 1e-15);
}

TEST_CASE("grouping/quadric: open edges are those with one face") {
  const std::vector<OpenEdge> open = findOpenEdges(square());
  REQUIRE(open.size() == 4);
  for (const OpenEdge& e : open) CHECK(!((e.a == 1 && e.b == 2) || (e.a == 2 && e.b == 1)));
  std::mt19937 rng(0x9a06);
  CHECK(findOpenEdges(lumpyBall(rng, 8, 9)).empty());
  CHECK(findOpenEdges(hills(rng, 12)).size() == 44);
  // Two faces that run along an edge the same way, and three faces on one edge: not open.
  mesh::Mesh twisted = square();
  twisted.triangles[1] = {2, 1, 3};
  CHECK(findOpenEdges(twisted).size() == 4);
  mesh::Mesh fin = square();
  fin.positions.push_back({0.5F, 1.0F, 0.5F});
  fin.triangles.push_back({1, 2, 4});
  CHECK(findOpenEdges(fin).size() == 6);
}

TEST_CASE("grouping/quadric: quadrics count faces once each and hold open borders") {
  const std::vector<Sym3> a = vertexQuadrics(square(), 10.0);
  CHECK(a[0].yy == doctest::Approx(1.0));
  CHECK(a[1].yy == doctest::Approx(2.0));
  CHECK(a[0].xx == doctest::Approx(10.0));
  CHECK(a[0].zz == doctest::Approx(10.0));
  CHECK(a[3].xx == doctest::Approx(10.0));
  CHECK(std::abs(a[0].xz) < 1e-12);
}

TEST_CASE("grouping/quadric: the safe limit keeps every half-axis below half the smallest altitude") {
  std::mt19937 rng(0x9a07);
  const mesh::Mesh mesh = hills(rng, 12);
  const std::vector<Sym3> ellipsoids = vertexEllipsoids(mesh, 0.3, Limit::kSafe);
  std::vector<double> altitude(mesh.vertexCount(), 1e9);
  for (const mesh::Triangle& t : mesh.triangles) {
    const DVec3 a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
    const double longest = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
    for (const std::uint32_t v : t)
      altitude[v] = std::min(altitude[v], glm::length(glm::cross(b - a, c - a)) / longest);
  }
  for (std::size_t v = 0; v < ellipsoids.size(); ++v) {
    const DVec3 squares = eigenDecomposition(ellipsoids[v]).values;
    CHECK(std::sqrt(squares[0]) <= 0.4999001 * altitude[v]);
    CHECK(squares[2] > 0.0);
  }
}

TEST_CASE("grouping/quadric: shortcuts of the safe limit give what eigenvectors give") {
  std::mt19937 rng(0x9a08);
  // Closed; with borders, whose planes weigh a thousand times as much; flat pieces, where two eigenvalues are 0.
  for (const mesh::Mesh& mesh : {lumpyBall(rng, 12, 16, 0.03F), hills(rng, 12), lumpyBall(rng, 12, 16), square()}) {
    const std::vector<Sym3> quadrics = vertexQuadrics(mesh, kBoundaryWeight);
    const std::vector<Sym3> generous = vertexEllipsoids(mesh, 1e3, Limit::kSafe);
    for (const double eps : {1e-6, 1e-3, 0.01, 0.05, 0.2, 5.0}) {
      const std::vector<Sym3> ellipsoids = vertexEllipsoids(mesh, eps, Limit::kSafe);
      for (std::size_t v = 0; v < quadrics.size(); ++v) {
        const double r_max2 = generous[v].xx;  // far beyond the limit only the limit is left
        Eigen3 e = eigenDecomposition(quadrics[v]);
        for (int k = 0; k < 3; ++k) e.values[k] = std::min(eps * eps / e.values[k], r_max2);
        CHECK(largestDifference(compose(e), ellipsoids[v]) <= 1e-9 * r_max2);
      }
    }
  }
}

TEST_CASE("grouping/quadric: degenerate ellipsoids become small spheres with the paper's limit") {
  mesh::Mesh flat = square();
  // Interior vertex of a flat fan: all normals are equal.
  flat.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {-1, 0, 0}, {0, 0, -1}};
  flat.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 4, 3}, {0, 1, 4}};
  const Sym3 r = vertexEllipsoids(flat, 0.01, Limit::kPaper)[0];
  CHECK(r.xx == doctest::Approx(1e-6));
  CHECK(r.yy == doctest::Approx(1e-6));
  CHECK(std::abs(r.xy) < 1e-18);
}

TEST_CASE("grouping/quadric: the paper's limit holds each tested half-axis below half the edge") {
  std::mt19937 rng(0x9a09);
  const mesh::Mesh mesh = lumpyBall(rng, 20, 30, 0.01F);
  const std::vector<Sym3> ellipsoids = vertexEllipsoids(mesh, 0.2, Limit::kPaper);
  std::vector<Eigen3> eigen;
  for (const Sym3& r : ellipsoids) eigen.push_back(eigenDecomposition(r));
  for (const mesh::Triangle& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) {
      const DVec3 edge = DVec3(mesh.positions[t[(c + 1) % 3]]) - DVec3(mesh.positions[t[c]]);
      for (int k = 0; k < 3; ++k) {
        if (std::abs(glm::dot(eigen[t[c]].vectors[k], edge)) < 0.7072 * glm::length(edge)) continue;
        CHECK(std::sqrt(eigen[t[c]].values[k]) <= 0.5000001 * glm::length(edge));
      }
    }
}

TEST_CASE("grouping/quadric: faces without area") {
  mesh::Mesh mesh = square();
  mesh.positions.push_back({0.5F, 0.0F, 0.0F});
  mesh.positions.push_back({9.0F, 9.0F, 9.0F});
  mesh.triangles.push_back({0, 4, 1});  // on the edge of the square
  const std::vector<Sym3> safe = vertexEllipsoids(mesh, 0.01, Limit::kSafe);
  CHECK(safe[4] == Sym3{});                      // must not move
  CHECK(safe[5] == Sym3::scaledIdentity(1e-4));  // no face: the distance metric
  const std::vector<Sym3> paper = vertexEllipsoids(mesh, 0.01, Limit::kPaper);
  for (const Sym3& r : paper) CHECK(r.determinant() > 0.0);
}

TEST_CASE("grouping/quadric: a slab is as wide as the ellipsoid, across any plane") {
  std::mt19937 rng(0x9a0a);
  const std::vector<PlaneFrame> planes = axisAndDodecahedronPlanes();
  const std::uint32_t in_use[] = {0};
  const Vec3 at_origin[] = {Vec3(0.0F)};
  for (int i = 0; i < 50; ++i) {
    CAPTURE(i);
    const Sym3 a = randomQuadric(rng);
    const double eps = 0.01 + 0.1 * std::abs(randomVector(rng).x);
    const Eigen3 e = eigenDecomposition(a);
    const Sym3 reach[] = {compose({eps * eps / e.values, e.vectors})};
    const Slabs slabs = makeSlabs(at_origin, in_use, planes, eps, reach);
    for (std::uint32_t axis = 0; axis < planes.size(); ++axis) {
      const DVec3 n(planes[axis].normal);
      const double half = slabs.halfOf(0, axis);
      // The farthest point is on the ellipsoid, and no point of it is farther.
      const DVec3 farthest = placeOnPlane(n, reach[0].times(n), half);
      CHECK(errorAt(a, farthest) == doctest::Approx(eps * eps).epsilon(1e-5));
      for (int k = 0; k < 40; ++k) {
        const DVec3 on_sphere = glm::normalize(randomVector(rng));
        DVec3 x(0.0);
        for (int c = 0; c < 3; ++c) x += eps / std::sqrt(e.values[c]) * on_sphere[c] * e.vectors[c];
        CHECK(std::abs(glm::dot(n, x)) <= half * (1.0 + 1e-6));
      }
    }
  }
}

TEST_CASE("grouping/quadric: spheres of radius epsilon make the slabs and the table of the distance metric") {
  std::mt19937 rng(0x9a0b);
  const mesh::Mesh mesh = randomPoints(rng, 300);
  std::vector<std::uint32_t> in_use(mesh.vertexCount());
  std::iota(in_use.begin(), in_use.end(), 0U);
  for (const double eps : {0.0, 0.003, 0.05}) {
    const std::vector<Sym3> spheres(mesh.vertexCount(), Sym3::scaledIdentity(eps * eps));
    const Slabs distance = makeSlabs(mesh.positions, in_use, axisPlanes(), eps, {});
    const Slabs quadric = makeSlabs(mesh.positions, in_use, axisPlanes(), eps, spheres);
    for (const float half : quadric.half) CHECK(half == distance.common_half);
    CHECK(unionKeys(quadric) == unionKeys(distance));
    CHECK(sumKeys(quadric) == sumKeys(distance));
  }
}

TEST_CASE("grouping/quadric: a border's heavy planes do not make its vertices degenerate") {
  std::mt19937 rng(0x9a0c);
  mesh::Mesh mesh = hills(rng, 12);  // and with straight borders
  for (Vec3& p : mesh.positions) p = Vec3(std::floor(12.0F * p.x), 12.0F * p.y, std::floor(12.0F * p.z));
  const std::vector<Sym3> light = vertexQuadrics(mesh, 1.0), heavy = vertexQuadrics(mesh, kBoundaryWeight);
  const double eps = 1e-5;  // far below any edge, so that the limit changes nothing
  const std::vector<Sym3> ellipsoids = vertexEllipsoids(mesh, eps, Limit::kPaper);
  int misleading = 0;
  for (const OpenEdge& edge : findOpenEdges(mesh)) {
    const DVec3 sound = eigenDecomposition(light[edge.a]).values, seen = eigenDecomposition(heavy[edge.a]).values;
    REQUIRE(sound[2] > kDegenerateRatio * sound[0]);
    misleading += seen[2] <= kDegenerateRatio * seen[0];
    Eigen3 expected = eigenDecomposition(heavy[edge.a]);
    expected.values = eps * eps / expected.values;
    CHECK(largestDifference(ellipsoids[edge.a], compose(expected)) <= 1e-9 * eps * eps / seen[2]);
  }
  CHECK(misleading > 0);  // by the weighted planes they would have been
}

}  // namespace sheaf::grouping
