// grouping/cluster_queries: rays, points and other meshes against a mesh, through the boxes of its face clusters [HFC].
//   In     a mesh and the hierarchy of its faces; both stay as they are, so queries may run at the same time
//   Out    what a loop over all faces would find, to the bit; of equals the face of the lowest number
//   Method from the roots down, nearer part first; a cluster whose oriented box is too far away is left out. Boxes are
//          taken a little larger than they are, so that round-off never hides a face
//   Knows  faces without area, which only the closest point finds, and faces with a corner that is not finite, which
//          no query finds
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "grouping/face_clusters.h"

namespace sheaf::grouping {

/// origin + t * direction, t in [t_min, t_max]; the direction is not zero and of any length.
struct Ray {
  DVec3 origin{0.0};
  DVec3 direction{0.0, 0.0, 1.0};
  double t_min = 0.0;
  double t_max = std::numeric_limits<double>::infinity();
};

struct RayHit {
  std::uint32_t face = 0;
  double t = 0.0;
  bool operator==(const RayHit&) const = default;
};

/// The least t, from either side of the faces.
std::optional<RayHit> closestHit(const mesh::Mesh& mesh, const FaceClusters& clusters, const Ray& ray);

struct SurfacePoint {
  std::uint32_t face = 0;
  DVec3 position{0.0};
  double distance = 0.0;
  bool operator==(const SurfacePoint&) const = default;
};

/// The point of the mesh nearest to `point`; nothing if there is no face, or none within max_distance.
std::optional<SurfacePoint> closestPoint(const mesh::Mesh& mesh, const FaceClusters& clusters, const DVec3& point,
                                         double max_distance = std::numeric_limits<double>::infinity());

/// A mesh with its hierarchy, to be held against another.
struct ClusteredMesh {
  const mesh::Mesh& mesh;
  const FaceClusters& clusters;
};

struct FacePair {
  std::uint32_t a = 0, b = 0;
  auto operator<=>(const FacePair&) const = default;
};

/// Faces of a and b that have a point in common (mesh::overlap), ascending. One mesh against itself finds neighbours
/// too.
/// a_from_b  where b stands: a rigid motion
/// most      stop as soon as so many are found, whichever these are: 1 asks whether there are any
std::vector<FacePair> overlappingFaces(const ClusteredMesh& a, const ClusteredMesh& b,
                                       const DMat4& a_from_b = DMat4(1.0),
                                       std::size_t most = std::numeric_limits<std::size_t>::max());

}  // namespace sheaf::grouping
