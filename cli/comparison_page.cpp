#include "cli/comparison_page.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/grouping_options.h"
#include "cli/html_page.h"

namespace sheaf::cli {
namespace {

using pipeline::Comparison;
using pipeline::ViewComparison;
using Tone = HtmlPage::Tone;

constexpr int kPictureSide = 960;

void addDrawing(const Comparison& comparison, TaskPool& pool, HtmlPage& page) {
  page.heading(2, "Is grouped drawing right?");
  const auto worst =
      std::max_element(comparison.views.begin(), comparison.views.end(), [](const auto& a, const auto& b) {
        return a.drawing.pixels.differing_pixels < b.drawing.pixels.differing_pixels;
      });
  const raster::ImageDifference& d = worst->drawing.pixels;
  const bool right = comparison.drawsRight();
  page.paragraph(right ? "Yes." : "No.", right ? Tone::kGood : Tone::kBad);
  const double allowed = 100.0 * pipeline::maxDrawingDifference(comparison.grouping.method);
  std::string text = "Against the snapped mesh, drawn ungrouped: the same vertices at the same places. ";
  if (d.differing_pixels == 0)
    text += fmt::format("Not a pixel differs in {} view{}.", comparison.views.size(),
                        comparison.views.size() == 1 ? "" : "s");
  else
    text += fmt::format("At worst, in view {}, {} pixels differ ({:.4f} %, {:.4g} % are allowed), by up to {} of 255.",
                        worst->camera.name, d.differing_pixels, 100.0 * d.differingFraction(), allowed, d.max_error);
  page.paragraph(text);
  if (right || comparison.snapped == comparison.grouped) return;
  const Image8 heat = smallHeatMap(comparison.snapped, comparison.grouped, kPictureSide);
  page.pictures({{&heat, "where grouped and ungrouped drawing of the snapped mesh differ"}}, pool);
}

void addQuality(const ComparisonReport& report, TaskPool& pool, HtmlPage& page) {
  const Comparison& comparison = report.comparison;
  page.heading(2, "What does grouping cost in quality?");
  page.paragraph(
      fmt::format("Against the original mesh, drawn ungrouped. The pictures are those of view {}, which has "
                  "the greatest RMS error.",
                  comparison.views[comparison.worst_view].camera.name));
  const Image8 original = smallPicture(comparison.original, kPictureSide);
  const Image8 grouped = smallPicture(comparison.grouped, kPictureSide);
  const Image8 heat = smallHeatMap(comparison.original, comparison.grouped, kPictureSide);
  page.pictures({{&original, "original"},
                 {&grouped, "grouped"},
                 {&heat, "difference: equal dark grey, else blue (1) to yellow (255)"}},
                pool);
  HtmlTable table;
  const bool many = comparison.views.size() > 1;
  table.head = many ? std::vector<std::string>{"", "worst", "in view", "mean"} : std::vector<std::string>{"", "value"};
  for (const QualityFigure& figure : qualityFigures(comparison)) {
    table.rows.push_back({figure.name, figure.worst});
    if (many) table.rows.back().insert(table.rows.back().end(), {figure.worst_view, figure.mean});
  }
  page.table(table);
}

void addViews(const Comparison& comparison, HtmlPage& page) {
  page.heading(2, "View by view");
  LineChart pixels{"view", "%", {}, {{"differing pixels, %", {}, 2}}};
  LineChart shift{"view", "px", {}, {{"silhouette, max", {}, 1}, {"silhouette, mean", {}, 2}}};
  HtmlTable table;
  const std::vector<QualityFigure> figures = qualityFigures(comparison);
  table.head = {"view"};
  for (const QualityFigure& figure : figures) table.head.push_back(figure.name);
  for (std::size_t v = 0; v < comparison.views.size(); ++v) {
    const ViewComparison& view = comparison.views[v];
    pixels.x_names.push_back(view.camera.name);
    shift.x_names.push_back(view.camera.name);
    pixels.lines[0].values.push_back(100.0 * view.quality.pixels.differingFraction());
    shift.lines[0].values.push_back(view.quality.silhouette.max_px);
    shift.lines[1].values.push_back(view.quality.silhouette.mean_px);
    table.rows.push_back({view.camera.name});
    for (const QualityFigure& figure : figures) table.rows.back().push_back(figure.views[v]);
  }
  page.lines(pixels);
  page.lines(shift);
  page.foldedTable("All views", table);
}

}  // namespace

std::string comparisonPage(const ComparisonReport& report, TaskPool& pool) {
  const Comparison& comparison = report.comparison;
  HtmlPage page(fmt::format("{}: pictures with and without vertex groups", report.context.input));
  page.paragraph(
      fmt::format("{} triangles; {}.", pipeline::withCommas(report.triangles), groupingText(comparison.grouping)));
  const bool good = comparison.drawsRight() && report.beyond.empty();
  page.paragraph(fmt::format("Verdict: {}.", verdictText(report)), good ? Tone::kGood : Tone::kBad);
  std::vector<Card> cards = {
      {fmt::format("{:.1f} %", 100.0 * comparison.geometry.eliminated()), "of the drawn vertices eliminated"},
      {fmt::format("{:.1f} %", 100.0 * comparison.drawn_by_groups), "of the patch vertices drawn by groups"}};
  for (const QualityFigure& figure : qualityFigures(comparison))
    if (figure.name == "differing pixels" || figure.name == "PSNR" || figure.name == "silhouette, mean")
      cards.push_back({figure.worst, figure.name + (comparison.views.size() > 1 ? ", worst view" : "")});
  page.cards(cards);
  addQuality(report, pool, page);
  addDrawing(comparison, pool, page);
  if (comparison.views.size() > 1) addViews(comparison, page);
  page.heading(2, "The mesh");
  page.facts(geometryFacts(comparison));
  page.heading(2, "Machine and build");
  page.facts(contextFacts(report.context));
  for (const std::string& warning : report.warnings) page.paragraph(fmt::format("Warning: {}", warning), Tone::kFaint);
  return std::move(page).finish();
}

}  // namespace sheaf::cli
