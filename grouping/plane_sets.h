// grouping/plane_sets: the directions that planar groups may have.
#pragma once

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

}  // namespace sheaf::grouping
