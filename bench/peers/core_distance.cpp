#include "bench/peers/core_distance.h"

#include <pthread.h>
#include <sched.h>

#include <atomic>
#include <thread>
#include <vector>

#include "core/stage_timer.h"

namespace sheaf::peers {
namespace {

std::vector<int> allowedProcessors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  std::vector<int> processors;
  if (sched_getaffinity(0, sizeof set, &set) != 0) return processors;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(cpu, &set)) processors.push_back(cpu);
  return processors;
}

void stayOn(int processor) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(processor, &set);
  pthread_setaffinity_np(pthread_self(), sizeof set, &set);
}

}  // namespace

double coreDistanceNs() {
  constexpr int kWarmTrips = 1000, kTrips = 20000;
  const std::vector<int> processors = allowedProcessors();
  if (processors.size() < 2) return 0.0;
  alignas(128) std::atomic<int> ball{0};  // even: the first has it
  double ns = 0.0;
  std::thread first([&] {
    stayOn(processors[0]);
    std::int64_t start = 0;
    for (int i = 0; i < kWarmTrips + kTrips; ++i) {
      if (i == kWarmTrips) start = nowNs();
      ball.store(2 * i + 1, std::memory_order_release);
      while (ball.load(std::memory_order_acquire) != 2 * i + 2) {
      }
    }
    ns = static_cast<double>(nowNs() - start) / (2.0 * kTrips);
  });
  std::thread second([&] {
    stayOn(processors[1]);
    for (int i = 0; i < kWarmTrips + kTrips; ++i) {
      while (ball.load(std::memory_order_acquire) != 2 * i + 1) {
      }
      ball.store(2 * i + 2, std::memory_order_release);
    }
  });
  first.join();
  second.join();
  return ns;
}

}  // namespace sheaf::peers
