#include "raster/shade.h"

#include <algorithm>
#include <cmath>

namespace sheaf::raster {
namespace {

std::uint32_t unorm16(float value) {
  const float clamped = value > 0.0F ? std::min(value, 1.0F) : 0.0F;  // NaN becomes 0
  return static_cast<std::uint32_t>(std::lround(clamped * 65535.0F));
}

}  // namespace

VertexNormal vertexNormal(const Vec3& direction) {
  const DVec3 d(direction);
  const double length = glm::length(d);
  if (!(length > 0.0) || !std::isfinite(length)) return {0.0F, 0.0F, 1.0F, 0.0F};
  const Vec3 unit(d / length);
  return {unit.x, unit.y, unit.z, 0.0F};
}

std::array<std::uint32_t, 2> packColor(const Vec4& linear) {
  return {unorm16(linear.x) | unorm16(linear.y) << 16, unorm16(linear.z) | unorm16(linear.w) << 16};
}

}  // namespace sheaf::raster
