#include "mesh/distance.h"

#include <doctest/doctest.h>

#include <limits>
#include <random>

#include "tests/mesh/meshes.h"

namespace sheaf::mesh {
namespace {

constexpr std::size_t kSamples = 5000;

// By golden section over the triangle's own coordinates: slow, but nothing like the code it checks.
double distanceToTriangle(const DVec3& p, const DVec3& a, const DVec3& b, const DVec3& c) {
  const auto minimise = [](const auto& f) {
    double lo = 0.0, hi = 1.0;
    const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
    for (int i = 0; i < 60; ++i) {
      const double x = hi - ratio * (hi - lo), y = lo + ratio * (hi - lo);
      if (f(x) < f(y))
        hi = y;
      else
        lo = x;
    }
    return f(0.5 * (lo + hi));
  };
  return minimise(
      [&](double s) { return minimise([&](double t) { return glm::length(a + s * (b - a + t * (c - b)) - p); }); });
}

Mesh randomMesh(std::uint32_t triangles, std::uint32_t seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> coordinate(-1.0F, 1.0F);
  Mesh m;
  for (std::uint32_t i = 0; i < 3 * triangles; ++i) {
    const float x = coordinate(rng), y = coordinate(rng), z = coordinate(rng);
    m.positions.emplace_back(x, y, z);
  }
  for (std::uint32_t i = 0; i < triangles; ++i) m.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  return m;
}

}  // namespace

TEST_CASE("mesh/distance: parallel squares are as far apart everywhere") {
  const Mesh a = makeGrid(7);
  Mesh b = makeGrid(3);
  for (Vec3& p : b.positions) p.z = 0.25F;
  TaskPool pool(2);
  const SurfaceDistance d = distanceBetween(a, b, kSamples, pool);
  for (const DistanceStats* s : {&d.forward, &d.backward}) {
    CHECK(s->max == doctest::Approx(0.25));
    CHECK(s->mean == doctest::Approx(0.25));
    CHECK(s->rms == doctest::Approx(0.25));
    CHECK(s->samples == kSamples);
  }
}

TEST_CASE("mesh/distance: the two directions differ where one surface lacks a part") {
  Mesh half = makeGrid(10);
  std::erase_if(half.triangles, [&](const Triangle& t) {
    return half.positions[t[0]].x + half.positions[t[1]].x + half.positions[t[2]].x > 1.5F;
  });
  TaskPool pool(2);
  const SurfaceDistance d = distanceBetween(makeGrid(10), half, kSamples, pool);
  CHECK(d.forward.max == doctest::Approx(0.5));
  // Over the missing half the distance runs evenly from 0 to 1/2.
  CHECK(d.forward.mean == doctest::Approx(0.125).epsilon(0.01));
  CHECK(d.forward.rms == doctest::Approx(std::sqrt(0.5 * 0.25 / 3.0)).epsilon(0.01));
  CHECK(d.backward.max < 1e-7);
  CHECK(d.hausdorff() == d.forward.max);
}

TEST_CASE("mesh/distance: a surface is at no distance from itself") {
  const Mesh m = makeSphere(20, 30);
  TaskPool pool(2);
  CHECK(distanceBetween(m, m, kSamples, pool).hausdorff() < 1e-7);
}

TEST_CASE("mesh/distance: the tree finds the same as a search over all triangles") {
  const Mesh to = randomMesh(60, 1);
  TaskPool pool(1);
  for (std::uint32_t seed = 2; seed < 12; ++seed) {
    // A triangle so small that it is a point.
    Mesh from = randomMesh(1, seed);
    from.positions[1] = from.positions[0] + Vec3(1e-6F, 0.0F, 0.0F);
    from.positions[2] = from.positions[0] + Vec3(0.0F, 1e-6F, 0.0F);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Triangle& t : to.triangles)
      nearest = std::min(nearest, distanceToTriangle(DVec3(from.positions[0]), DVec3(to.positions[t[0]]),
                                                     DVec3(to.positions[t[1]]), DVec3(to.positions[t[2]])));
    CHECK(distanceToSurface(from, to, 1, pool).max == doctest::Approx(nearest).epsilon(1e-4));
  }
}

TEST_CASE("mesh/distance: triangles without area count as the segments and points they are") {
  Mesh from, to;
  from.positions = {{0.0F, 1.0F, 0.0F}, {1.0F, 1.0F, 0.0F}, {0.5F, 2.0F, 0.0F}};
  from.triangles = {{0, 1, 2}};
  to.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0.5F, 3.0F, 0.0F}};
  to.triangles = {{0, 1, 2}, {0, 0, 0}};
  TaskPool pool(1);
  CHECK(distanceToSurface(from, to, 100, pool).max == doctest::Approx(2.0));
  to.triangles.push_back({3, 3, 3});
  CHECK(distanceToSurface(from, to, 10'000, pool).max < 1.6);
}

TEST_CASE("mesh/distance: nothing to measure") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  TaskPool pool(2);
  Mesh broken = makeGrid(1);
  broken.positions.assign(4, Vec3(nan));
  for (const Mesh& empty : {Mesh{}, broken}) {
    CHECK(distanceToSurface(empty, makeGrid(2), kSamples, pool).samples == 0);
    CHECK(distanceToSurface(makeGrid(2), empty, kSamples, pool).samples == 0);
  }
}

TEST_CASE("mesh/distance: 1, 2 and 7 threads give the same") {
  const Mesh a = randomMesh(500, 3), b = randomMesh(300, 4);
  TaskPool one(1);
  const SurfaceDistance expected = distanceBetween(a, b, 50'000, one);
  for (const int threads : {2, 7}) {
    TaskPool pool(threads);
    const SurfaceDistance d = distanceBetween(a, b, 50'000, pool);
    CHECK(d.forward.max == expected.forward.max);
    CHECK(d.forward.mean == expected.forward.mean);
    CHECK(d.backward.rms == expected.backward.rms);
  }
}

}  // namespace sheaf::mesh
