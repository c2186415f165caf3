#include "cli/group_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace sheaf::cli {
namespace {

using grouping::GroupingStats;
using grouping::GroupKind;
using grouping::Metric;
using grouping::VertexGroups;

std::string methodText(const GroupReport& report) {
  const VertexGroups& groups = report.groups;
  std::string text(nameOf(report.request.method, kMethodNames));
  if (groups.kind == GroupKind::kPlane)
    text += ", " + report.request.plane_set;
  else if (groups.segment_only)
    text += ", segments";
  return text + "; " + metricText(groups);
}

std::string line(std::string_view head, std::string_view text) {
  return fmt::format("{:<18}{}\n", head, text);
}

std::string facesText(const GroupingStats& stats) {
  std::string text = fmt::format("{} flipped, {} collapsed", stats.flipped_faces, stats.collapsed_faces);
  if (stats.restored_vertices > 0) text += fmt::format("; {} vertices set free to avoid that", stats.restored_vertices);
  return text;
}

}  // namespace

std::string metricText(const VertexGroups& groups) {
  std::string text = fmt::format("{} metric", nameOf(groups.metric, kMetricNames));
  if (groups.metric == Metric::kQuadric) text += fmt::format(", {} limit", nameOf(groups.limit, kLimitNames));
  return text;
}

std::string groupFacts(const VertexGroups& groups) {
  const GroupingStats& stats = groups.stats;
  std::string text = line("epsilon", fmt::format("{:.4g} % of {:.6g}", 100.0 * groups.epsilon, groups.extent));
  text += line("eliminated", fmt::format("{:.2f} % ({} of {} joined vertices in use)", 100.0 * stats.eliminated,
                                         stats.grouped, stats.vertices));
  text += line("retained",
               fmt::format("{} ({} defining, {} free)", stats.defining + stats.free, stats.defining, stats.free));
  text += line("groups", fmt::format("{}", groups.groups.size()));
  text += line("displacement",
               fmt::format("max {:.4f} %, mean {:.4f} %, RMS {:.4f} % of the extent", 100.0 * stats.displacement_max,
                           100.0 * stats.displacement_mean, 100.0 * stats.displacement_rms));
  text +=
      line("normal deviation", fmt::format("max {:.1f}, RMS {:.2f} degrees", degrees(stats.normal_deviation_max_rad),
                                           degrees(stats.normal_deviation_rms_rad)));
  return text + line("faces", facesText(stats));
}

nlohmann::ordered_json groupFactsJson(const VertexGroups& groups) {
  const GroupingStats& stats = groups.stats;
  nlohmann::ordered_json json = {
      {"extent", groups.extent},
      {"metric", nameOf(groups.metric, kMetricNames)},
      {"limit", nullptr},
      {"epsilon", groups.epsilon},
      {"planes", nullptr},
      {"segment_only", groups.segment_only},
      {"used_vertices", stats.vertices},
      {"eliminated_fraction", stats.eliminated},
      {"grouped_vertices", stats.grouped},
      {"defining_vertices", stats.defining},
      {"free_vertices", stats.free},
      {"groups", groups.groups.size()},
      {"displacement_fraction",
       {{"max", stats.displacement_max}, {"mean", stats.displacement_mean}, {"rms", stats.displacement_rms}}},
      {"normal_deviation_degrees",
       {{"max", degrees(stats.normal_deviation_max_rad)}, {"rms", degrees(stats.normal_deviation_rms_rad)}}},
      {"flipped_faces", stats.flipped_faces},
      {"collapsed_faces", stats.collapsed_faces},
      {"restored_vertices", stats.restored_vertices}};
  if (groups.metric == Metric::kQuadric) json["limit"] = nameOf(groups.limit, kLimitNames);
  if (groups.kind == GroupKind::kPlane) json["planes"] = groups.planes.size();
  return json;
}

std::string groupText(const GroupReport& report) {
  const grouping::CompressionFigures& c = report.compression;
  std::string text = line("mesh", fmt::format("{}: {} joined vertices, {} triangles", report.name, report.mesh_vertices,
                                              report.mesh_triangles));
  text += line("method", methodText(report));
  text += groupFacts(report.groups);
  text += line("bits per vertex",
               fmt::format("{:.1f} grouped, {:.0f} not, at {} bits a number", c.grouped(), c.plain_quantised, c.bits));
  text += line("  coded",
               fmt::format("{:.1f} grouped, {:.1f} not (meshoptimizer's vertex codec)", c.grouped_coded, c.coded));
  return text + line("time", fmt::format("{:.2f} ms", report.groups.stats.search_ms));
}

std::string groupJson(const GroupReport& report) {
  using Json = nlohmann::ordered_json;
  const grouping::CompressionFigures& c = report.compression;
  const GroupMethod method = report.request.method;
  Json json = {{"name", report.name},
               {"joined_vertices", report.mesh_vertices},
               {"triangles", report.mesh_triangles},
               {"method", nameOf(method, kMethodNames)},
               {"key", nullptr}};
  if (method == GroupMethod::kPlanar) json["key"] = nameOf(report.request.planar.key, kKeyNames);
  json.update(groupFactsJson(report.groups));
  json["bits_per_vertex"] = {{"grid_bits", c.bits},
                             {"floats", c.plain},
                             {"quantised", c.plain_quantised},
                             {"quantised_coded", c.coded},
                             {"grouped", c.grouped()},
                             {"grouped_coded", c.grouped_coded},
                             {"member_order", c.grouped_order}};
  json["search_ms"] = report.groups.stats.search_ms;
  json["warnings"] = report.warnings;
  // Names come from files and need not be UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sheaf::cli
