// grouping/direction_groups: normals as points on the unit sphere, grouped on planes ([PG] 7, future work).
#pragma once

#include <span>
#include <vector>

#include "grouping/planar_groups.h"

namespace sheaf::grouping {

/// Vertices of `groups` are the distinct directions, so that equal normals cost one transform.
struct DirectionGroups {
  std::vector<Vec3> directions;          ///< distinct, in the order of their first use
  std::vector<std::uint32_t> direction;  ///< beside the input: which of them it is
  VertexGroups groups;                   ///< its positions are not unit vectors: normalise after the transform
  double angle_max_rad = 0.0;            ///< between a direction and its snapped position
};

/// Epsilon is a fraction of 2, the edge of the sphere's box, whatever part of the sphere is covered; a direction turns
/// by at most asin(2 * epsilon). Under clip_from_object's linear part M directions go with N = inverse(transpose(M)):
/// N W = N base + s N axis_s + t N axis_t.
/// normals  unit length; the metric is kDistance
DirectionGroups groupDirections(std::span<const Vec3> normals, const PlanarOptions& options);

}  // namespace sheaf::grouping
