// cli/bench_report: what `sheaf bench` says.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/baselines.h"
#include "pipeline/comparison.h"

namespace sheaf::cli {

/// The frames along one row of cameras.
struct BenchSection {
  std::string name;
  std::optional<double> share_in_view;  ///< of triangles, where the cameras were chosen for it
  std::size_t views = 0;
  pipeline::BaselineRun run;
};

struct BenchReport {
  pipeline::RunContext context;
  pipeline::GroupingOptions grouping;
  pipeline::GeometricError geometry;
  std::uint64_t triangles = 0;   ///< of all instances
  std::uint64_t vertices = 0;    ///< of all instances and patches
  double drawn_by_groups = 0.0;  ///< pipeline::shareDrawnByGroups()
  double original_bytes_per_vertex = 0.0;
  double grouped_bytes_per_vertex = 0.0;
  std::vector<BenchSection> sections;
  std::vector<std::string> warnings;
};

/// Tables for people.
std::string benchText(const BenchReport& report);

/// Everything, the times of each frame included; warnings too.
std::string benchJson(const BenchReport& report);

}  // namespace sheaf::cli
