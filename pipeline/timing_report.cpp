#include "pipeline/timing_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <ctime>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

namespace sheaf::pipeline {
namespace {

using Json = nlohmann::ordered_json;

double toMs(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-6;
}

Spread spreadOf(std::vector<double> values) {
  assert(!values.empty());
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  const double median = values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
  return {median, values.front(), values.back()};
}

template <typename Value>
Spread spreadOver(const std::vector<FrameTimes>& frames, const Value& value_ms) {
  std::vector<double> values;
  values.reserve(frames.size());
  for (const FrameTimes& frame : frames) values.push_back(value_ms(frame));
  return spreadOf(std::move(values));
}

Spread once(std::int64_t ns) {
  return {toMs(ns), toMs(ns), toMs(ns)};
}

struct Items {
  const char* name;
  std::uint64_t count;
};

Items itemsOf(Stage stage, const Counters& c, std::uint64_t pixels) {
  switch (stage) {
    case Stage::kImport:
    case Stage::kPrepare:
      return {"triangles", c.triangles_in};
    case Stage::kCull:
      return {"patches", c.patches};
    case Stage::kTransform:
      return {"vertices", c.vertices_transformed};
    case Stage::kClip:
      return {"triangles clipped", c.triangles_clipped};
    case Stage::kSetupBin:
      return {"triangles", c.triangles_assembled};
    case Stage::kRaster:
      return {"bin entries", c.bin_entries};
    case Stage::kShade:
      return {"pixels shaded", c.pixels_shaded};
    case Stage::kEncode:
      return {"pixels", pixels};
  }
  return {"", 0};
}

StageRow makeRow(const RunTimes& run, Stage stage) {
  StageRow row;
  row.name = kStageNames[static_cast<std::size_t>(stage)];
  const PhaseTime* phase = stage == Stage::kImport    ? &run.import
                           : stage == Stage::kPrepare ? &run.prepare
                           : stage == Stage::kEncode  ? &run.encode
                                                      : nullptr;
  if (phase) {
    row.wall_ms = once(phase->wallNs());
    row.cpu_ms = once(phase->cpu_ns);
  } else {
    row.wall_ms = spreadOver(run.frames, [&](const FrameTimes& f) { return toMs(f.wall[stage]); });
    row.cpu_ms = spreadOver(run.frames, [&](const FrameTimes& f) { return toMs(f.cpu[stage]); });
  }
  const Items items = itemsOf(stage, run.frames.back().counters, run.pixels);
  row.item = items.name;
  row.items = items.count;
  if (row.wall_ms.median > 0.0) row.items_per_s = static_cast<double>(items.count) / (row.wall_ms.median * 1e-3);
  return row;
}

double frameOtherMs(const FrameTimes& frame) {
  std::int64_t stages_ns = 0;
  for (const std::int64_t ns : frame.wall.ns) stages_ns += ns;
  return toMs(std::max<std::int64_t>(0, frame.wall_ns - stages_ns));
}

/// Within a frame (its median), and outside of frames and phases: reading options, fitting the camera, allocations.
double otherMs(const RunTimes& run) {
  std::int64_t outside_ns =
      run.end_ns - run.begin_ns - run.import.wallNs() - run.prepare.wallNs() - run.encode.wallNs();
  for (const FrameTimes& frame : run.frames) outside_ns -= frame.wall_ns;
  return spreadOver(run.frames, frameOtherMs).median + toMs(std::max<std::int64_t>(0, outside_ns));
}

constexpr std::array<std::pair<const char*, std::uint64_t Counters::*>, 23> kCounterNames = {{
    {"instances", &Counters::instances},
    {"patches", &Counters::patches},
    {"patches_outside", &Counters::patches_outside},
    {"patches_back_facing", &Counters::patches_back_facing},
    {"vertices_transformed", &Counters::vertices_transformed},
    {"vertices_full", &Counters::vertices_full},
    {"vertices_grouped", &Counters::vertices_grouped},
    {"vertices_coded", &Counters::vertices_coded},
    {"groups_tested", &Counters::groups_tested},
    {"groups_outside", &Counters::groups_outside},
    {"groups_inside", &Counters::groups_inside},
    {"triangles_in", &Counters::triangles_in},
    {"triangles_assembled", &Counters::triangles_assembled},
    {"triangles_outside", &Counters::triangles_outside},
    {"triangles_clipped", &Counters::triangles_clipped},
    {"triangles_back_facing", &Counters::triangles_back_facing},
    {"triangles_no_sample", &Counters::triangles_no_sample},
    {"triangles_binned", &Counters::triangles_binned},
    {"bin_entries", &Counters::bin_entries},
    {"tiles", &Counters::tiles},
    {"tiles_empty", &Counters::tiles_empty},
    {"pixels_shaded", &Counters::pixels_shaded},
    {"pixels_background", &Counters::pixels_background},
}};

std::string grouped(std::uint64_t n) {
  std::string digits = std::to_string(n);
  for (std::size_t i = digits.size(); i > 3;) digits.insert(i -= 3, ",");
  return digits;
}

std::string rate(double per_s) {
  if (per_s <= 0.0) return "-";
  if (per_s >= 1e9) return fmt::format("{:.2f} G", per_s * 1e-9);
  if (per_s >= 1e6) return fmt::format("{:.2f} M", per_s * 1e-6);
  if (per_s >= 1e3) return fmt::format("{:.2f} k", per_s * 1e-3);
  return fmt::format("{:.2f}  ", per_s);
}

std::string countersTable(const Counters& counters) {
  std::string text = "counters (one frame)\n";
  for (const auto& [name, field] : kCounterNames) {
    std::string words = name;
    std::replace(words.begin(), words.end(), '_', ' ');
    text += fmt::format("  {:<22}{:>15}\n", words, grouped(counters.*field));
  }
  return text;
}

Json toJsonValue(const Spread& spread) {
  return {{"median", spread.median}, {"min", spread.min}, {"max", spread.max}};
}

Json toJsonValue(const Counters& counters) {
  Json object = Json::object();
  for (const auto& [name, field] : kCounterNames) object[name] = counters.*field;
  return object;
}

Json toJsonValue(const RunContext& context) {
  return {{"input", context.input},
          {"width", context.width},
          {"height", context.height},
          {"threads", context.threads},
          {"simd_target", context.simd_target},
          {"build", context.build},
          {"cpu", context.cpu}};
}

std::string dumped(const Json& json, int indent) {
  // A file name need not be UTF-8: replace what is not, rather than throw.
  return json.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// Trace events; the main thread is track 0, worker k is track k + 1.
class TraceWriter {
 public:
  explicit TraceWriter(std::int64_t origin_ns) : origin_ns_(origin_ns) {}

  void addTrack(int track, const std::string& name) {
    addMetadata("thread_name", track, {{"name", name}});
    addMetadata("thread_sort_index", track, {{"sort_index", track}});
  }
  void addMetadata(const char* kind, int track, Json args) {
    events_.push_back({{"name", kind}, {"ph", "M"}, {"pid", 1}, {"tid", track}, {"args", std::move(args)}});
  }
  void addSpan(std::string_view name, int track, std::int64_t begin_ns, std::int64_t end_ns, Json args = nullptr) {
    Json event = {{"name", name}, {"cat", "sheaf"}, {"ph", "X"}, {"pid", 1}, {"tid", track}};
    event["ts"] = static_cast<double>(begin_ns - origin_ns_) * 1e-3;
    event["dur"] = static_cast<double>(end_ns - begin_ns) * 1e-3;
    if (!args.is_null()) event["args"] = std::move(args);
    events_.push_back(std::move(event));
  }
  void addPhase(std::string_view name, const PhaseTime& phase) {
    if (phase.end_ns > phase.begin_ns) addSpan(name, 0, phase.begin_ns, phase.end_ns, {{"cpu_ms", toMs(phase.cpu_ns)}});
  }
  Json take() { return std::move(events_); }

 private:
  std::int64_t origin_ns_;
  Json events_ = Json::array();
};

}  // namespace

std::int64_t processCpuNs() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

void RunTimes::addFrame(std::int64_t frame_begin_ns, const Frame& frame) {
  frames.push_back({frame_begin_ns, frame.wall_ns, frame.cpu, frame.wall, frame.counters, frame.spans});
}

TimingReport makeTimingReport(const RunTimes& run, RunContext context) {
  assert(!run.frames.empty());
  TimingReport report;
  report.context = std::move(context);
  report.frames = static_cast<int>(run.frames.size());
  report.frame_ms = spreadOver(run.frames, [](const FrameTimes& f) { return toMs(f.wall_ns); });
  report.counters = run.frames.back().counters;
  report.other_ms = otherMs(run);
  report.total_ms = report.other_ms;
  for (int s = 0; s < kStageCount; ++s) {
    report.stages.push_back(makeRow(run, static_cast<Stage>(s)));
    report.total_ms += report.stages.back().wall_ms.median;
    report.total_cpu_ms += report.stages.back().cpu_ms.median;
  }
  if (report.total_ms > 0.0)
    for (StageRow& row : report.stages) row.share = row.wall_ms.median / report.total_ms;
  return report;
}

std::string formatTable(const TimingReport& report) {
  const bool spread = report.frames > 1;
  const auto range = [&](const std::string& min, const std::string& max) {
    return spread ? fmt::format("{:>10}{:>10}", min, max) : std::string();
  };
  const auto ms = [](double value) { return fmt::format("{:.3f}", value); };
  std::string text = fmt::format("{:<10}{:>10}{}{:>8}{:>10}{:>15}  {:<18}{:>11}\n", "stage", "wall ms",
                                 range("min", "max"), "share", "cpu ms", "items", "", "items/s");
  const std::string rule(text.size() - 1, '-');
  text += rule + "\n";
  for (const StageRow& row : report.stages)
    text += fmt::format("{:<10}{:>10.3f}{}{:>6.1f} %{:>10.3f}{:>15}  {:<18}{:>11}\n", row.name, row.wall_ms.median,
                        range(ms(row.wall_ms.min), ms(row.wall_ms.max)), 100.0 * row.share, row.cpu_ms.median,
                        grouped(row.items), row.item, rate(row.items_per_s));
  const double other_share = report.total_ms > 0.0 ? report.other_ms / report.total_ms : 0.0;
  text += fmt::format("{:<10}{:>10.3f}{}{:>6.1f} %{:>10}\n", "other", report.other_ms, range("", ""),
                      100.0 * other_share, "-");
  text += rule + "\n";
  text += fmt::format("{:<10}{:>10.3f}{}{:>6.1f} %{:>10.3f}\n\n", "sum", report.total_ms, range("", ""), 100.0,
                      report.total_cpu_ms);
  if (spread)
    text += fmt::format("frame      {:.3f} ms, median of {} ({:.3f} to {:.3f}); stages of the frame are medians too\n",
                        report.frame_ms.median, report.frames, report.frame_ms.min, report.frame_ms.max);
  else
    text += fmt::format("frame      {:.3f} ms, drawn once\n", report.frame_ms.median);
  text +=
      "wall       time on the clock; where stages run side by side it is shared out by their cpu time\n"
      "cpu        summed over threads\n";
  const RunContext& c = report.context;
  text += fmt::format("run        {}, {}x{}, {} thread{}, {}\n", c.input, c.width, c.height, c.threads,
                      c.threads == 1 ? "" : "s", c.simd_target);
  text += fmt::format("build      {}\ncpu model  {}\n\n", c.build, c.cpu);
  return text + countersTable(report.counters);
}

std::string toJson(const TimingReport& report) {
  Json stages = Json::array();
  for (const StageRow& row : report.stages)
    stages.push_back({{"name", row.name},
                      {"wall_ms", toJsonValue(row.wall_ms)},
                      {"cpu_ms", toJsonValue(row.cpu_ms)},
                      {"share", row.share},
                      {"item", row.item},
                      {"items", row.items},
                      {"items_per_s", row.items_per_s}});
  const Json json = {{"context", toJsonValue(report.context)},
                     {"frames", report.frames},
                     {"frame_wall_ms", toJsonValue(report.frame_ms)},
                     {"stages", std::move(stages)},
                     {"other_wall_ms", report.other_ms},
                     {"total_wall_ms", report.total_ms},
                     {"total_cpu_ms", report.total_cpu_ms},
                     {"counters", toJsonValue(report.counters)}};
  return dumped(json, 2);
}

std::string toTraceJson(const RunTimes& run, const RunContext& context) {
  TraceWriter trace(run.begin_ns);
  trace.addMetadata("process_name", 0, {{"name", "sheaf"}});
  trace.addTrack(0, "main");
  for (int worker = 0; worker < context.threads; ++worker) trace.addTrack(worker + 1, fmt::format("worker {}", worker));
  trace.addPhase(kStageNames[static_cast<std::size_t>(Stage::kImport)], run.import);
  trace.addPhase(kStageNames[static_cast<std::size_t>(Stage::kPrepare)], run.prepare);
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    const FrameTimes& frame = run.frames[i];
    trace.addSpan(fmt::format("frame {}", i), 0, frame.begin_ns, frame.begin_ns + frame.wall_ns,
                  toJsonValue(frame.counters));
    for (const StageSpan& span : frame.spans)
      trace.addSpan(kStageNames[static_cast<std::size_t>(span.stage)], span.worker + 1, span.begin_ns, span.end_ns);
  }
  trace.addPhase(kStageNames[static_cast<std::size_t>(Stage::kEncode)], run.encode);
  const Json json = {{"displayTimeUnit", "ms"}, {"otherData", toJsonValue(context)}, {"traceEvents", trace.take()}};
  return dumped(json, -1);
}

}  // namespace sheaf::pipeline
