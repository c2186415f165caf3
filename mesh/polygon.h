// mesh/polygon: polygons of files into triangles.
#pragma once

#include <span>
#include <vector>

#include "mesh/mesh.h"

namespace sheaf::mesh {

/// Cuts a polygon into triangles with its winding, by ear clipping in its Newell plane; a convex one becomes the fan
/// around corner 0. The polygon may be concave and may visit a vertex more than once (a hole with a bridge to it).
/// corners  positions in order, any unit; fewer than 3 give nothing, 3 are taken as they are
/// out      triangles of corner numbers in [0, #corners) are appended, at most #corners - 2: ears without area are
///          left out
/// return   false if some of it had to be cut as a fan: no area, crossing itself, not finite, or thousands of corners
///          so tangled that ear clipping would take too long
bool triangulatePolygon(std::span<const Vec3> corners, std::vector<Triangle>& out);

}  // namespace sheaf::mesh
