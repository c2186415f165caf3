#include "bench/experiments/chart.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>

namespace sheaf::experiments {
namespace {

constexpr double kWidth = 720.0, kHeight = 400.0;
constexpr double kLeft = 64.0, kRight = 200.0, kTop = 36.0, kBottom = 52.0;
// Told apart by most eyes with a colour deficiency [OI08].
constexpr std::array<std::string_view, 8> kColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                     "#56b4e9", "#e69f00", "#888888", "#444444"};

// A value's place along an axis, 0 at its first tick and 1 at its last.
double placeOn(const ChartAxis& axis, double value) {
  const auto scaled = [&](double v) { return axis.logarithmic ? std::log(v) : v; };
  const double first = scaled(axis.ticks.front()), last = scaled(axis.ticks.back());
  return (scaled(value) - first) / (last - first);
}

double pixelX(const Chart& chart, double x) {
  return kLeft + placeOn(chart.x, x) * (kWidth - kLeft - kRight);
}

double pixelY(const Chart& chart, double y) {
  return kHeight - kBottom - placeOn(chart.y, y) * (kHeight - kTop - kBottom);
}

std::string tickText(double value) {
  if (value >= 1e6) return fmt::format("{:g} M", value / 1e6);
  if (value >= 1e4) return fmt::format("{:g} k", value / 1e3);
  return fmt::format("{:g}", value);
}

std::string text(double x, double y, std::string_view anchor, std::string_view content, std::string_view more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, more, content);
}

std::string line(double x0, double y0, double x1, double y1, std::string_view style) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x0, y0, x1, y1, style);
}

std::string axesOf(const Chart& chart) {
  constexpr std::string_view kGrid = "stroke=\"#dddddd\"";
  const double right = kWidth - kRight, bottom = kHeight - kBottom;
  std::string svg;
  for (const double tick : chart.x.ticks) {
    const double x = pixelX(chart, tick);
    svg += line(x, kTop, x, bottom, kGrid) + text(x, bottom + 18.0, "middle", tickText(tick));
  }
  for (const double tick : chart.y.ticks) {
    const double y = pixelY(chart, tick);
    svg += line(kLeft, y, right, y, kGrid) + text(kLeft - 8.0, y + 4.0, "end", tickText(tick));
  }
  svg += text(0.5 * (kLeft + right), kHeight - 12.0, "middle", chart.x.label);
  const double middle = 0.5 * (kTop + bottom);
  return svg + text(16.0, middle, "middle", chart.y.label, fmt::format(" transform=\"rotate(-90 16 {:.1f})\"", middle));
}

bool isWithin(const Chart& chart, const ChartPoint& p) {
  const auto within = [](const ChartAxis& axis, double v) { return v >= axis.ticks.front() && v <= axis.ticks.back(); };
  return within(chart.x, p.x) && within(chart.y, p.y);
}

std::string curveOf(const Chart& chart, const ChartSeries& series, std::string_view color) {
  std::string path, marks;
  for (const ChartPoint& p : series.points) {
    if (!isWithin(chart, p)) continue;
    const double x = pixelX(chart, p.x), y = pixelY(chart, p.y);
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : " L", x, y);
    if (!series.dashed)
      marks += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"{}\"/>\n", x, y, color);
  }
  if (!series.line) return marks;
  return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"{}/>\n", path, color,
                     series.dashed ? " stroke-dasharray=\"6 4\"" : "") +
         marks;
}

std::string legendOf(const ChartSeries& series, std::string_view color, double y) {
  const double x = kWidth - kRight + 14.0;
  std::string svg;
  if (series.line)
    svg += line(
        x, y - 4.0, x + 22.0, y - 4.0,
        fmt::format("stroke=\"{}\" stroke-width=\"2\"{}", color, series.dashed ? " stroke-dasharray=\"6 4\"" : ""));
  if (!series.dashed)
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"{}\"/>\n", x + 11.0, y - 4.0, color);
  return svg + text(x + 28.0, y, "start", series.name);
}

}  // namespace

std::string svgOf(const Chart& chart) {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 0 {0:g} {1:g}\" "
      "font-family=\"sans-serif\" font-size=\"12\" fill=\"#222222\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
      kWidth, kHeight);
  svg += text(kLeft, 22.0, "start", chart.title, " font-size=\"14\" font-weight=\"bold\"");
  svg += axesOf(chart);
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    svg += curveOf(chart, chart.series[i], kColors[i]);
    svg += legendOf(chart.series[i], kColors[i], kTop + 14.0 + 20.0 * static_cast<double>(i));
  }
  return svg + "</svg>\n";
}

}  // namespace sheaf::experiments
