// scenes/painted_parts: meshes whose parts are told apart by colour.
#pragma once

#include <cstdint>
#include <span>

#include "mesh/mesh.h"

namespace sheaf::scenes {

/// Clearly different ones, also where they are shaded.
inline constexpr std::uint32_t kPartColors = 8;

/// Linear. number  below kPartColors
Vec3 partColor(std::uint32_t number);

/// The mesh with a colour per part. Vertices where parts meet are there once for each, those that no face uses not at
/// all; faces keep their numbers and normals stay; texture coordinates and former colours do not.
/// part_of_face   #F, in [0, #P)
/// color_of_part  #P, in [0, kPartColors)
mesh::Mesh paintedParts(const mesh::Mesh& mesh, std::span<const std::uint32_t> part_of_face,
                        std::span<const std::uint32_t> color_of_part);

}  // namespace sheaf::scenes
