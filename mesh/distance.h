// mesh/distance: how far two surfaces are from each other, by samples.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/task_pool.h"
#include "mesh/mesh.h"

namespace sheaf::mesh {

/// Of the distances of sample points on one surface to the nearest point of the other, in the unit of the meshes.
struct DistanceStats {
  double max = 0.0;
  double mean = 0.0;
  double rms = 0.0;
  std::size_t samples = 0;
};

/// Distances of points of `from` to the surface of `to`. The maximum is a lower bound of the one-sided Hausdorff
/// distance; it counts every vertex that a triangle uses and the samples. Mean and RMS are of the samples alone, which
/// are spread evenly by area. If either mesh has no usable triangle, everything is 0 and `samples` is 0.
/// samples  at least 1
/// Deterministic; O((samples + #V) log #F).
DistanceStats distanceToSurface(const Mesh& from, const Mesh& to, std::size_t samples, TaskPool& pool);

struct SurfaceDistance {
  DistanceStats forward;   ///< from the first mesh to the second
  DistanceStats backward;  ///< from the second to the first

  double hausdorff() const { return std::max(forward.max, backward.max); }
  double rms() const { return std::sqrt(0.5 * (forward.rms * forward.rms + backward.rms * backward.rms)); }
};

/// Both ways, with `samples` each.
SurfaceDistance distanceBetween(const Mesh& a, const Mesh& b, std::size_t samples, TaskPool& pool);

}  // namespace sheaf::mesh
