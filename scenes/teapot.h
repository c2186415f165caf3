// scenes/teapot: the Utah teapot (M. Newell, 1975) from its 32 bicubic Bezier patches.
#pragma once

#include "mesh/mesh.h"

namespace sheaf::scenes {

/// Stands on y = 0 about the Y axis, spout towards +X; 6.43 wide, 3.15 high. Not closed: the lid rests beside the rim,
/// handle and spout run into the body. Each patch has the whole unit square as texture coordinates.
/// n  quads along each side of a patch
mesh::Mesh teapotMesh(int n);

}  // namespace sheaf::scenes
