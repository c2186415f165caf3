#include "cli/comparison_report.h"

#include <fmt/format.h>

#include <cmath>

#include "cli/difference_report.h"
#include "cli/grouping_options.h"

namespace sheaf::cli {
namespace {

using Json = nlohmann::ordered_json;
using pipeline::Comparison;
using pipeline::PictureDifference;
using pipeline::ViewComparison;

/// A figure of a view's quality.
struct Figure {
  const char* name;
  double (*of)(const PictureDifference&);
  std::string (*text)(double);
  bool less_is_worse = false;
};

std::string pixels(double px) {
  return std::isinf(px) ? "all" : fmt::format("{:.2f} px", px);
}

constexpr Figure kFigures[] = {
    {"differing pixels", [](const PictureDifference& d) { return 100.0 * d.pixels.differingFraction(); },
     [](double percent) { return fmt::format("{:.3f} %", percent); }},
    {"max error", [](const PictureDifference& d) { return static_cast<double>(d.pixels.max_error); },
     [](double error) { return fmt::format("{:.0f}/255", error); }},
    {"RMS error", [](const PictureDifference& d) { return d.pixels.rms; },
     [](double rms) { return fmt::format("{:.3f}/255", rms); }},
    {"PSNR", [](const PictureDifference& d) { return d.pixels.psnr_db; },
     [](double db) { return std::isinf(db) ? std::string("infinite") : fmt::format("{:.2f} dB", db); }, true},
    {"silhouette, max", [](const PictureDifference& d) { return d.silhouette.max_px; }, pixels},
    {"silhouette, mean", [](const PictureDifference& d) { return d.silhouette.mean_px; }, pixels},
};

/// The first of the worst.
const ViewComparison& worstView(const Comparison& comparison, const Figure& figure) {
  const ViewComparison* worst = &comparison.views.front();
  for (const ViewComparison& view : comparison.views) {
    const double here = figure.of(view.quality);
    const double there = figure.of(worst->quality);
    if (figure.less_is_worse ? here < there : here > there) worst = &view;
  }
  return *worst;
}

double meanOf(const Comparison& comparison, const Figure& figure) {
  double sum = 0.0;
  for (const ViewComparison& view : comparison.views) sum += figure.of(view.quality);
  return sum / static_cast<double>(comparison.views.size());
}

std::string line(std::string_view head, std::string_view text) {
  return fmt::format("{:<20}{}\n", head, text);
}

std::string drawingText(const Comparison& comparison) {
  std::string text = "Is grouped drawing right? Against the snapped mesh drawn ungrouped:\n";
  const std::size_t views = comparison.views.size();
  std::size_t differing = 0;
  const ViewComparison* worst = &comparison.views.front();
  for (const ViewComparison& view : comparison.views) {
    if (view.drawing.pixels.differing_pixels > 0) ++differing;
    if (view.drawing.pixels.differing_pixels > worst->drawing.pixels.differing_pixels) worst = &view;
  }
  if (differing == 0)
    return text + line("  pictures", views == 1 ? "equal" : fmt::format("equal in all {} views", views));
  const raster::ImageDifference& d = worst->drawing.pixels;
  text += line("  pictures", fmt::format("differ in {} of {} view{}", differing, views, views == 1 ? "" : "s"));
  text += line("  worst", fmt::format("{}: {} pixels ({:.4f} %), by up to {}/255", worst->camera.name,
                                      d.differing_pixels, 100.0 * d.differingFraction(), d.max_error));
  const double allowed = pipeline::maxDrawingDifference(comparison.grouping.method);
  return text + line("  allowed", allowed > 0.0 ? fmt::format("{:.4g} %: lines and planes of patches round otherwise",
                                                              100.0 * allowed)
                                                : std::string("none"));
}

std::string qualityText(const Comparison& comparison) {
  std::string text = "What does grouping cost in quality? Against the original mesh:\n";
  const bool many = comparison.views.size() > 1;
  if (many) text += fmt::format("  {:<18}{:>12}  {:<16}{:>12}\n", "", "worst", "in view", "mean");
  for (const QualityFigure& figure : qualityFigures(comparison)) {
    text += fmt::format("  {:<18}{:>12}", figure.name, figure.worst);
    if (many) text += fmt::format("  {:<16}{:>12}", figure.worst_view, figure.mean);
    text += "\n";
  }
  return text;
}

Json silhouetteJson(const raster::SilhouetteShift& s) {
  return {{"max_px", finiteOrNull(s.max_px)},
          {"mean_px", finiteOrNull(s.mean_px)},
          {"edge_pixels", {s.edge_pixels_a, s.edge_pixels_b}}};
}

Json differenceJson(const PictureDifference& difference) {
  Json json = toJson(difference.pixels);
  json["silhouette_shift"] = silhouetteJson(difference.silhouette);
  return json;
}

}  // namespace

std::vector<QualityFigure> qualityFigures(const Comparison& comparison) {
  std::vector<QualityFigure> result;
  for (const Figure& figure : kFigures) {
    const ViewComparison& worst = worstView(comparison, figure);
    result.push_back({figure.name,
                      figure.text(figure.of(worst.quality)),
                      worst.camera.name,
                      figure.text(meanOf(comparison, figure)),
                      {}});
    for (const ViewComparison& view : comparison.views)
      result.back().views.push_back(figure.text(figure.of(view.quality)));
  }
  return result;
}

std::vector<std::pair<std::string, std::string>> geometryFacts(const Comparison& comparison) {
  const pipeline::GeometricError& g = comparison.geometry;
  const double original = comparison.original_bytes_per_vertex;
  const double grouped = comparison.grouped_bytes_per_vertex;
  return {{"eliminated",
           fmt::format("{:.2f} % ({} of {} drawn vertices in use)", 100.0 * g.eliminated(), g.grouped, g.vertices)},
          {"drawn by groups", drawnByGroupsText(comparison.drawn_by_groups, comparison.grouping)},
          {"displacement",
           fmt::format("max {:.3f} %, mean {:.3f} %, RMS {:.3f} % of the extent", 100.0 * g.displacement_max,
                       100.0 * g.displacement_mean, 100.0 * g.displacement_rms)},
          {"normal deviation", fmt::format("max {:.1f}, RMS {:.2f} degrees", degrees(g.normal_deviation_max_rad),
                                           degrees(g.normal_deviation_rms_rad))},
          {"faces", fmt::format("{} flipped, {} collapsed", g.flipped_faces, g.collapsed_faces)},
          {"bytes per vertex", fmt::format("{:.2f} original, {:.2f} grouped ({:.0f} %), by patch vertices", original,
                                           grouped, original > 0.0 ? 100.0 * grouped / original : 0.0)}};
}

std::string verdictText(const ComparisonReport& report) {
  std::string text = report.comparison.drawsRight() ? "drawn right" : "NOT drawn right";
  if (report.beyond.empty()) return text + (report.limited ? ", quality within the limits" : "");
  text += ", quality beyond";
  for (const std::string& option : report.beyond) text += fmt::format(" {}", option);
  return text;
}

std::string comparisonText(const ComparisonReport& report) {
  const Comparison& c = report.comparison;
  std::string text = line("scene", fmt::format("{}, {} triangles", report.context.input, report.triangles));
  text += line("groups", groupingText(c.grouping));
  text += line("views", fmt::format("{} of {}x{} pixels", c.views.size(), c.original.width(), c.original.height()));
  text += fmt::format("\n{}\n{}\n", drawingText(c), qualityText(c));
  for (const auto& [name, value] : geometryFacts(c)) text += line(name, value);
  return text + fmt::format("\n{}", line("verdict", verdictText(report)));
}

std::string comparisonJson(const ComparisonReport& report) {
  const Comparison& c = report.comparison;
  const pipeline::GeometricError& g = c.geometry;
  Json views = Json::array();
  for (const ViewComparison& view : c.views)
    views.push_back({{"name", view.camera.name},
                     {"eye", {view.camera.eye.x, view.camera.eye.y, view.camera.eye.z}},
                     {"drawing", differenceJson(view.drawing)},
                     {"quality", differenceJson(view.quality)}});
  const Json json = {
      {"context", Json::parse(pipeline::toJson(report.context))},
      {"triangles", report.triangles},
      {"grouping", groupingJson(c.grouping)},
      {"drawing_right", c.drawsRight()},
      {"drawing_allowed_fraction", pipeline::maxDrawingDifference(c.grouping.method)},
      {"within_limits", report.beyond.empty()},
      {"beyond", report.beyond},
      {"worst_view", c.worst_view},
      {"views", std::move(views)},
      {"drawn_vertices", g.vertices},
      {"grouped_vertices", g.grouped},
      {"eliminated_fraction", g.eliminated()},
      {"drawn_by_groups_fraction", c.drawn_by_groups},
      {"displacement_fraction",
       {{"max", g.displacement_max}, {"mean", g.displacement_mean}, {"rms", g.displacement_rms}}},
      {"normal_deviation_degrees",
       {{"max", degrees(g.normal_deviation_max_rad)}, {"rms", degrees(g.normal_deviation_rms_rad)}}},
      {"flipped_faces", g.flipped_faces},
      {"collapsed_faces", g.collapsed_faces},
      {"bytes_per_vertex", {{"original", c.original_bytes_per_vertex}, {"grouped", c.grouped_bytes_per_vertex}}},
      {"search_ms", g.search_ms},
      {"warnings", report.warnings}};
  // Names come from files and need not be UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sheaf::cli
