// Links what a static library drags along: headers of every module, and code that needs the library's own dependencies.
#include <atomic>
#include <cstdio>

#include "core/task_pool.h"
#include "grouping/patches.h"
#include "mesh/mesh.h"
#include "pipeline/renderer.h"
#include "raster/texture.h"
#include "scenes/scene.h"

int main() {
  sheaf::mesh::Mesh triangle;
  triangle.positions = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}};
  triangle.triangles = {{0, 1, 2}};
  const sheaf::Vec3 size = sheaf::mesh::boundsOf(triangle).size();

  std::atomic<int> pieces{0};
  sheaf::TaskPool(2).parallelFor(10, [&](int, int) { ++pieces; });

  std::printf("bounds %g x %g, %d pieces\n", size.x, size.y, pieces.load());
  return size == sheaf::Vec3(2, 3, 0) && pieces == 10 ? 0 : 1;
}
