// bench/peers/core_distance: how long a cache line takes from one core to another.
#pragma once

namespace sheaf::peers {

/// One way, in nanoseconds, between the first two processors that this process may use: half of a round trip, the mean
/// of many. 0 if there is only one. Virtual machines may move between some 50 ns, both processors at one cache, and
/// 200.
double coreDistanceNs();

}  // namespace sheaf::peers
