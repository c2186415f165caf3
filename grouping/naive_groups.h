// grouping/naive_groups: the searches as they are written down, without any acceleration. Slow; kept to check the fast
// ones against and to time them.
#pragma once

#include "grouping/linear_groups.h"
#include "grouping/planar_groups.h"

namespace sheaf::grouping {

/// Equal to groupPlanar(), times aside. O(n^2); with TableKey::kDynamic O(n^3).
VertexGroups naiveGroupPlanar(const mesh::Mesh& mesh, const PlanarOptions& options);

/// Equal to groupLinear() for a set that fits in one cell, times aside. O(n^3). Does not report progress.
VertexGroups naiveGroupLinear(const mesh::Mesh& mesh, const LinearOptions& options);

}  // namespace sheaf::grouping
