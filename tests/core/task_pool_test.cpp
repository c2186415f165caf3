#include "core/task_pool.h"

#include <doctest/doctest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace sheaf {

TEST_CASE("core/task_pool: every piece runs once, on a worker in range") {
  for (const int threads : {1, 2, 7}) {
    TaskPool pool(threads);
    std::vector<std::atomic<int>> runs(1000);
    std::atomic<bool> worker_in_range{true};
    pool.parallelFor(1000, [&](int piece, int worker) {
      ++runs[static_cast<std::size_t>(piece)];
      if (worker < 0 || worker >= threads) worker_in_range = false;
    });
    CHECK(worker_in_range);
    for (const auto& count : runs) CHECK(count == 1);
  }
}

TEST_CASE("core/task_pool: no piece, no call") {
  TaskPool pool(2);
  pool.parallelFor(0, [](int, int) { FAIL("called"); });
}

TEST_CASE("core/task_pool: an exception of a piece reaches the caller") {
  TaskPool pool(2);
  CHECK_THROWS_AS(pool.parallelFor(100,
                                   [](int piece, int) {
                                     if (piece == 37) throw std::runtime_error("37");
                                   }),
                  std::runtime_error);
}

}  // namespace sheaf
