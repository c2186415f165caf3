#include "scenes/join.h"

#include <fmt/format.h>

#include <limits>

#include "mesh/weld.h"
#include "scenes/import.h"

namespace sheaf::scenes {
namespace {

struct Attributes {
  bool normals = true;
  bool texcoords = true;
  bool colors = true;
};

Attributes commonAttributes(const Scene& scene) {
  Attributes common;
  for (const Instance& instance : scene.instances) {
    const mesh::Mesh& mesh = scene.meshes[instance.mesh];
    common.normals &= !mesh.normals.empty();
    common.texcoords &= !mesh.texcoords.empty();
    common.colors &= !mesh.colors.empty();
  }
  return common;
}

void append(const mesh::Mesh& mesh, const DMat4& world_from_object, const Attributes& wanted, mesh::Mesh& joined) {
  const auto first = static_cast<std::uint32_t>(joined.vertexCount());
  const bool moved = world_from_object != DMat4(1.0);
  for (const Vec3& p : mesh.positions)
    joined.positions.push_back(moved ? Vec3(DVec3(world_from_object * DVec4(DVec3(p), 1.0))) : p);
  if (wanted.normals) {
    const DMat3 linear(world_from_object);
    // The cofactors are inverse(transpose(linear)) times the determinant, and need no inverse of a flattened instance.
    const double sign = glm::determinant(linear) < 0.0 ? -1.0 : 1.0;
    const DMat3 turn = sign * DMat3(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                                    glm::cross(linear[0], linear[1]));
    for (const Vec3& n : mesh.normals) {
      const DVec3 turned = moved ? turn * DVec3(n) : DVec3(n);
      const double length = glm::length(turned);
      joined.normals.push_back(moved && length > 0.0 ? Vec3(turned / length) : n);
    }
  }
  if (wanted.texcoords) joined.texcoords.insert(joined.texcoords.end(), mesh.texcoords.begin(), mesh.texcoords.end());
  if (wanted.colors) joined.colors.insert(joined.colors.end(), mesh.colors.begin(), mesh.colors.end());
  const bool mirrored = glm::determinant(DMat3(world_from_object)) < 0.0;
  for (const mesh::Triangle& t : mesh.triangles)
    joined.triangles.push_back({first + t[0], first + t[mirrored ? 2 : 1], first + t[mirrored ? 1 : 2]});
}

}  // namespace

mesh::Mesh joinedMesh(const Scene& scene) {
  if (scene.vertexCount() >= std::numeric_limits<std::uint32_t>::max())
    refuseUnsupported(scene.name,
                      fmt::format("its instances have {} vertices in all, more than 2^32 - 2", scene.vertexCount()));
  const Attributes wanted = commonAttributes(scene);
  mesh::Mesh joined;
  joined.positions.reserve(scene.vertexCount());
  joined.triangles.reserve(scene.triangleCount());
  for (const Instance& instance : scene.instances)
    append(scene.meshes[instance.mesh], instance.world_from_object, wanted, joined);
  if (scene.instances.size() > 1) mesh::weldVertices(joined);
  return joined;
}

Scene withMeshPerInstance(Scene scene, const DMat4& world_from_mesh) {
  const DMat4 mesh_from_world = glm::transpose(world_from_mesh);
  std::vector<mesh::Mesh> meshes(scene.instances.size());
  for (std::uint32_t i = 0; i < meshes.size(); ++i) {
    Instance& instance = scene.instances[i];
    const mesh::Mesh& mesh = scene.meshes[instance.mesh];
    append(mesh, mesh_from_world * instance.world_from_object,
           {!mesh.normals.empty(), !mesh.texcoords.empty(), !mesh.colors.empty()}, meshes[i]);
    instance.mesh = i;
    instance.world_from_object = world_from_mesh;
  }
  scene.meshes = std::move(meshes);
  return scene;
}

}  // namespace sheaf::scenes
