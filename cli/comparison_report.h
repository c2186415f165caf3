// cli/comparison_report: what `sheaf compare INPUT` says.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pipeline/comparison.h"

namespace sheaf::cli {

struct ComparisonReport {
  pipeline::Comparison comparison;
  std::string input;
  std::size_t triangles = 0;        ///< of all instances
  bool limited = false;             ///< limits were given
  std::vector<std::string> beyond;  ///< options whose limit some view passes in quality
  std::vector<std::string> warnings;
};

/// Figures as people read them.
std::string comparisonText(const ComparisonReport& report);

/// Everything, each view included; warnings too.
std::string comparisonJson(const ComparisonReport& report);

}  // namespace sheaf::cli
