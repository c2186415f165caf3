#include "cli/cluster_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace sheaf::cli {
namespace {

std::string line(std::string_view head, std::string_view text) {
  return fmt::format("{:<12}{}\n", head, text);
}

std::string cutText(const CutRequest& request) {
  switch (request.by) {
    case CutBy::kCount:
      return fmt::format("{} clusters", request.count);
    case CutBy::kTolerance:
      return fmt::format("within {:.4g} % of a plane", 100.0 * request.tolerance);
    case CutBy::kFaces:
      return fmt::format("at most {} faces", request.count);
  }
  return {};
}

double meanFaces(const ClusterReport& report) {
  return static_cast<double>(report.faces) / report.figures.clusters;
}

double asFraction(const ClusterReport& report, double length) {
  return report.extent > 0.0 ? length / report.extent : 0.0;
}

}  // namespace

std::string clusterText(const ClusterReport& report) {
  const grouping::CutFigures& f = report.figures;
  const CutRequest& cut = report.request.cut;
  const grouping::CostWeights& w = cut.weights;
  const bool made = cut.from.empty();
  std::string text =
      line("mesh", fmt::format("{}: {} surface vertices, {} faces, {} component{}", report.name, report.vertices,
                               report.faces, report.components, report.components == 1 ? "" : "s"));
  text += line("cut", cutText(cut));
  text += line("clusters", fmt::format("{}", f.clusters));
  text += line("faces each", fmt::format("{} to {}, median {}, mean {:.1f}", f.least_faces, f.most_faces,
                                         f.median_faces, meanFaces(report)));
  text +=
      line("cost", fmt::format("at most {:.4f}", f.max_cost) +
                       (made ? fmt::format("; weights {:g}, {:g}, {:g}, {:g}", w.fit, w.direction, w.shape, w.balance)
                             : std::string()));
  text += line("planarity",
               fmt::format("max {:.4f} %, RMS {:.4f} % of the extent", 100.0 * asFraction(report, f.max_distance),
                           100.0 * asFraction(report, f.rms_distance)));
  return text + line("time", fmt::format("{:.1f} ms", report.ms) +
                                 (made ? std::string() : fmt::format(" to load {}", cut.from)));
}

std::string clusterJson(const ClusterReport& report) {
  using Json = nlohmann::ordered_json;
  const grouping::CutFigures& f = report.figures;
  const CutRequest& request = report.request.cut;
  const grouping::CostWeights& w = request.weights;
  const bool made = request.from.empty();
  Json weights;  // those of a saved hierarchy are not known
  if (made) weights = {{"fit", w.fit}, {"direction", w.direction}, {"shape", w.shape}, {"balance", w.balance}};
  Json cut = {{"clusters", nullptr}, {"tolerance", nullptr}, {"max_faces", nullptr}};
  if (request.by == CutBy::kCount) cut["clusters"] = request.count;
  if (request.by == CutBy::kTolerance) cut["tolerance"] = request.tolerance;
  if (request.by == CutBy::kFaces) cut["max_faces"] = request.count;
  const Json json = {
      {"name", report.name},
      {"surface_vertices", report.vertices},
      {"faces", report.faces},
      {"components", report.components},
      {"extent", report.extent},
      {"from", made ? Json() : Json(request.from)},
      {"weights", weights},
      {"cut", cut},
      {"clusters", f.clusters},
      {"faces_per_cluster",
       {{"min", f.least_faces}, {"median", f.median_faces}, {"mean", meanFaces(report)}, {"max", f.most_faces}}},
      {"max_cost", f.max_cost},
      {"planarity_fraction",
       {{"max", asFraction(report, f.max_distance)}, {"rms", asFraction(report, f.rms_distance)}}},
      {made ? "cluster_ms" : "load_ms", report.ms},
      {"warnings", report.warnings}};
  // Names come from files and need not be UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sheaf::cli
