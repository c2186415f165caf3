// mesh/triangle_queries: one triangle and a point, a ray, another triangle. Double precision; no use is made of which
// way a triangle turns.
#pragma once

#include <array>
#include <optional>

#include "core/math.h"

namespace sheaf::mesh {

using Corners = std::array<DVec3, 3>;

/// The point of the triangle nearest to p [E05]; a triangle without area answers with its corners and edges.
DVec3 closestPoint(const Corners& t, const DVec3& p);

/// Where the line origin + t * direction meets the triangle: t, of any sign. Edges and corners belong to it, and a line
/// through an edge that two triangles share meets one of them at least, since the edge is judged with the same bits for
/// both. Nothing for a triangle without area and one seen edge-on.
std::optional<double> meetLine(const Corners& triangle, const DVec3& origin, const DVec3& direction);

/// Whether the two have a point in common, by separating axes. Where they only touch, round-off decides. A triangle
/// without area never overlaps.
bool overlap(const Corners& a, const Corners& b);

}  // namespace sheaf::mesh
