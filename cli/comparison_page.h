// cli/comparison_page: the report of `sheaf compare INPUT` for a browser.
#pragma once

#include <string>

#include "cli/comparison_report.h"
#include "core/task_pool.h"

namespace sheaf::cli {

/// A self-contained HTML file.
std::string comparisonPage(const ComparisonReport& report, TaskPool& pool);

}  // namespace sheaf::cli
