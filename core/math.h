// core/math: the geometric types that every module shares. Column vectors; matrices are named target_from_source.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include <glm/glm.hpp>

namespace sheaf {

using Vec2 = glm::vec2;
using Vec3 = glm::vec3;
using Vec4 = glm::vec4;
using DVec3 = glm::dvec3;
using DVec4 = glm::dvec4;
using Mat3 = glm::mat3;
using Mat4 = glm::mat4;
using DMat3 = glm::dmat3;
using DMat4 = glm::dmat4;

inline constexpr double kPi = 3.14159265358979323846;

constexpr double radians(double degrees) {
  return degrees * (kPi / 180.0);
}
constexpr double degrees(double radians) {
  return radians * (180.0 / kPi);
}

inline bool isFinite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Axis-aligned box; a default one is empty (lo > hi) and grows by extend().
struct Box3 {
  Vec3 lo{std::numeric_limits<float>::infinity()};
  Vec3 hi{-std::numeric_limits<float>::infinity()};

  bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
  void extend(const Vec3& p) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  void extend(const Box3& b) {
    lo = glm::min(lo, b.lo);
    hi = glm::max(hi, b.hi);
  }
  Vec3 center() const { return lo + 0.5F * (hi - lo); }
  Vec3 size() const { return empty() ? Vec3(0.0F) : hi - lo; }
  /// The unit of every epsilon: the longest edge, 0 for an empty box.
  float longestEdge() const { return std::max({size().x, size().y, size().z}); }
};

}  // namespace sheaf
