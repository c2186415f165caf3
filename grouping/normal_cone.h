// grouping/normal_cone: directions that all lie on one side, as an axis and an angle.
#pragma once

#include <span>

#include "core/math.h"
#include "grouping/patches.h"

namespace sheaf::grouping {

/// A narrow cone around the given unit normals; one that says nothing if there are none, or if they fill nearly a
/// half-space or more. It has a little room for whoever evaluates it in float.
NormalCone coneOf(std::span<const DVec3> normals);

/// A cone that holds both; one that says nothing if either does, or if it would be nearly a half-space or more.
NormalCone coneAround(const NormalCone& a, const NormalCone& b);

}  // namespace sheaf::grouping
