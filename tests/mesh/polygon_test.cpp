#include "mesh/polygon.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "tests/mesh/meshes.h"

namespace sheaf::mesh {
namespace {

double areaOf(const std::vector<Vec3>& p, const Triangle& t, const Vec3& normal) {
  return 0.5 * glm::dot(glm::cross(DVec3(p[t[1]]) - DVec3(p[t[0]]), DVec3(p[t[2]]) - DVec3(p[t[0]])), DVec3(normal));
}

// Every triangle has positive area, the areas add up, and each outline edge is an edge of exactly one triangle while
// all others come in opposite pairs. That is a tiling.
void checkTiling(const std::vector<Vec3>& p, const Vec3& normal, double area) {
  std::vector<Triangle> out;
  CHECK(triangulatePolygon(p, out));
  CHECK(out.size() == p.size() - 2);
  double sum = 0.0;
  for (const Triangle& t : out) {
    CHECK(areaOf(p, t, normal) > 0.0);
    sum += areaOf(p, t, normal);
  }
  CHECK(sum == doctest::Approx(area));
  const auto uses = [&](std::size_t a, std::size_t b) {
    return std::count_if(out.begin(), out.end(), [&](const Triangle& t) {
      for (std::size_t k = 0; k < 3; ++k)
        if (t[k] == a && t[(k + 1) % 3] == b) return true;
      return false;
    });
  };
  for (std::size_t i = 0; i < p.size(); ++i) CHECK(uses(i, (i + 1) % p.size()) == 1);
}

double signedArea(const std::vector<Vec3>& p) {
  double sum = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const DVec3 a(p[i]), b(p[(i + 1) % p.size()]);
    sum += 0.5 * (a.x * b.y - a.y * b.x);
  }
  return sum;
}

}  // namespace

TEST_CASE("mesh/polygon: convex polygons are fans around corner 0") {
  std::vector<Vec3> p;
  for (int i = 0; i < 7; ++i) p.emplace_back(std::cos(0.8 * i), std::sin(0.8 * i), 1.0);
  std::vector<Triangle> out{{9, 9, 9}};
  CHECK(triangulatePolygon(p, out));
  REQUIRE(out.size() == 6);
  for (std::uint32_t i = 1; i < 6; ++i) CHECK(out[i] == Triangle{0, i, i + 1});
  CHECK(out[0] == Triangle{9, 9, 9});
}

TEST_CASE("mesh/polygon: a concave quad is cut along the diagonal inside it") {
  const std::vector<Vec3> arrow = {{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {1, 1, 0}};
  for (std::size_t turn = 0; turn < 4; ++turn) {
    std::vector<Vec3> p = arrow;
    std::rotate(p.begin(), p.begin() + static_cast<std::ptrdiff_t>(turn), p.end());
    checkTiling(p, {0, 0, 1}, 1.0);
  }
}

TEST_CASE("mesh/polygon: stars in any plane and either winding") {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> radius(0.2, 1.0), axis(-1.0, 1.0);
  for (int round = 0; round < 40; ++round) {
    CAPTURE(round);
    const DVec3 n = glm::normalize(DVec3(axis(rng), axis(rng), axis(rng) + 0.1));
    const DVec3 s = glm::normalize(glm::cross(n, std::abs(n.x) < 0.5 ? DVec3(1, 0, 0) : DVec3(0, 1, 0)));
    const DVec3 t = glm::cross(n, s);
    std::vector<Vec3> p, flat;
    for (int i = 0; i < 60; ++i) {
      const double phi = 2.0 * kPi * i / 60, r = radius(rng);
      flat.emplace_back(r * std::cos(phi), r * std::sin(phi), 0.0);
      p.emplace_back(DVec3(10, 20, 30) + s * (r * std::cos(phi)) + t * (r * std::sin(phi)));
    }
    checkTiling(p, Vec3(n), signedArea(flat));
    std::reverse(p.begin(), p.end());
    checkTiling(p, Vec3(-n), signedArea(flat));
  }
}

TEST_CASE("mesh/polygon: corners in a row on a straight side are kept") {
  const std::vector<Vec3> p = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, {0, 2, 0}, {0, 1, 0}};
  checkTiling(p, {0, 0, 1}, 9.0);
}

TEST_CASE("mesh/polygon: a comb with deep teeth") {
  std::vector<Vec3> p = {{40, -1, 0}, {40, 10, 0}};
  for (int i = 39; i >= 1; --i) p.emplace_back(static_cast<float>(i), i % 2 ? 0.0F : 10.0F, 0.0F);
  p.emplace_back(0.0F, 10.0F, 0.0F);
  p.emplace_back(0.0F, -1.0F, 0.0F);
  checkTiling(p, {0, 0, 1}, signedArea(p));
}

TEST_CASE("mesh/polygon: a hole with a bridge to it, two corners visited twice") {
  const std::vector<Vec3> p = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0},
                               {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}};
  checkTiling(p, {0, 0, 1}, 12.0);
}

TEST_CASE("mesh/polygon: a ring of 64 places visited by 66 corners") {
  std::vector<Vec3> p;
  for (int i = 0; i <= 32; ++i)
    p.emplace_back(2.0 * std::cos(2.0 * kPi * (i % 32) / 32), 2.0 * std::sin(2.0 * kPi * (i % 32) / 32), 0.0);
  for (int i = 32; i >= 0; --i)
    p.emplace_back(std::cos(2.0 * kPi * (i % 32) / 32), std::sin(2.0 * kPi * (i % 32) / 32), 0.0);
  REQUIRE(p.size() == 66);
  checkTiling(p, {0, 0, 1}, signedArea(p));
}

TEST_CASE("mesh/polygon: repeated corners and spikes give no triangles of their own") {
  const std::vector<Vec3> p = {{0, 0, 0}, {0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {2, 5, 0}, {2, 2, 0}, {0, 2, 0}};
  std::vector<Triangle> out;
  CHECK(triangulatePolygon(p, out));
  double area = 0.0;
  for (const Triangle& t : out) {
    CHECK(areaOf(p, t, {0, 0, 1}) > 0.0);
    area += areaOf(p, t, {0, 0, 1});
  }
  CHECK(area == doctest::Approx(4.0));
}

TEST_CASE("mesh/polygon: what cannot be clipped becomes a fan and says so") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto check_fan = [](const std::vector<Vec3>& p) {
    std::vector<Triangle> out;
    CHECK_FALSE(triangulatePolygon(p, out));
    CHECK(out.size() == p.size() - 2);
    for (const Triangle& t : out)
      for (const std::uint32_t c : t) CHECK(c < p.size());
  };
  check_fan({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}});    // bow tie
  check_fan({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}});    // no area
  check_fan({{0, 0, 0}, {nan, 0, 0}, {2, 1, 0}, {3, 0, 0}});  // not finite
}

TEST_CASE("mesh/polygon: few corners") {
  std::vector<Triangle> out;
  CHECK(triangulatePolygon({}, out));
  const std::vector<Vec3> p = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  CHECK(triangulatePolygon(std::span(p).first(2), out));
  CHECK(out.empty());
  CHECK(triangulatePolygon(p, out));
  REQUIRE(out.size() == 1);
  CHECK(out[0] == Triangle{0, 1, 2});
}

TEST_CASE("mesh/polygon: thousands of corners") {
  std::vector<Vec3> p;
  for (int i = -4096; i <= 4096; ++i) p.emplace_back(static_cast<float>(i), static_cast<float>(i * i), 0.0F);
  std::vector<Triangle> out;
  CHECK(triangulatePolygon(p, out));
  CHECK(out.size() == p.size() - 2);
}

TEST_CASE("mesh/polygon: a hundred thousand corners in a tangle end as a fan") {
  std::mt19937 rng(5);
  std::uniform_real_distribution<float> coordinate(-1.0F, 1.0F);
  std::vector<Vec3> p;
  for (int i = 0; i < 100'000; ++i) p.emplace_back(coordinate(rng), coordinate(rng), 0.0F);
  std::vector<Triangle> out;
  CHECK_FALSE(triangulatePolygon(p, out));
  CHECK(out.size() <= p.size() - 2);
}

}  // namespace sheaf::mesh
