// bench/experiments/rounds: several ways of doing the same, timed in turns, so that what disturbs the machine disturbs
// all of them.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace sheaf::experiments {

struct Spread {
  double median = 0.0;
  double lower = 0.0;  ///< quartiles
  double upper = 0.0;
};
/// values  at least one
Spread spreadOf(std::vector<double> values);

/// Nanoseconds of one call of each way. In each of `rounds` rounds every way is called `calls` times in a row, after
/// `warm` calls that do not count.
std::vector<Spread> timeInTurns(const std::vector<std::function<void()>>& ways, int rounds, int calls, int warm);

/// The processor as it calls itself, and the vectors that the kernels use.
std::string machineText();

}  // namespace sheaf::experiments
