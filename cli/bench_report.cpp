#include "cli/bench_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/grouping_options.h"

namespace sheaf::cli {
namespace {

using Json = nlohmann::ordered_json;
using pipeline::BaselineRow;
using pipeline::Counters;
using pipeline::kBaselineCount;
using pipeline::kBaselineNames;
using pipeline::PerBaseline;
using pipeline::Quartiles;
using pipeline::withCommas;

constexpr std::size_t kClassic = 0;
constexpr std::size_t kModern = 1;

std::string line(std::string_view head, std::string_view text) {
  return fmt::format("{:<11}{}\n", head, text);
}

std::string timesText(double ratio) {
  return ratio > 0.0 ? fmt::format("{:.2f}x", ratio) : std::string("-");
}

/// Median and half the distance of the quartiles.
std::string msText(const Quartiles& q) {
  return fmt::format("{:>9.3f} ±{:>7.3f}", q.median, 0.5 * (q.upper - q.lower));
}

std::string headText(const BenchReport& report) {
  const pipeline::RunContext& c = report.context;
  std::string text = line("scene", fmt::format("{}, {} triangles, {} patch vertices", c.input,
                                               withCommas(report.triangles), withCommas(report.vertices)));
  text += line("run", fmt::format("{}x{}, {} thread{}, {}", c.width, c.height, c.threads, c.threads == 1 ? "" : "s",
                                  c.simd_target));
  text += line("build", fmt::format("{}, revision {}, {}", c.build, c.revision, c.flags));
  text += line("cpu", c.cpu);
  text += line("classic", "every vertex of the original mesh");
  text += line("modern", "patches out of view or facing away left out, each tested");
  text += line("grouped", fmt::format("the same left out by way of their tree; {}", groupingText(report.grouping)));
  text += line(
      "", fmt::format("{:.2f} % of the drawn vertices eliminated; {:.2f} bytes per patch vertex, {:.2f} without groups",
                      100.0 * report.geometry.eliminated(), report.grouped_bytes_per_vertex,
                      report.original_bytes_per_vertex));
  text += line("", "drawn by groups: " + drawnByGroupsText(report.drawn_by_groups, report.grouping));
  return text;
}

std::string sectionName(const BenchSection& section) {
  std::string text = fmt::format("{}: {} frames from {} view{}", section.name, section.run.frames.size(), section.views,
                                 section.views == 1 ? "" : "s");
  if (section.share_in_view) text += fmt::format(", {:.2f} % of the triangles in view", 100.0 * *section.share_in_view);
  return text;
}

std::string timesTable(const std::vector<BaselineRow>& rows) {
  std::string text = fmt::format("{:<15}", "ms");
  for (const std::string_view name : kBaselineNames) text += fmt::format("{:>19}", name);
  text += fmt::format("  {:>10}{:>11}\n", "vs modern", "vs classic");
  const std::string rule = std::string(95, '-') + "\n";
  text += rule;
  for (const BaselineRow& row : rows) {
    text += fmt::format("{:<15}", row.name);
    for (const Quartiles& q : row.wall_ms) text += fmt::format(" {}", msText(q));
    text += fmt::format("  {:>10}{:>11}\n", timesText(row.speedup[kModern].median),
                        timesText(row.speedup[kClassic].median));
    if (row.name == "other" || row.name == "frame") text += rule;
  }
  return text;
}

std::string itemsTable(const std::vector<BaselineRow>& rows) {
  std::string text = fmt::format("{:<15}{:<13}", "work", "item");
  for (const std::string_view name : kBaselineNames) text += fmt::format("{:>13}", name);
  for (const std::string_view name : kBaselineNames) text += fmt::format("{:>12}", fmt::format("ns {}", name));
  text += "\n";
  for (const BaselineRow& row : rows) {
    if (row.item.empty()) continue;
    text += fmt::format("{:<15}{:<13}", row.name, row.item);
    for (const double items : row.items)
      text += fmt::format("{:>13}", withCommas(static_cast<std::uint64_t>(std::llround(items))));
    for (const double ns : row.ns_per_item)
      text += ns > 0.0 ? fmt::format("{:>12.2f}", ns) : fmt::format("{:>12}", "-");
    text += "\n";
  }
  return text;
}

/// Only those that are not the same everywhere: the others say nothing about the three.
std::string countersTable(const PerBaseline<Counters>& counters) {
  std::string text = fmt::format("{:<28}", "counters that differ");
  for (const std::string_view name : kBaselineNames) text += fmt::format("{:>13}", name);
  text += "\n";
  for (const auto& [name, field] : pipeline::kCounterNames) {
    if (counters[0].*field == counters[1].*field && counters[1].*field == counters[2].*field) continue;
    std::string words = name;
    std::replace(words.begin(), words.end(), '_', ' ');
    text += fmt::format("{:<28}", words);
    for (const Counters& c : counters) text += fmt::format("{:>13}", withCommas(c.*field));
    text += "\n";
  }
  return text;
}

Json toJsonValue(const Quartiles& q) {
  return {{"min", q.min},     {"lower", q.lower}, {"median", q.median},
          {"upper", q.upper}, {"max", q.max},     {"mean", q.mean}};
}

template <typename Value>
Json byBaseline(const Value& value_of) {
  Json object = Json::object();
  for (std::size_t b = 0; b < kBaselineCount; ++b) object[std::string(kBaselineNames[b])] = value_of(b);
  return object;
}

Json rowJson(const BaselineRow& row) {
  Json json = {{"name", row.name},
               {"wall_ms", byBaseline([&](std::size_t b) { return toJsonValue(row.wall_ms[b]); })},
               {"cpu_ms", byBaseline([&](std::size_t b) { return toJsonValue(row.cpu_ms[b]); })},
               {"item", row.item},
               {"items", byBaseline([&](std::size_t b) { return row.items[b]; })},
               {"ns_per_item", byBaseline([&](std::size_t b) { return row.ns_per_item[b]; })}};
  json["speedup"] = {{"vs_modern", toJsonValue(row.speedup[kModern])},
                     {"vs_classic", toJsonValue(row.speedup[kClassic])}};
  return json;
}

Json sectionJson(const BenchSection& section, std::uint64_t vertices) {
  const std::vector<BaselineRow> rows = pipeline::summarize(section.run, vertices);
  const PerBaseline<Counters> counters = pipeline::meanCounters(section.run);
  Json row_list = Json::array();
  for (const BaselineRow& row : rows) row_list.push_back(rowJson(row));
  Json frames = byBaseline([&](std::size_t b) {
    Json times = Json::object();
    for (const BaselineRow& row : rows) {
      Json list = Json::array();
      for (const auto& frame : section.run.frames) list.push_back(pipeline::rowMs(frame[b], row.name));
      times[row.name] = std::move(list);
    }
    return times;
  });
  Json json = {{"name", section.name},
               {"frames", section.run.frames.size()},
               {"views", section.views},
               {"share_in_view", nullptr},
               {"frames_changed_by_culling", section.run.differing_frames},
               {"stages", std::move(row_list)},
               {"counters", byBaseline([&](std::size_t b) {
                  Json object = Json::object();
                  for (const auto& [name, field] : pipeline::kCounterNames) object[name] = counters[b].*field;
                  return object;
                })},
               {"frame_wall_ms", std::move(frames)}};
  if (section.share_in_view) json["share_in_view"] = *section.share_in_view;
  return json;
}

}  // namespace

std::string benchText(const BenchReport& report) {
  std::string text = headText(report);
  for (const BenchSection& section : report.sections) {
    const std::vector<BaselineRow> rows = pipeline::summarize(section.run, report.vertices);
    text += fmt::format("\n{}\n\n{}\n{}\n{}", sectionName(section), timesTable(rows), itemsTable(rows),
                        countersTable(pipeline::meanCounters(section.run)));
  }
  return text +
         "\nms     median over the frames ± half the distance of the quartiles, time on the clock\n"
         "vs     how many times as fast grouped drawing is, frame by frame: the median\n"
         "work   items in a frame, their mean; ns for each, the median\n";
}

std::string benchJson(const BenchReport& report) {
  Json sections = Json::array();
  for (const BenchSection& section : report.sections) sections.push_back(sectionJson(section, report.vertices));
  const Json json = {{"context", Json::parse(pipeline::toJson(report.context))},
                     {"grouping", groupingJson(report.grouping)},
                     {"triangles", report.triangles},
                     {"patch_vertices", report.vertices},
                     {"eliminated_fraction", report.geometry.eliminated()},
                     {"drawn_by_groups_fraction", report.drawn_by_groups},
                     {"search_ms", report.geometry.search_ms},
                     {"bytes_per_vertex",
                      {{"original", report.original_bytes_per_vertex}, {"grouped", report.grouped_bytes_per_vertex}}},
                     {"sections", std::move(sections)},
                     {"warnings", report.warnings}};
  // Names come from files and need not be UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sheaf::cli
