// scenes/ply_writer: a mesh as a PLY file [Turk94], for what sheaf makes of meshes and for other programs to read.
#pragma once

#include <filesystem>
#include <string>

#include "mesh/mesh.h"

namespace sheaf::scenes {

/// Binary, little-endian: x y z; nx ny nz, s t, red green blue alpha where the mesh has them; triangles. Floats, so
/// that reading gives the same numbers again, but for two: t counts upwards in PLY, and 1 - t rounds; colours are
/// sRGB-coded bytes, alpha a linear one, as other programs expect.
std::string encodePly(const mesh::Mesh& mesh);

/// Throws Error(kBadInput) if the file cannot be written; then no part of it is left.
void writePly(const std::filesystem::path& path, const mesh::Mesh& mesh);

}  // namespace sheaf::scenes
