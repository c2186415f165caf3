#include "core/task_pool.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <vector>

namespace sheaf {

namespace {

// oneTBB starts no more threads than there are cores unless it is told that it may, and of several such limits the
// lowest holds: so there is one for the process, above any pool's size.
void allowMoreThreadsThanCores() {
  static const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1024);
}

// The pieces [begin, end) that are left of a worker's share; -1 when there are none. On a cache line of its own.
class alignas(64) Share {
 public:
  void set(int begin, int end) { range_.store(pack(begin, end), std::memory_order_release); }

  int takeFirst() {
    return take([](std::uint32_t& begin, std::uint32_t&) { return static_cast<int>(begin++); });
  }
  int takeLast() {
    return take([](std::uint32_t&, std::uint32_t& end) { return static_cast<int>(--end); });
  }

 private:
  static std::uint64_t pack(std::int64_t begin, std::int64_t end) {
    return static_cast<std::uint64_t>(begin) << 32 | static_cast<std::uint64_t>(end);
  }

  template <typename Take>
  int take(const Take& from) {
    std::uint64_t range = range_.load(std::memory_order_acquire);
    while (true) {
      auto begin = static_cast<std::uint32_t>(range >> 32), end = static_cast<std::uint32_t>(range);
      if (begin >= end) return -1;
      const int piece = from(begin, end);
      if (range_.compare_exchange_weak(range, pack(begin, end), std::memory_order_acq_rel)) return piece;
    }
  }

  std::atomic<std::uint64_t> range_{0};
};

}  // namespace

struct TaskPool::Arena {
  explicit Arena(int threads) : arena(threads), shares(static_cast<std::size_t>(threads)) {}
  tbb::task_arena arena;
  std::vector<Share> shares;  // of the call that is under way
};

TaskPool::TaskPool(int threads)
    : thread_count_(threads > 0 ? threads : std::max(1, tbb::this_task_arena::max_concurrency())),
      arena_(std::make_unique<Arena>(thread_count_)) {
  allowMoreThreadsThanCores();
}

TaskPool::~TaskPool() = default;

void TaskPool::parallelFor(int count, const std::function<void(int, int)>& body) {
  const int workers = std::min(count, thread_count_);
  if (workers <= 1) {
    for (int piece = 0; piece < count; ++piece) body(piece, 0);
    return;
  }
  std::vector<Share>& shares = arena_->shares;
  const auto beginOf = [&](int worker) { return static_cast<int>(std::int64_t{count} * worker / workers); };
  for (int w = 0; w < workers; ++w) shares[static_cast<std::size_t>(w)].set(beginOf(w), beginOf(w + 1));
  // Acquire and release here say what oneTBB sees to anyway, in a way that ThreadSanitizer can see too: what was
  // written before the call is seen by every worker, what workers write is seen after it.
  std::atomic<int> finished{0};
  const auto work = [&](int worker) {
    Share& own = shares[static_cast<std::size_t>(worker)];
    for (int piece = own.takeFirst(); piece >= 0; piece = own.takeFirst()) body(piece, worker);
    for (int w = 1; w < workers; ++w) {
      Share& other = shares[static_cast<std::size_t>((worker + w) % workers)];
      for (int piece = other.takeLast(); piece >= 0; piece = other.takeLast()) body(piece, worker);
    }
    finished.fetch_add(1, std::memory_order_release);
  };
  arena_->arena.execute([&] { tbb::parallel_for(0, workers, work, tbb::simple_partitioner{}); });
  (void)finished.load(std::memory_order_acquire);
}

}  // namespace sheaf
