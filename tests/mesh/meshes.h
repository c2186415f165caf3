// Small meshes that several tests share.
#pragma once

#include <cmath>

#include "mesh/mesh.h"

namespace sheaf::mesh {

/// Unit cube around the origin, 8 shared vertices, normals outwards.
inline Mesh makeCube() {
  Mesh m;
  for (unsigned i = 0; i < 8; ++i)
    m.positions.emplace_back(i & 1U ? 0.5F : -0.5F, i & 2U ? 0.5F : -0.5F, i & 4U ? 0.5F : -0.5F);
  m.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return m;
}

/// Unit sphere of `rings` x `segments`, closed, poles at +-Y.
inline Mesh makeSphere(std::uint32_t rings, std::uint32_t segments) {
  Mesh m;
  m.positions.emplace_back(0.0F, 1.0F, 0.0F);
  for (std::uint32_t r = 1; r < rings; ++r)
    for (std::uint32_t s = 0; s < segments; ++s) {
      const double theta = kPi * r / rings, phi = 2.0 * kPi * s / segments;
      m.positions.emplace_back(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
    }
  m.positions.emplace_back(0.0F, -1.0F, 0.0F);
  const auto last = static_cast<std::uint32_t>(m.positions.size() - 1);
  const auto at = [&](std::uint32_t r, std::uint32_t s) { return 1 + (r - 1) * segments + s % segments; };
  for (std::uint32_t s = 0; s < segments; ++s) m.triangles.push_back({0, at(1, s), at(1, s + 1)});
  for (std::uint32_t r = 1; r + 1 < rings; ++r)
    for (std::uint32_t s = 0; s < segments; ++s) {
      m.triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
      m.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    }
  for (std::uint32_t s = 0; s < segments; ++s) m.triangles.push_back({at(rings - 1, s), last, at(rings - 1, s + 1)});
  return m;
}

/// Flat grid of n x n squares over [0, 1]^2 in the plane z = 0, seen from +Z.
inline Mesh makeGrid(std::uint32_t n) {
  Mesh m;
  for (std::uint32_t y = 0; y <= n; ++y)
    for (std::uint32_t x = 0; x <= n; ++x)
      m.positions.emplace_back(static_cast<float>(x) / static_cast<float>(n),
                               static_cast<float>(y) / static_cast<float>(n), 0.0F);
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
      m.triangles.push_back({a, b, d});
      m.triangles.push_back({a, d, c});
    }
  return m;
}

/// `count` triangles around vertex 0, which stands at the apex of a flat cone.
inline Mesh makeFan(std::uint32_t count) {
  Mesh m;
  m.positions.emplace_back(0.0F, 0.0F, 0.25F);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double phi = 2.0 * kPi * i / count;
    m.positions.emplace_back(std::cos(phi), std::sin(phi), 0.0);
    m.triangles.push_back({0, 1 + i, 1 + (i + 1) % count});
  }
  return m;
}

}  // namespace sheaf::mesh
