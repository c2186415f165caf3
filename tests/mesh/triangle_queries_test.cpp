#include "mesh/triangle_queries.h"

#include <doctest/doctest.h>

#include <random>

namespace sheaf::mesh {
namespace {

DVec3 randomPoint(std::mt19937& rng) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const double x = unit(rng), y = unit(rng), z = unit(rng);
  return {x, y, z};
}

Corners randomTriangle(std::mt19937& rng) {
  const DVec3 a = randomPoint(rng), b = randomPoint(rng), c = randomPoint(rng);
  return {a, b, c};
}

// The segment from p to q meets the triangle.
bool pierces(const DVec3& p, const DVec3& q, const Corners& t) {
  const auto at = meetLine(t, p, q - p);
  return at && *at >= 0.0 && *at <= 1.0;
}

}  // namespace

TEST_CASE("mesh/triangle_queries: a line meets a triangle where it should, from both sides and behind its origin") {
  const Corners t = {DVec3(0.0, 0.0, 2.0), DVec3(4.0, 0.0, 2.0), DVec3(0.0, 4.0, 2.0)};
  CHECK(meetLine(t, {1.0, 1.0, 0.0}, {0.0, 0.0, 1.0}) == 2.0);
  CHECK(meetLine(t, {1.0, 1.0, 0.0}, {0.0, 0.0, 4.0}) == 0.5);
  CHECK(meetLine(t, {1.0, 1.0, 0.0}, {0.0, 0.0, -1.0}) == -2.0);
  CHECK(meetLine(t, {1.0, 1.0, 5.0}, {0.0, 0.0, -1.0}) == 3.0);
  CHECK(!meetLine(t, {3.0, 3.0, 0.0}, {0.0, 0.0, 1.0}));
  CHECK(!meetLine(t, {-1.0, 1.0, 2.0}, {1.0, 0.0, 0.0}));  // edge-on
  CHECK(!meetLine({t[0], t[0], t[1]}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}));
}

TEST_CASE("mesh/triangle_queries: no line slips through the edge between two triangles") {
  std::mt19937 rng(0x7319);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 20000; ++i) {
    CAPTURE(i);
    const DVec3 a(0.1, -1.0, 0.3), b(-0.2, 1.1, 0.1), left(-1.0, 0.2, 0.0), right(1.3, 0.1, -0.2);
    const DVec3 origin = randomPoint(rng) + DVec3(0.0, 0.0, 3.0);
    const DVec3 on_edge = a + unit(rng) * (b - a);
    const DVec3 direction = on_edge - origin;
    CHECK((meetLine({a, b, left}, origin, direction) || meetLine({b, a, right}, origin, direction)));
  }
}

TEST_CASE("mesh/triangle_queries: triangles overlap where an edge of one goes through the other") {
  std::mt19937 rng(0x731a);
  int found = 0;
  for (int i = 0; i < 20000; ++i) {
    CAPTURE(i);
    const Corners a = randomTriangle(rng), b = randomTriangle(rng);
    bool expected = false;
    for (std::size_t k = 0; k < 3; ++k)
      expected = expected || pierces(a[k], a[(k + 1) % 3], b) || pierces(b[k], b[(k + 1) % 3], a);
    CHECK(overlap(a, b) == expected);
    CHECK(overlap(b, a) == expected);
    found += expected;
  }
  CHECK(found > 2000);
  CHECK(found < 18000);
}

TEST_CASE("mesh/triangle_queries: in one plane triangles overlap as in the plane, and without area never") {
  const Corners a = {DVec3(0.0), DVec3(4.0, 0.0, 0.0), DVec3(0.0, 4.0, 0.0)};
  const auto moved = [&](double x, double y) {
    Corners b = a;
    for (DVec3& p : b) p += DVec3(x, y, 0.0);
    return b;
  };
  CHECK(overlap(a, a));
  CHECK(overlap(a, moved(1.0, 1.0)));
  CHECK(overlap(a, moved(-1.0, -1.0)));
  CHECK(!overlap(a, moved(2.5, 2.5)));  // beside the long edge, though the boxes overlap
  CHECK(!overlap(a, moved(5.0, 0.0)));
  CHECK(overlap(a, {DVec3(1.0, 1.0, 0.0), DVec3(1.5, 1.0, 0.0), DVec3(1.0, 1.5, 0.0)}));  // one within the other
  CHECK(!overlap(a, {DVec3(1.0, 1.0, -1.0), DVec3(1.0, 1.0, 1.0), DVec3(1.0, 1.0, 0.0)}));
}

}  // namespace sheaf::mesh
