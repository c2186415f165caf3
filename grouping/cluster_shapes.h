// grouping/cluster_shapes: where a face cluster lies and how far it reaches: plane, oriented box, normal cone.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "core/math.h"
#include "grouping/patches.h"
#include "grouping/vertex_groups.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

/// Object space. The plane that fits the corners best goes through `center` at right angles to frame.normal, which is
/// on the side of the area vector; axis_s is the direction in which the corners spread most. Corners and normals of the
/// faces as they are in the mesh, whichever way they turn. Faces with a corner that is not finite do not count.
struct ClusterShape {
  Vec3 center{0.0F};  ///< mean of the corners, one per face that has it
  PlaneFrame frame{{0.0F, 0.0F, 1.0F}, {1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}};
  Vec3 lo{0.0F};  ///< the oriented box: every corner p has lo <= (s, t, n) <= hi, where s = dot(p - center, axis_s) and
  Vec3 hi{0.0F};  ///< so on, in double precision
  Vec3 area_vector{0.0F};
  float area = 0.0F;
  float rms_distance = 0.0F;  ///< of the corners to the plane
  NormalCone cone;

  /// Of a corner to the plane, at most.
  float maxDistance() const { return std::max(-lo.z, hi.z); }
  bool operator==(const ClusterShape&) const = default;
};

/// Whether these could be the figures of a cluster: no NaN, an orthonormal frame, lo <= hi, nothing below 0.
bool isSound(const ClusterShape& shape);

/// Of any set of faces.
ClusterShape shapeOfFaces(const mesh::Mesh& mesh, std::span<const std::uint32_t> faces);

}  // namespace sheaf::grouping
