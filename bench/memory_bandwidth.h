// bench/memory_bandwidth: what the memory of this machine allows one thread, measured when first asked for. Benchmarks
// print beside their rate the one that they would reach if they did nothing but move the bytes that they must: "memory"
// stands before its name.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <string>
#include <vector>

namespace sheaf {

/// Bytes per second of one thread to and from memory, not caches.
struct MemoryBandwidth {
  double read;
  double write;
};

inline const MemoryBandwidth& memoryBandwidth() {
  static const MemoryBandwidth measured = [] {
    constexpr std::size_t kBytes = std::size_t{256} << 20U;  // more than caches hold
    constexpr int kPasses = 5;
    std::vector<std::uint64_t> words(kBytes / sizeof(std::uint64_t), 1);
    const auto best_of_passes = [&](const auto& pass) {
      double best_s = 1e9;
      for (int i = 0; i < kPasses; ++i) {
        const auto start = std::chrono::steady_clock::now();
        pass();
        best_s = std::min(best_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      }
      return static_cast<double>(kBytes) / best_s;
    };
    const double read = best_of_passes(
        [&] { benchmark::DoNotOptimize(std::accumulate(words.begin(), words.end(), std::uint64_t{0})); });
    const double write = best_of_passes([&] {
      std::memset(words.data(), 7, kBytes);
      benchmark::ClobberMemory();
    });
    return MemoryBandwidth{read, write};
  }();
  return measured;
}

/// What an item must read and write.
struct ItemBytes {
  double read = 0.0;
  double write = 0.0;
};

/// Seconds for an item that does nothing but move its bytes.
inline double memorySeconds(const ItemBytes& item) {
  return item.read / memoryBandwidth().read + item.write / memoryBandwidth().write;
}

/// Counter "memory_<name>": items per second at most, by memory alone.
inline void countMemoryBound(benchmark::State& state, const std::string& name, const ItemBytes& item) {
  state.counters["memory_" + name] = 1.0 / memorySeconds(item);
}

}  // namespace sheaf
