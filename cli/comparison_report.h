// cli/comparison_report: what `sheaf compare INPUT` says.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/comparison.h"
#include "pipeline/timing_report.h"

namespace sheaf::cli {

struct ComparisonReport {
  pipeline::RunContext context;
  pipeline::Comparison comparison;
  std::size_t triangles = 0;        ///< of all instances
  bool limited = false;             ///< limits were given
  std::vector<std::string> beyond;  ///< options whose limit some view passes in quality
  std::vector<std::string> warnings;
};

/// One figure of quality over all views.
struct QualityFigure {
  std::string name;                ///< "RMS error"
  std::string worst;               ///< with its unit
  std::string worst_view;          ///< the first that has it
  std::string mean;                ///< over the views
  std::vector<std::string> views;  ///< in each
};

std::vector<QualityFigure> qualityFigures(const pipeline::Comparison& comparison);

/// What is known of the mesh rather than of its pictures, name and value: displacement, bytes per vertex ...
std::vector<std::pair<std::string, std::string>> geometryFacts(const pipeline::Comparison& comparison);

/// "drawn right, quality within the limits"
std::string verdictText(const ComparisonReport& report);

/// Figures as people read them.
std::string comparisonText(const ComparisonReport& report);

/// Everything, each view included; warnings too.
std::string comparisonJson(const ComparisonReport& report);

}  // namespace sheaf::cli
