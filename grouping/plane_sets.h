// grouping/plane_sets: the directions that planar groups may have.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "grouping/vertex_groups.h"

namespace sheaf::grouping {

/// Normals x, y, z with in-plane axes (y, z), (z, x), (x, y): [PG] 3.1.
std::vector<PlaneFrame> axisPlanes();
/// The six directions of a regular dodecahedron's faces: [PG] 6.
std::vector<PlaneFrame> dodecahedronPlanes();
/// The three axis planes, then the six of the dodecahedron.
std::vector<PlaneFrame> axisAndDodecahedronPlanes();
/// normals  of any length above 0. Throws Error(kBadInput) for one without a direction, and if there are none.
std::vector<PlaneFrame> planesFromNormals(std::span<const DVec3> normals);

/// A text file of normals, three numbers to a line; `#` begins a comment, empty lines are skipped. At most
/// kMaxFilePlanes. Throws Error(kBadInput) "file:line: reason", or as readFile() does.
inline constexpr std::size_t kMaxFilePlanes = 255;
std::vector<PlaneFrame> loadPlanes(const std::filesystem::path& path);

}  // namespace sheaf::grouping
