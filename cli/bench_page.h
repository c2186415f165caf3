// cli/bench_page: the report of `sheaf bench` for a browser.
#pragma once

#include <string>

#include "cli/bench_report.h"
#include "core/task_pool.h"

namespace sheaf::cli {

/// A self-contained HTML file.
std::string benchPage(const BenchReport& report, TaskPool& pool);

}  // namespace sheaf::cli
