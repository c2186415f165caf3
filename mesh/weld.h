// mesh/weld: repairs that importers need before anything else looks at a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/mesh.h"

namespace sheaf::mesh {

/// Joins vertices whose attributes are all exactly equal (0.0 equals -0.0, NaN equals nothing). The first of them
/// stays; the vertices that stay keep their order, and unused ones stay, too. Triangles keep their number, even if two
/// of their corners became one vertex. Returns how many vertices vanished. Linear time on average.
std::size_t weldVertices(Mesh& mesh);

/// For each position the number of the first that is exactly equal (0.0 equals -0.0, NaN equals nothing), which may be
/// its own. Linear time on average.
std::vector<std::uint32_t> firstAtSamePlace(std::vector<Vec3> positions);

/// The surface alone, as it is however it is drawn: no attributes, vertices at the same place joined, those that no
/// triangle uses dropped, the others in the order of their first use. Triangles keep their number and order.
Mesh surfaceOf(Mesh mesh);

/// Drops triangles with a corner whose position is not finite; the others keep their order, the vertices stay.
/// Returns how many were dropped.
std::size_t dropUnusableTriangles(Mesh& mesh);

}  // namespace sheaf::mesh
