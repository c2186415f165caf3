// bench/grouping/peak_memory: how much the heap has grown, for this program alone: it replaces operator new and delete.
#pragma once

#include <cstddef>

namespace sheaf::bench {

/// Starts a new measurement.
void resetPeakMemory();
/// Bytes by which the heap was largest since then, compared with its start.
std::size_t peakMemory();

}  // namespace sheaf::bench
