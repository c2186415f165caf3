// mesh: indexed triangle meshes and what is done to them before grouping: welding, normals, adjacency, simplification.
//   In     plain arrays, object space, any unit; counter-clockwise triangles are seen from the front
//   Out    the same value type; nothing here draws
//   Keeps  deterministic: ties go to the lower index
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/math.h"

namespace sheaf::mesh {

using Triangle = std::array<std::uint32_t, 3>;

/// #V vertices and #F triangles. Every attribute array is either empty or has #V entries.
struct Mesh {
  std::vector<Vec3> positions;      ///< #V, object space
  std::vector<Vec3> normals;        ///< #V or 0, unit length, object space
  std::vector<Vec2> texcoords;      ///< #V or 0, (0, 0) is the texture's top left texel corner (glTF)
  std::vector<Vec4> colors;         ///< #V or 0, linear, straight alpha, multiplied with the material's base colour
  std::vector<Triangle> triangles;  ///< #F, indices in [0, #V)

  std::size_t vertexCount() const { return positions.size(); }
  std::size_t triangleCount() const { return triangles.size(); }
};

/// Box of the vertices that some triangle uses; empty if there are none.
Box3 boundsOf(const Mesh& mesh);

/// Asserts in debug builds that indices are in range and that attribute arrays have #V entries or none.
void assertValid(const Mesh& mesh);

}  // namespace sheaf::mesh
