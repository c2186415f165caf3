#include "core/task_pool.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>

namespace sheaf {

namespace {

// oneTBB starts no more threads than there are cores unless it is told that it may, and of several such limits the
// lowest holds: so there is one for the process, above any pool's size.
void allowMoreThreadsThanCores() {
  static const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1024);
}

}  // namespace

struct TaskPool::Arena {
  explicit Arena(int threads) : arena(threads) {}
  tbb::task_arena arena;
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
  // Acquire and release here say what oneTBB sees to anyway, in a way that ThreadSanitizer can see too: what was
  // written before the call is seen by every worker, what workers write is seen after it.
  std::atomic<int> next{0};
  std::atomic<int> finished{0};
  const auto work = [&](int worker) {
    for (int piece = next.fetch_add(1, std::memory_order_acq_rel); piece < count;
         piece = next.fetch_add(1, std::memory_order_acq_rel))
      body(piece, worker);
    finished.fetch_add(1, std::memory_order_release);
  };
  arena_->arena.execute([&] { tbb::parallel_for(0, workers, work, tbb::simple_partitioner{}); });
  (void)finished.load(std::memory_order_acquire);
}

}  // namespace sheaf
