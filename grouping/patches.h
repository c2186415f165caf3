// grouping: what is made of a mesh once, before any frame: patches, vertex groups, face clusters.
//   In     mesh::Mesh, object space
//   Out    index structures beside the mesh; the mesh itself is not changed
//   Keeps  deterministic; the same result for any number of threads
//   Knows  no pixels and no scenes
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math.h"
#include "core/task_pool.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

inline constexpr std::uint32_t kNoIndex = 0xFFFFFFFFU;
/// Runs of vertices and of triangles start at multiples of this, so that kernels load whole vectors.
inline constexpr std::uint32_t kRunAlignment = 16;

/// Every triangle's geometric normal n (unit) has dot(n, axis) >= sqrt(1 - sin_angle^2) > 0. `sin_angle` = 1 (or more):
/// the normals fill a half-space or more, and the cone says nothing. Triangles without area do not count.
struct NormalCone {
  Vec3 axis{0.0F, 0.0F, 1.0F};
  float sin_angle = 1.0F;
  bool operator==(const NormalCone&) const = default;
};

/// A piece of a mesh, the unit of work of the geometry stage.
struct Patch {
  std::uint32_t first_vertex = 0;    ///< into PatchSet::vertex_source, a multiple of kRunAlignment
  std::uint32_t vertex_count = 0;    ///< [1, 256], padding not counted
  std::uint32_t first_triangle = 0;  ///< into PatchSet::corners and triangle_source, a multiple of kRunAlignment
  std::uint32_t triangle_count = 0;  ///< [1, 512], padding not counted
  Box3 bounds;                       ///< of its vertices, object space
  NormalCone cone;
};

/// Partition of a mesh's triangles. Vertices on a border stand in every patch that uses them.
struct PatchSet {
  std::vector<Patch> patches;
  std::vector<std::uint32_t> vertex_source;  ///< mesh vertex of each slot; padding repeats the run's last vertex
  std::array<std::vector<std::uint8_t>, 3> corners;  ///< local vertex of each corner; padding is (0, 0, 0)
  std::vector<std::uint32_t> triangle_source;        ///< mesh triangle of each slot; padding is kNoIndex

  /// Of the mesh, without padding.
  std::span<const std::uint32_t> verticesOf(const Patch& patch) const {
    return std::span(vertex_source).subspan(patch.first_vertex, patch.vertex_count);
  }
  std::span<const std::uint32_t> trianglesOf(const Patch& patch) const {
    return std::span(triangle_source).subspan(patch.first_triangle, patch.triangle_count);
  }
};

struct PatchLimits {
  std::uint32_t max_vertices = 256;   ///< [3, 256]
  std::uint32_t max_triangles = 512;  ///< [1, 512]
};

/// Splits by position and orientation, halving until a piece is within the limits: neighbours in space with similar
/// normals end up together. Triangles that use a vertex twice are left out.
PatchSet splitIntoPatches(const mesh::Mesh& mesh, const PatchLimits& limits, TaskPool& pool);

/// Bounds again, after the mesh's vertices have moved. Cones stay: they speak of the surface as it was.
void renewBounds(const mesh::Mesh& mesh, PatchSet& set, TaskPool& pool);

}  // namespace sheaf::grouping
