#include "cli/bench_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/grouping_options.h"
#include "cli/html_page.h"

namespace sheaf::cli {
namespace {

using pipeline::BaselineRow;
using pipeline::kBaselineCount;
using pipeline::kBaselineNames;
using pipeline::Quartiles;
using pipeline::withCommas;
using Tone = HtmlPage::Tone;

constexpr std::size_t kClassic = 0;
constexpr std::size_t kModern = 1;
constexpr int kPictureSide = 720;

const BaselineRow& rowOf(const std::vector<BaselineRow>& rows, std::string_view name) {
  return *std::find_if(rows.begin(), rows.end(), [&](const BaselineRow& row) { return row.name == name; });
}

std::string timesText(double ratio) {
  return ratio > 0.0 ? fmt::format("{:.2f}×", ratio) : std::string("–");
}

void addCards(const std::vector<BaselineRow>& rows, HtmlPage& page) {
  std::vector<Card> cards;
  for (const auto& [name, meaning] : {std::pair{"frame", "whole frame"}, std::pair{"geometry", "geometry stage"},
                                      std::pair{"transform+clip", "transform and clip"}}) {
    const BaselineRow& row = rowOf(rows, name);
    cards.push_back(
        {timesText(row.speedup[kModern].median),
         fmt::format("{}, against modern; {} against classic", meaning, timesText(row.speedup[kClassic].median))});
  }
  page.cards(cards);
}

void addBars(const std::vector<BaselineRow>& rows, HtmlPage& page) {
  StackedBars chart{"ms", {}, {}};
  for (std::size_t b = 0; b < kBaselineCount; ++b) chart.bars.push_back({std::string(kBaselineNames[b]), {}});
  for (const BaselineRow& row : rows) {
    if (row.name == "frame") break;
    chart.part_names.push_back(row.name);
    for (std::size_t b = 0; b < kBaselineCount; ++b) chart.bars[b].parts.push_back(row.wall_ms[b].mean);
  }
  page.bars(chart);
}

void addLines(const BenchSection& section, HtmlPage& page) {
  LineChart chart{"frame", "ms", {}, {}};
  for (const auto& [row, dashed] : {std::pair{"frame", false}, std::pair{"geometry", true}})
    for (std::size_t b = 0; b < kBaselineCount; ++b) {
      Line line{fmt::format("{}{}", kBaselineNames[b], dashed ? ", geometry" : ""), {}, static_cast<int>(b), dashed};
      for (const auto& frame : section.run.frames) line.values.push_back(pipeline::rowMs(frame[b], row));
      chart.lines.push_back(std::move(line));
    }
  page.lines(chart);
}

HtmlTable timesTable(const std::vector<BaselineRow>& rows) {
  HtmlTable table;
  table.head = {"ms"};
  table.head.insert(table.head.end(), kBaselineNames.begin(), kBaselineNames.end());
  table.head.insert(table.head.end(), {"vs modern", "vs classic"});
  for (const BaselineRow& row : rows) {
    if (row.name == "frame" || row.name == "geometry") table.totals.push_back(table.rows.size());
    std::vector<std::string> cells = {row.name};
    for (const Quartiles& q : row.wall_ms)
      cells.push_back(fmt::format("{:.3f} ±{:.3f}", q.median, 0.5 * (q.upper - q.lower)));
    cells.push_back(timesText(row.speedup[kModern].median));
    cells.push_back(timesText(row.speedup[kClassic].median));
    table.rows.push_back(std::move(cells));
  }
  return table;
}

HtmlTable workTable(const std::vector<BaselineRow>& rows) {
  HtmlTable table;
  table.head = {"stage, item"};
  table.head.insert(table.head.end(), kBaselineNames.begin(), kBaselineNames.end());
  for (const std::string_view name : kBaselineNames) table.head.push_back(fmt::format("ns, {}", name));
  for (const BaselineRow& row : rows) {
    if (row.item.empty()) continue;
    std::vector<std::string> cells = {fmt::format("{}, {}", row.name, row.item)};
    for (const double items : row.items) cells.push_back(withCommas(static_cast<std::uint64_t>(std::llround(items))));
    for (const double ns : row.ns_per_item) cells.push_back(ns > 0.0 ? fmt::format("{:.2f}", ns) : std::string("–"));
    table.rows.push_back(std::move(cells));
  }
  return table;
}

HtmlTable countersTable(const pipeline::BaselineRun& run) {
  const auto counters = pipeline::meanCounters(run);
  HtmlTable table;
  table.head = {"counter"};
  table.head.insert(table.head.end(), kBaselineNames.begin(), kBaselineNames.end());
  for (const auto& [name, field] : pipeline::kCounterNames) {
    std::string words = name;
    std::replace(words.begin(), words.end(), '_', ' ');
    table.rows.push_back({std::move(words)});
    for (const pipeline::Counters& c : counters) table.rows.back().push_back(withCommas(c.*field));
  }
  return table;
}

void addSection(const BenchSection& section, std::uint64_t vertices, TaskPool& pool, HtmlPage& page) {
  const std::vector<BaselineRow> rows = pipeline::summarize(section.run, vertices);
  page.heading(2, section.name);
  std::string what = fmt::format("{} frames of each kind from {} view{}", section.run.frames.size(), section.views,
                                 section.views == 1 ? "" : "s");
  if (section.share_in_view) what += fmt::format(", {:.2f} % of the triangles in view", 100.0 * *section.share_in_view);
  page.paragraph(what, Tone::kFaint);
  addCards(rows, page);
  page.heading(3, "The mean frame, stage by stage");
  addBars(rows, page);
  page.table(timesTable(rows));
  page.heading(3, "Frame by frame");
  addLines(section, page);
  const Image8 picture = smallPicture(section.run.picture, kPictureSide);
  page.pictures({{&picture, "grouped, from the view in the middle of the row"}}, pool);
  page.heading(3, "Work in a frame");
  page.table(workTable(rows));
  page.foldedTable("All counters, mean over the frames", countersTable(section.run));
}

}  // namespace

std::string benchPage(const BenchReport& report, TaskPool& pool) {
  HtmlPage page(fmt::format("{}: time with and without vertex groups", report.context.input));
  page.paragraph(
      fmt::format("{} triangles, {} patch vertices. Three ways to draw the same scene, frame by frame in turns: "
                  "classic transforms every vertex of the original mesh; modern leaves out patches that are "
                  "out of view or face away, testing each; grouped finds the same ones by way of a tree over them, "
                  "and transforms and clips by groups: {}.",
                  withCommas(report.triangles), withCommas(report.vertices), groupingText(report.grouping)));
  page.cards({{fmt::format("{:.1f} %", 100.0 * report.geometry.eliminated()), "of the drawn vertices eliminated"},
              {fmt::format("{:.1f} %", 100.0 * report.drawn_by_groups), "of the patch vertices drawn by groups"},
              {fmt::format("{:.2f}", report.grouped_bytes_per_vertex),
               fmt::format("bytes per patch vertex, {:.2f} without groups", report.original_bytes_per_vertex)}});
  for (const BenchSection& section : report.sections) addSection(section, report.vertices, pool, page);
  page.heading(2, "How to read it");
  page.paragraph(
      "Times in tables are medians over the frames, on the clock, with half the distance of the quartiles behind ±. "
      "“vs modern” and “vs classic” say how many times as fast grouped drawing is: the median of the ratios "
      "frame by frame. Each timed frame follows an untimed one drawn in the same way.");
  page.heading(2, "Machine and build");
  page.facts(contextFacts(report.context));
  for (const std::string& warning : report.warnings) page.paragraph(fmt::format("Warning: {}", warning), Tone::kFaint);
  return std::move(page).finish();
}

}  // namespace sheaf::cli
