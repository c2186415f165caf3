#include "pipeline/clip.h"

#include <doctest/doctest.h>

#include <random>

namespace sheaf::pipeline {
namespace {

const Viewport kViewport(640, 480);

double area2(const Vec3& a, const Vec3& b, const Vec3& c) {
  return glm::length(glm::cross(b - a, c - a));
}

// Random corners on both sides of everything.
std::array<Vec4, 3> randomTriangle(std::mt19937& rng) {
  std::uniform_real_distribution<float> wide(-60.0F, 60.0F);
  std::uniform_real_distribution<float> w(-1.0F, 2.0F);
  std::array<Vec4, 3> t;
  for (Vec4& c : t) c = {wide(rng) * 3.0F, wide(rng) * 3.0F, w(rng), w(rng)};
  return t;
}

std::int32_t planesOf(const std::array<Vec4, 3>& t) {
  std::int32_t planes = 0;
  for (const Vec4& c : t) planes |= outcodeVertex(c, kViewport) & kClipBits;
  return planes;
}

}  // namespace

TEST_CASE("pipeline/clip: what is left lies within near, far and the guard band") {
  std::mt19937 rng(1);
  int cut = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::array<Vec4, 3> triangle = randomTriangle(rng);
    const ClippedPolygon polygon = clipTriangle(triangle, planesOf(triangle), kViewport);
    CHECK(polygon.count <= 9);
    for (int k = 0; k < polygon.count; ++k) {
      const Vec4& c = polygon.corners[static_cast<std::size_t>(k)];
      const float slack = 1e-4F * (std::abs(c.x) + std::abs(c.y) + std::abs(c.z) + std::abs(c.w));
      CHECK(c.z >= -slack);
      CHECK(c.z <= c.w + slack);
      CHECK(std::abs(c.x) <= kViewport.guard_x * c.w + slack);
      CHECK(std::abs(c.y) <= kViewport.guard_y * c.w + slack);
    }
    cut += polygon.count > 3;
  }
  CHECK(cut > 500);
}

TEST_CASE("pipeline/clip: the parts on both sides of a plane make up the triangle") {
  std::mt19937 rng(2);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  for (int i = 0; i < 2000; ++i) {
    // w = 1: areas in (x, y, z) are plain. Only far cuts.
    std::array<Vec4, 3> triangle;
    for (Vec4& c : triangle) c = {unit(rng), unit(rng), unit(rng) - 0.5F, 1.0F};
    std::array<Vec4, 3> mirrored = triangle;
    for (Vec4& c : mirrored) c.z = -c.z;
    double sum = 0.0;
    for (const auto& side : {triangle, mirrored}) {
      const ClippedPolygon p = clipTriangle(side, kOutFar, kViewport);
      for (int k = 2; k < p.count; ++k)
        sum += area2(p.corners[0], p.corners[static_cast<std::size_t>(k - 1)], p.corners[static_cast<std::size_t>(k)]);
    }
    CHECK(sum == doctest::Approx(area2(triangle[0], triangle[1], triangle[2])).epsilon(1e-4));
  }
}

TEST_CASE("pipeline/clip: neighbours get the same points on their common edge") {
  std::mt19937 rng(3);
  for (int i = 0; i < 5000; ++i) {
    const std::array<Vec4, 3> left = randomTriangle(rng);
    const std::array<Vec4, 3> right = {left[1], left[0], randomTriangle(rng)[0]};
    // Near alone, so that the points are those of the common edge.
    const auto cutPoints = [](const std::array<Vec4, 3>& t) {
      std::vector<Vec4> points;
      const Vec4 a = t[0];
      const Vec4 b = t[1];
      if ((a.z > a.w) == (b.z > b.w)) return points;
      const ClippedPolygon p = clipTriangle({a, b, b}, kOutFar, kViewport);
      for (int k = 0; k < p.count; ++k) points.push_back(p.corners[static_cast<std::size_t>(k)]);
      return points;
    };
    const auto from_left = cutPoints({left[0], left[1], left[2]});
    const auto from_right = cutPoints({right[1], right[0], right[2]});
    CHECK(from_left == from_right);
  }
}

TEST_CASE("pipeline/clip: a triangle wholly beyond one plane vanishes, one that needs nothing stays as it is") {
  const std::array<Vec4, 3> beyond = {Vec4{0, 0, 2, 1}, Vec4{1, 0, 3, 1}, Vec4{0, 1, 2, 1}};
  CHECK(clipTriangle(beyond, kOutNear, kViewport).count == 0);
  const std::array<Vec4, 3> inside = {Vec4{0, 0, 0.5, 1}, Vec4{1, 0, 0.5, 1}, Vec4{0, 1, 0.5, 1}};
  const ClippedPolygon same = clipTriangle(inside, kClipBits, kViewport);
  REQUIRE(same.count == 3);
  for (std::size_t i = 0; i < 3; ++i) CHECK(same.corners[i] == inside[i]);
}

}  // namespace sheaf::pipeline
