// bench/experiments/chart: line charts as SVG.
#pragma once

#include <string>
#include <vector>

namespace sheaf::experiments {

struct ChartPoint {
  double x = 0.0;
  double y = 0.0;
};

struct ChartSeries {
  std::string name;
  std::vector<ChartPoint> points;
  bool line = true;     ///< false: marks alone
  bool dashed = false;  ///< without marks: for what is not measured
};

struct ChartAxis {
  std::string label;
  bool logarithmic = false;
  std::vector<double> ticks;  ///< ascending, at least two; the first and the last are the axis' ends
};

struct Chart {
  std::string title;
  ChartAxis x, y;
  std::vector<ChartSeries> series;  ///< at most eight, in the order of the legend; points beyond the axes are left out
};

/// 720 x 400, readable on light and on dark pages. The same text for the same chart.
std::string svgOf(const Chart& chart);

}  // namespace sheaf::experiments
