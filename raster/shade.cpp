#include "raster/shade.h"

#include <algorithm>
#include <cmath>

namespace sheaf::raster {
namespace {

std::uint32_t unorm16(float value) {
  const float clamped = value > 0.0F ? std::min(value, 1.0F) : 0.0F;  // NaN becomes 0
  return static_cast<std::uint32_t>(std::lround(clamped * 65535.0F));
}

Vec2 foldedOver(const Vec2& p) {
  return {(1.0F - std::abs(p.y)) * (p.x >= 0.0F ? 1.0F : -1.0F), (1.0F - std::abs(p.x)) * (p.y >= 0.0F ? 1.0F : -1.0F)};
}

}  // namespace

std::uint32_t packNormal(const Vec3& unit) {
  const float length = std::abs(unit.x) + std::abs(unit.y) + std::abs(unit.z);
  if (!(length > 0.0F) || !std::isfinite(length)) return packNormal({0.0F, 0.0F, 1.0F});
  Vec2 p{unit.x / length, unit.y / length};
  if (unit.z < 0.0F) p = foldedOver(p);
  return unorm16(0.5F * p.x + 0.5F) | unorm16(0.5F * p.y + 0.5F) << 16;
}

Vec3 unpackNormal(std::uint32_t packed) {
  const Vec2 p{static_cast<float>(packed & 0xFFFFU) * (2.0F / 65535.0F) - 1.0F,
               static_cast<float>(packed >> 16) * (2.0F / 65535.0F) - 1.0F};
  const float z = 1.0F - std::abs(p.x) - std::abs(p.y);
  const Vec2 q = z < 0.0F ? foldedOver(p) : p;
  return glm::normalize(Vec3(q, z));
}

std::array<std::uint32_t, 2> packColor(const Vec4& linear) {
  return {unorm16(linear.x) | unorm16(linear.y) << 16, unorm16(linear.z) | unorm16(linear.w) << 16};
}

}  // namespace sheaf::raster
