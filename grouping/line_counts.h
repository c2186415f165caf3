// grouping/line_counts: how many vertices would each line take? Exact, in near O(m^2) for m vertices.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "grouping/line_test.h"

namespace sheaf::grouping {

/// Counts for all pairs of the given vertices: those of (0, 1), (0, 2) ... (1, 2) ... in this order; 0 for a pair that
/// is no line. Stops early, returning nothing, if `proceed` (called once for each first vertex) says no. cell  at most
/// 65535 vertices, numbered as in `test`
std::vector<std::uint16_t> countTakenByLines(const LineTest& test, std::span<const std::uint32_t> cell, bool flat,
                                             const std::function<bool(std::uint32_t first)>& proceed);

}  // namespace sheaf::grouping
