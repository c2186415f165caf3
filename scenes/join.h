// scenes/join: a scene as one mesh, for what works on shapes and not on pictures.
#pragma once

#include "mesh/mesh.h"
#include "scenes/scene.h"

namespace sheaf::scenes {

/// All instances in one mesh, in their order, where they stand in the world; mirrored ones keep their outside. A scene
/// of one instance keeps its vertices and their numbers. Of several, vertices that are equal in everything become one,
/// so that a surface that was cut up by material is whole again. An attribute stays if every mesh has it; materials do
/// not. Throws Error(kUnsupported) for more than 2^32 - 2 vertices.
mesh::Mesh joinedMesh(const Scene& scene);

/// The same surfaces with a mesh for each instance, whose vertices have the places that they have in joinedMesh(),
/// turned into another space: mesh i is instance i, and instances differ from each other only by mesh and material.
/// Triangles are as many and in the same order as in joinedMesh(). Solid textures are then laid out in that space, too.
/// world_from_mesh  a turn of axes
Scene withMeshPerInstance(Scene scene, const DMat4& world_from_mesh);

}  // namespace sheaf::scenes
