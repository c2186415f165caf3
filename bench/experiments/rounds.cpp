#include "bench/experiments/rounds.h"

#include <fmt/format.h>
#include <hwy/highway.h>

#include <algorithm>
#include <fstream>

#include "core/stage_timer.h"

namespace sheaf::experiments {

Spread spreadOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {values[n / 2], values[n / 4], values[n - 1 - n / 4]};
}

std::vector<Spread> timeInTurns(const std::vector<std::function<void()>>& ways, int rounds, int calls, int warm) {
  std::vector<std::vector<double>> times(ways.size());
  for (int round = 0; round < rounds; ++round)
    for (std::size_t w = 0; w < ways.size(); ++w) {
      for (int i = 0; i < warm; ++i) ways[w]();
      const std::int64_t begin_ns = nowNs();
      for (int i = 0; i < calls; ++i) ways[w]();
      times[w].push_back(static_cast<double>(nowNs() - begin_ns) / calls);
    }
  std::vector<Spread> spreads;
  for (std::vector<double>& t : times) spreads.push_back(spreadOf(std::move(t)));
  return spreads;
}

std::string machineText() {
  std::ifstream info("/proc/cpuinfo");
  std::string model, family;
  for (std::string line; std::getline(info, line);) {
    const std::size_t value = line.find(": ");
    if (value == std::string::npos) continue;
    if (model.empty() && line.starts_with("model name")) model = line.substr(value + 2);
    if (family.empty() && line.starts_with("cpu family")) family = line.substr(value + 2);
  }
  const std::int64_t best = hwy::SupportedTargets() & -hwy::SupportedTargets();
  return fmt::format("{}, family {}, {}", model, family, hwy::TargetName(best));
}

}  // namespace sheaf::experiments
