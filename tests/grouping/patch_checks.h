// tests/grouping/patch_checks: what every PatchSet must be, and meshes to cut.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

#include "grouping/patches.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

inline bool hasRepeatedVertex(const mesh::Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

inline DVec3 areaNormal(const mesh::Mesh& m, const mesh::Triangle& t) {
  const DVec3 p0(m.positions[t[0]]);
  return glm::cross(DVec3(m.positions[t[1]]) - p0, DVec3(m.positions[t[2]]) - p0);
}

inline void checkRuns(const PatchSet& set, const PatchLimits& limits) {
  std::uint32_t vertices = 0, triangles = 0;
  for (const Patch& p : set.patches) {
    CHECK(p.first_vertex == vertices);
    CHECK(p.first_triangle == triangles);
    CHECK(p.vertex_count >= 1);
    CHECK(p.vertex_count <= limits.max_vertices);
    CHECK(p.triangle_count >= 1);
    CHECK(p.triangle_count <= limits.max_triangles);
    vertices += (p.vertex_count + kRunAlignment - 1) / kRunAlignment * kRunAlignment;
    triangles += (p.triangle_count + kRunAlignment - 1) / kRunAlignment * kRunAlignment;
    bool padded = true;
    REQUIRE(vertices <= set.vertex_source.size());
    REQUIRE(triangles <= set.triangle_source.size());
    for (std::uint32_t v = p.first_vertex + p.vertex_count; v < vertices; ++v)
      padded = padded && set.vertex_source[v] == set.vertex_source[p.first_vertex + p.vertex_count - 1];
    for (std::uint32_t t = p.first_triangle + p.triangle_count; t < triangles; ++t) {
      padded = padded && set.triangle_source[t] == kNoIndex;
      for (const auto& corner : set.corners) padded = padded && corner[t] == 0;
    }
    CHECK(padded);
  }
  CHECK(set.vertex_source.size() == vertices);
  CHECK(set.triangle_source.size() == triangles);
  for (const auto& corner : set.corners) CHECK(corner.size() == triangles);
}

inline void checkPartition(const PatchSet& set, const mesh::Mesh& m) {
  std::vector<int> uses(m.triangleCount(), 0);
  std::size_t wrong_corners = 0, outside = 0, unordered = 0;
  for (const Patch& p : set.patches) {
    std::uint32_t seen = 0;
    for (std::uint32_t i = 0; i < p.triangle_count; ++i) {
      const std::uint32_t slot = p.first_triangle + i, source = set.triangle_source[slot];
      REQUIRE(source < m.triangleCount());
      ++uses[source];
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t local = set.corners[k][slot];
        REQUIRE(local < p.vertex_count);
        if (local > seen) ++unordered;
        if (local == seen) ++seen;
        const std::uint32_t v = set.vertex_source[p.first_vertex + local];
        if (v != m.triangles[source][k]) ++wrong_corners;
        const Vec3& x = m.positions[v];
        if (glm::min(p.bounds.lo, x) != p.bounds.lo || glm::max(p.bounds.hi, x) != p.bounds.hi) ++outside;
      }
    }
    CHECK(seen == p.vertex_count);
    Box3 box;
    for (std::uint32_t v = 0; v < p.vertex_count; ++v) box.extend(m.positions[set.vertex_source[p.first_vertex + v]]);
    CHECK(box.lo == p.bounds.lo);
    CHECK(box.hi == p.bounds.hi);
  }
  CHECK(wrong_corners == 0);
  CHECK(outside == 0);
  CHECK(unordered == 0);
  std::size_t wrong_uses = 0;
  for (std::size_t f = 0; f < m.triangleCount(); ++f)
    if (uses[f] != (hasRepeatedVertex(m.triangles[f]) ? 0 : 1)) ++wrong_uses;
  CHECK(wrong_uses == 0);
}

inline void checkCones(const PatchSet& set, const mesh::Mesh& m) {
  for (const Patch& p : set.patches) {
    REQUIRE(isFinite(p.cone.axis));
    REQUIRE(p.cone.sin_angle >= 0.0F);
    if (p.cone.sin_angle >= 1.0F) continue;
    const double sine = p.cone.sin_angle, least = std::sqrt(1.0 - sine * sine);
    std::size_t outside = 0;
    for (std::uint32_t i = 0; i < p.triangle_count; ++i) {
      const DVec3 n = areaNormal(m, m.triangles[set.triangle_source[p.first_triangle + i]]);
      if (glm::length(n) > 0.0 && glm::dot(glm::normalize(n), DVec3(p.cone.axis)) < least) ++outside;
    }
    CHECK(outside == 0);
  }
}

inline bool equal(const PatchSet& a, const PatchSet& b) {
  if (a.vertex_source != b.vertex_source || a.corners != b.corners || a.triangle_source != b.triangle_source ||
      a.patches.size() != b.patches.size())
    return false;
  for (std::size_t i = 0; i < a.patches.size(); ++i) {
    const Patch &p = a.patches[i], &q = b.patches[i];
    if (p.first_vertex != q.first_vertex || p.vertex_count != q.vertex_count || p.first_triangle != q.first_triangle ||
        p.triangle_count != q.triangle_count || p.bounds.lo != q.bounds.lo || p.bounds.hi != q.bounds.hi ||
        p.cone.axis != q.cone.axis || p.cone.sin_angle != q.cone.sin_angle)
      return false;
  }
  return true;
}

inline mesh::Mesh randomSoup(std::uint32_t vertices, std::uint32_t triangles, float extent) {
  std::mt19937 rng(11);
  std::uniform_real_distribution<float> coordinate(-extent, extent);
  std::uniform_int_distribution<std::uint32_t> index(0, vertices - 1);
  mesh::Mesh m;
  for (std::uint32_t i = 0; i < vertices; ++i) {
    const float x = coordinate(rng), y = coordinate(rng), z = coordinate(rng);
    m.positions.emplace_back(x, y, z);
  }
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const std::uint32_t a = index(rng), b = index(rng), c = index(rng);
    m.triangles.push_back({a, b, c});
  }
  return m;
}

}  // namespace sheaf::grouping
