#include "mesh/mesh.h"

#include <cassert>

namespace sheaf::mesh {

Box3 boundsOf(const Mesh& mesh) {
  Box3 box;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) box.extend(mesh.positions[v]);
  return box;
}

void assertValid([[maybe_unused]] const Mesh& mesh) {
#ifndef NDEBUG
  const std::size_t n = mesh.vertexCount();
  assert(mesh.normals.empty() || mesh.normals.size() == n);
  assert(mesh.texcoords.empty() || mesh.texcoords.size() == n);
  assert(mesh.colors.empty() || mesh.colors.size() == n);
  for (const Triangle& t : mesh.triangles) assert(t[0] < n && t[1] < n && t[2] < n);
#endif
}

}  // namespace sheaf::mesh
