// core/task_pool: a fixed number of threads (oneTBB) that share out numbered pieces of work.
#pragma once

#include <functional>
#include <memory>

namespace sheaf {

/// Owns a oneTBB arena. A pool may be used from one thread at a time.
class TaskPool {
 public:
  /// threads  how many run at once, the caller included; 0 = one per available core
  explicit TaskPool(int threads = 0);
  ~TaskPool();
  TaskPool(const TaskPool&) = delete;
  TaskPool& operator=(const TaskPool&) = delete;

  int threadCount() const { return thread_count_; }

  /// Calls body(piece, worker) once for each piece in [0, count), and returns when all are done. Every worker in
  /// [0, min(count, threadCount())) has a share of neighbouring pieces, which it takes in ascending order; whoever is
  /// done takes from the far ends of the others' shares. So a worker mostly gets the same pieces in every call of the
  /// same count; where the same thread takes its part again, which oneTBB does not promise, they are in its caches.
  /// Each worker runs on one thread at a time: scratch memory may be indexed by it. The first exception that a body
  /// throws is rethrown here. Not to be called from a body.
  void parallelFor(int count, const std::function<void(int piece, int worker)>& body);

 private:
  struct Arena;
  int thread_count_;
  std::unique_ptr<Arena> arena_;
};

}  // namespace sheaf
