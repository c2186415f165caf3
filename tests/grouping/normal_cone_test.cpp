#include "grouping/normal_cone.h"

#include <doctest/doctest.h>

#include <random>
#include <vector>

namespace sheaf::grouping {
namespace {

DVec3 randomDirection(std::mt19937& rng) {
  std::normal_distribution<double> normal;
  const double x = normal(rng), y = normal(rng), z = normal(rng);
  return glm::normalize(DVec3(x, y, z));
}

double leastCosine(const NormalCone& cone, const std::vector<DVec3>& normals) {
  double least = 1.0;
  for (const DVec3& n : normals) least = std::min(least, glm::dot(n, DVec3(cone.axis)));
  return least;
}

double cosineOf(const NormalCone& cone) {
  return std::sqrt(1.0 - double{cone.sin_angle} * double{cone.sin_angle});
}

}  // namespace

TEST_CASE("grouping/normal_cone: a cone around two cones holds what both hold, and is no wider than it must be") {
  std::mt19937 rng(0xc04e);
  std::uniform_real_distribution<double> spread(0.0, 0.8);
  int said = 0;
  for (int i = 0; i < 2000; ++i) {
    CAPTURE(i);
    std::array<std::vector<DVec3>, 2> normals;
    const DVec3 first = randomDirection(rng);
    for (std::vector<DVec3>& set : normals) {
      const DVec3 middle = glm::normalize(first + spread(rng) * randomDirection(rng));
      const double width = spread(rng);
      for (int k = 0; k < 20; ++k) set.push_back(glm::normalize(middle + width * randomDirection(rng)));
    }
    const NormalCone a = coneOf(normals[0]), b = coneOf(normals[1]), both = coneAround(a, b);
    for (const auto* pair : {&normals[0], &normals[1]}) {
      if (both.sin_angle < 1.0F) CHECK(leastCosine(both, *pair) >= cosineOf(both));
    }
    if (a.sin_angle < 1.0F && b.sin_angle < 1.0F) {
      const double angle = std::acos(glm::dot(glm::normalize(DVec3(a.axis)), glm::normalize(DVec3(b.axis))));
      const double alpha = std::asin(double{a.sin_angle}), beta = std::asin(double{b.sin_angle});
      const double needed = std::max({alpha, beta, 0.5 * (angle + alpha + beta)});
      if (both.sin_angle < 1.0F)
        CHECK(std::asin(double{both.sin_angle}) <= needed + 2e-3);
      else
        CHECK(needed > 0.5 * kPi - 2e-2);
      said += both.sin_angle < 1.0F ? 1 : 0;
    } else {
      CHECK(both.sin_angle >= 1.0F);
    }
  }
  CHECK(said > 500);
}

TEST_CASE("grouping/normal_cone: one cone in another, equal cones, opposite cones, none") {
  const NormalCone narrow{{0.0F, 0.0F, 1.0F}, 0.1F}, wide{{0.0F, 0.0F, 1.0F}, 0.5F};
  CHECK(coneAround(narrow, wide) == wide);
  CHECK(coneAround(wide, narrow) == wide);
  CHECK(coneAround(wide, wide) == wide);
  CHECK(coneAround(narrow, {{0.0F, 0.0F, -1.0F}, 0.1F}).sin_angle >= 1.0F);
  CHECK(coneAround(narrow, {}).sin_angle >= 1.0F);
  CHECK(coneOf({}).sin_angle >= 1.0F);
  CHECK(coneAround({{1.0F, 0.0F, 0.0F}, 0.9F}, {{0.0F, 1.0F, 0.0F}, 0.9F}).sin_angle >= 1.0F);  // 64 + 90 + 64 degrees
}

}  // namespace sheaf::grouping
