#include "grouping/cluster_cost.h"

#include <doctest/doctest.h>

#include <limits>

#include "tests/grouping/cluster_checks.h"
#include "tests/grouping/shapes.h"

namespace sheaf::grouping {
namespace {

ClusterMoments momentsOf(const mesh::Mesh& mesh, const Faces& faces, const ModelFrame& frame) {
  ClusterMoments sum;
  for (const std::uint32_t f : faces) {
    const mesh::Triangle& t = mesh.triangles[f];
    const ClusterMoments m =
        momentsOfFace(frame(mesh.positions[t[0]]), frame(mesh.positions[t[1]]), frame(mesh.positions[t[2]]), 0.0);
    sum = joined(sum, m, 0.0);
  }
  return sum;
}

Faces randomFaces(std::mt19937& rng, const mesh::Mesh& mesh, std::size_t count) {
  Faces faces;
  for (std::size_t i = 0; i < count; ++i) faces.push_back(static_cast<std::uint32_t>(rng() % mesh.triangleCount()));
  return faces;
}

Eigen::Matrix3d matrixOf(const Symmetric3& m) {
  Eigen::Matrix3d a;
  a << m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz;
  return a;
}

Eigen::Vector3d eigenvaluesOf(const Symmetric3& m) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>().compute(matrixOf(m)).eigenvalues();
}

DVec3 randomVector(std::mt19937& rng) {
  std::normal_distribution<double> normal;
  const double x = normal(rng), y = normal(rng), z = normal(rng);
  return {x, y, z};
}

// With the given eigenvalues, in random directions.
Symmetric3 matrixWith(std::mt19937& rng, const std::array<double, 3>& eigenvalues) {
  const DVec3 a = glm::normalize(randomVector(rng)), b = glm::normalize(glm::cross(a, randomVector(rng)));
  return Symmetric3::square(a, eigenvalues[0]) + Symmetric3::square(b, eigenvalues[1]) +
         Symmetric3::square(glm::cross(a, b), eigenvalues[2]);
}

}  // namespace

TEST_CASE("grouping/cluster_cost: the closed form of the least eigenvalue equals Eigen's within its bounds") {
  std::mt19937 rng(0xe16e);
  std::uniform_real_distribution<double> exponent(-12.0, 0.0);
  for (int i = 0; i < 20000; ++i) {
    CAPTURE(i);
    std::array<double, 3> values{};
    for (double& v : values) v = std::pow(10.0, exponent(rng));
    if (i % 7 == 0) values[1] = values[0];
    if (i % 11 == 0) values[2] = values[1];
    if (i % 5 == 0) values[0] = 0.0;
    const double size = std::pow(10.0, 3.0 * exponent(rng));
    Symmetric3 m = matrixWith(rng, {size * values[0], size * values[1], size * values[2]});
    const double trace = m.xx + m.yy + m.zz;
    const Eigen::Vector3d expected = eigenvaluesOf(m);
    const double error = std::abs(leastEigenvalue(m) - expected[0]);
    CHECK(error <= 4e-8 * trace);
    if (expected[1] - expected[0] >= 0.01 * trace) CHECK(error <= 1e-14 * trace);
  }
  CHECK(leastEigenvalue({}) == 0.0);
  CHECK(leastEigenvalue({.xx = 2.0, .yy = 2.0, .zz = 2.0}) == 2.0);
  CHECK(leastEigenvalue({.xx = 3.0, .yy = 0.0, .zz = 5.0}) < 1e-15);
  CHECK(leastEigenvalue({.xx = 1.0, .xy = 1.0, .xz = 1.0, .yy = 1.0, .yz = 1.0, .zz = 1.0}) <= 4e-8);
}

TEST_CASE("grouping/cluster_cost: moments of many faces equal the sums taken directly, far from the origin too") {
  std::mt19937 rng(0xc057);
  const mesh::Mesh mesh = lumpyBall(rng, 20, 30, 0.02F);
  for (const DVec3& center : {DVec3(0.0), DVec3(1e6, -3e6, 2e6)})
    for (const std::size_t count : {1U, 2U, 7U, 300U}) {
      const ModelFrame frame{center, 1.0};
      const Faces faces = randomFaces(rng, mesh, count);
      const ClusterMoments m = momentsOf(mesh, faces, frame);
      const PlainFigures expected = plainFigures(mesh, faces, frame);
      CHECK(m.corners == expected.corners);
      CHECK(glm::distance(m.mean, expected.mean) < 1e-8);
      CHECK(m.area == doctest::Approx(expected.area).epsilon(1e-7));
      CHECK(glm::distance(m.area_vector, expected.area_vector) < 1e-7);
      CHECK(std::abs(fitError(m) - expected.fit) < 1e-8);
      CHECK(std::abs(directionError(m) - expected.direction) < 1e-7);
    }
}

TEST_CASE("grouping/cluster_cost: the cost of joining is that of what they make, the same from both sides") {
  std::mt19937 rng(0x5a3e);
  const mesh::Mesh mesh = lumpyBall(rng, 20, 30, 0.02F);
  std::uniform_real_distribution<double> unit(0.1, 1.0);
  for (int i = 0; i < 500; ++i) {
    ClusterMoments a = momentsOf(mesh, randomFaces(rng, mesh, 1 + rng() % 9), {});
    ClusterMoments b = momentsOf(mesh, randomFaces(rng, mesh, 1 + rng() % 9), {});
    a.perimeter = unit(rng);
    b.perimeter = unit(rng);
    const double border = 0.4 * std::min(a.perimeter, b.perimeter);
    const ClusterMoments both = joined(a, b, border);
    CHECK(joinCost(a, b, border, {1.0, 0.0, 0.0, 0.0}) == doctest::Approx(fitError(both)));
    CHECK(joinCost(a, b, border, {0.0, 1.0, 0.0, 0.0}) == doctest::Approx(directionError(both)));
    const double gamma = irregularity(both), before = std::max(irregularity(a), irregularity(b));
    CHECK(joinCost(a, b, border, {0.0, 0.0, 1.0, 0.0}) ==
          doctest::Approx(std::clamp((gamma - before) / gamma, -1.0, 1.0)));
    CHECK(joinCost(a, b, border, {}) == joinCost(b, a, border, {}));
    CHECK(joinCost(a, b, border, {0.0, 0.0, 0.0, 1.0}) == doctest::Approx(std::log2(both.corners)).epsilon(0.09));
  }
}

TEST_CASE("grouping/cluster_cost: errors never fall below 0, and the parts fit no worse than the whole") {
  std::mt19937 rng(0x1ea5);
  const mesh::Mesh mesh = triangleSoup(rng, 100, 200);
  for (int i = 0; i < 500; ++i) {
    const ClusterMoments a = momentsOf(mesh, randomFaces(rng, mesh, 1 + rng() % 5), {});
    const ClusterMoments b = momentsOf(mesh, randomFaces(rng, mesh, 1 + rng() % 5), {});
    const ClusterMoments both = joined(a, b, 0.0);
    CHECK(fitError(both) >= 0.0);
    CHECK(directionError(both) >= 0.0);
    CHECK(directionError(both) <= 4.0);
    CHECK(fitError(both) * both.corners >= fitError(a) * a.corners + fitError(b) * b.corners - 1e-7);
    CHECK(glm::length(both.area_vector) <= both.area * (1.0 + 1e-12));
  }
}

TEST_CASE("grouping/cluster_cost: what has no area, no border or no direction costs a finite amount") {
  const DVec3 o(0.0), x(1.0, 0.0, 0.0), y(0.0, 1.0, 0.0);
  const ClusterMoments front = momentsOfFace(o, x, y, 2.0 + std::sqrt(2.0)),
                       back = momentsOfFace(o, y, x, front.perimeter);
  const ClusterMoments point = momentsOfFace(o, o, o, 0.0), needle = momentsOfFace(o, x, 2.0 * x, 4.0);
  const ClusterMoments nothing;
  for (const ClusterMoments* a : {&front, &back, &point, &needle, &nothing})
    for (const ClusterMoments* b : {&front, &back, &point, &needle, &nothing})
      for (const double border : {0.0, 1.0, 5.0}) CHECK(std::isfinite(joinCost(*a, *b, border, {})));
  // Front and back of a leaf: closed, so that no shape is lost; both normals are at right angles to none.
  CHECK(joinCost(front, back, front.perimeter, {0.0, 0.0, 1.0, 0.0}) == 0.0);
  CHECK(joinCost(front, back, front.perimeter, {0.0, 1.0, 0.0, 0.0}) == doctest::Approx(2.0));  // of 0 and 4
  CHECK(joinCost(front, needle, 0.0, {0.0, 0.0, 1.0, 0.0}) == -1.0);
}

TEST_CASE("grouping/cluster_cost: two halves of a hemisphere become rounder, two squares in a row less round") {
  const DVec3 o(0.0);
  ClusterMoments square;
  square.corners = 6.0;
  square.area = 1.0;
  square.area_vector = DVec3(0.0, 0.0, 1.0);
  square.perimeter = 4.0;
  // 6^2 / 2 against 4^2 / 1
  CHECK(joinCost(square, square, 1.0, {0.0, 0.0, 1.0, 0.0}) == doctest::Approx((18.0 - 16.0) / 18.0));
  CHECK(irregularity(square) == doctest::Approx(4.0 / kPi));
  ClusterMoments half = square;
  half.area = kPi;  // of the unit sphere's quarter: its border is one half-circle on the ground and one over the top
  half.perimeter = 2.0 * kPi;
  CHECK(irregularity(joined(half, half, kPi)) == doctest::Approx(0.5));
  CHECK(joinCost(half, half, kPi, {0.0, 0.0, 1.0, 0.0}) == -1.0);  // (0.5 - 1) / 0.5
}

}  // namespace sheaf::grouping
