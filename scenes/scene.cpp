#include "scenes/scene.h"

namespace sheaf::scenes {

std::size_t Scene::triangleCount() const {
  std::size_t count = 0;
  for (const Instance& i : instances) count += meshes[i.mesh].triangleCount();
  return count;
}

std::size_t Scene::vertexCount() const {
  std::size_t count = 0;
  for (const Instance& i : instances) count += meshes[i.mesh].vertexCount();
  return count;
}

Box3 boundsOf(const Scene& scene) {
  std::vector<Box3> object_boxes;
  object_boxes.reserve(scene.meshes.size());
  for (const mesh::Mesh& m : scene.meshes) object_boxes.push_back(mesh::boundsOf(m));
  Box3 world;
  for (const Instance& instance : scene.instances) {
    const Box3& box = object_boxes[instance.mesh];
    if (box.empty()) continue;
    for (int corner = 0; corner < 8; ++corner) {
      const DVec4 p((corner & 1) ? box.hi.x : box.lo.x, (corner & 2) ? box.hi.y : box.lo.y,
                    (corner & 4) ? box.hi.z : box.lo.z, 1.0);
      world.extend(Vec3(DVec3(instance.world_from_object * p)));
    }
  }
  return world;
}

}  // namespace sheaf::scenes
