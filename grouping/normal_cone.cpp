#include "grouping/normal_cone.h"

#include <algorithm>
#include <cmath>

namespace sheaf::grouping {
namespace {

// Room for whoever evaluates the cone in float. A cone near a half-space says nothing worth testing.
NormalCone coneWithin(const Vec3& axis, double least_cosine) {
  const double cosine = least_cosine - 1e-6;
  if (!(cosine > 1e-3)) return {};
  const auto sine = static_cast<float>(std::sqrt(1.0 - cosine * cosine));
  return {axis, std::nextafter(sine, 2.0F)};
}

}  // namespace

// Centre of a small ball around the normals, by steps towards the farthest (Badoiu and Clarkson 2003): its direction is
// the axis of a narrower cone than that of the mean normal.
NormalCone coneOf(std::span<const DVec3> normals) {
  DVec3 center(0.0);
  for (const DVec3& n : normals) center += n;
  if (normals.empty() || center == DVec3(0.0)) return {};
  center /= static_cast<double>(normals.size());
  Vec3 best_axis(0.0F);
  double best_cos = -1.0;
  constexpr int kSteps = 6;
  for (int step = 0; step < kSteps; ++step) {
    const double length = glm::length(center);
    if (!(length > 1e-6)) break;
    const Vec3 axis(center * (1.0 / length));
    const DVec3* farthest = &normals[0];
    double least = 2.0;
    for (const DVec3& n : normals) {
      const double cosine = glm::dot(n, DVec3(axis));
      if (cosine < least) farthest = &n;
      least = std::min(least, cosine);
    }
    if (least > best_cos) {
      best_cos = least;
      best_axis = axis;
    }
    center += (*farthest - center) * (1.0 / (step + 3));
  }
  return coneWithin(best_axis, best_cos);
}

NormalCone coneAround(const NormalCone& a, const NormalCone& b) {
  if (!(a.sin_angle < 1.0F && b.sin_angle < 1.0F)) return {};
  const auto cosine_of = [](const NormalCone& c) {
    return std::sqrt(std::max(0.0, 1.0 - double{c.sin_angle} * double{c.sin_angle}));
  };
  const DVec3 u = glm::normalize(DVec3(a.axis)), v = glm::normalize(DVec3(b.axis));
  const double cos_a = cosine_of(a), cos_b = cosine_of(b), sin_a = a.sin_angle, sin_b = b.sin_angle;
  const double cos_between = glm::dot(u, v), sin_between = glm::length(glm::cross(u, v));
  // One in the other: the angle between the axes is at most the difference of the cones' own.
  const double cos_difference = cos_a * cos_b + sin_a * sin_b;
  if (cos_between >= cos_difference) return cos_a < cos_b ? a : b;
  if (!(sin_between > 1e-9)) return cos_between < 0.0 ? NormalCone{} : coneWithin(a.axis, std::min(cos_a, cos_b));
  // The two rims that lie farthest apart, in the plane of the axes; the new axis is in the middle between them.
  const DVec3 towards_v = (v - u * cos_between) / sin_between, beyond_v = (v * cos_between - u) / sin_between;
  const DVec3 rim_a = u * cos_a - towards_v * sin_a, rim_b = v * cos_b + beyond_v * sin_b;
  const DVec3 middle = rim_a + rim_b;
  const double length = glm::length(middle);
  // Three angles below 90 degrees add up to less than 360: beyond 180 the middle lies on the wrong side.
  if (!(length > 1e-6) || glm::dot(middle, u + v) <= 0.0) return {};
  const Vec3 axis(middle / length);
  return coneWithin(axis, std::min(glm::dot(DVec3(axis), rim_a), glm::dot(DVec3(axis), rim_b)));
}

}  // namespace sheaf::grouping
