// grouping/position_hash: places as keys; 0 and -0 are the same.
#pragma once

#include <cstddef>
#include <functional>

#include "core/math.h"

namespace sheaf::grouping {

struct PositionHash {
  std::size_t operator()(const Vec3& p) const {
    std::size_t hash = 0;
    for (int k = 0; k < 3; ++k) hash = (hash ^ std::hash<float>{}(p[k])) * 0x9E3779B97F4A7C15U;
    return hash ^ hash >> 32;
  }
};

}  // namespace sheaf::grouping
