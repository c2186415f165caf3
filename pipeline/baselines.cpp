#include "pipeline/baselines.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace sheaf::pipeline {
namespace {

constexpr auto kClassic = static_cast<std::size_t>(Baseline::kClassic);
constexpr auto kModern = static_cast<std::size_t>(Baseline::kModern);
constexpr auto kGrouped = static_cast<std::size_t>(Baseline::kGrouped);

constexpr PerBaseline<Culling> kCulling = {Culling::kNone, Culling::kPatches, Culling::kTree};

double toMs(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-6;
}

/// Which stages a row adds up, and what it counts. No stages: `other` or `frame`.
struct RowKind {
  std::string_view name;
  std::vector<Stage> stages;
  const char* item;
  std::uint64_t (*items)(const Counters&);
};

const std::vector<RowKind>& rowKinds() {
  using C = const Counters&;
  const auto triangles = [](C c) { return c.triangles_in; };
  const auto none = [](C) { return std::uint64_t{0}; };
  static const std::vector<RowKind> kinds = {
      {"cull", {Stage::kCull}, "patches", [](C c) { return c.patches; }},
      {"transform", {Stage::kTransform}, "vertices", [](C c) { return c.vertices_transformed; }},
      {"clip", {Stage::kClip}, "tests", [](C c) { return c.vertices_coded + c.groups_tested; }},
      {"setup+bin", {Stage::kSetupBin}, "triangles", [](C c) { return c.triangles_assembled; }},
      {"raster", {Stage::kRaster}, "bin entries", [](C c) { return c.bin_entries; }},
      {"shade", {Stage::kShade}, "pixels", [](C c) { return c.pixels_shaded; }},
      {"other", {}, "", none},
      {"frame", {}, "triangles in", triangles},
      {"geometry", {Stage::kCull, Stage::kTransform, Stage::kClip, Stage::kSetupBin}, "triangles in", triangles},
      {"transform+clip", {Stage::kTransform, Stage::kClip}, "vertices in", none},
  };
  return kinds;
}

std::int64_t sumOf(const StageTimes& times, const std::vector<Stage>& stages) {
  std::int64_t ns = 0;
  for (const Stage stage : stages) ns += times[stage];
  return ns;
}

double wallMs(const FrameTimes& frame, const RowKind& kind) {
  if (kind.name == "frame") return toMs(frame.wall_ns);
  if (kind.name != "other") return toMs(sumOf(frame.wall, kind.stages));
  std::int64_t stages_ns = 0;
  for (const std::int64_t ns : frame.wall.ns) stages_ns += ns;
  return toMs(std::max<std::int64_t>(0, frame.wall_ns - stages_ns));
}

double atRank(const std::vector<double>& sorted, double rank) {
  const double position = rank * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (position - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

BaselineRow summarizeRow(const BaselineRun& run, const RowKind& kind, std::uint64_t vertex_count) {
  BaselineRow row;
  row.name = kind.name;
  row.item = kind.item;
  const auto itemsIn = [&](const FrameTimes& frame) {
    return static_cast<double>(kind.name == "transform+clip" ? vertex_count : kind.items(frame.counters));
  };
  for (std::size_t b = 0; b < kBaselineCount; ++b) {
    std::vector<double> wall;
    std::vector<double> cpu;
    std::vector<double> each;
    std::vector<double> speedup;
    for (const PerBaseline<FrameTimes>& frame : run.frames) {
      wall.push_back(wallMs(frame[b], kind));
      cpu.push_back(toMs(sumOf(frame[b].cpu, kind.stages)));
      const double items = itemsIn(frame[b]);
      row.items[b] += items / static_cast<double>(run.frames.size());
      if (items > 0.0) each.push_back(1e6 * wall.back() / items);
      const double grouped = wallMs(frame[kGrouped], kind);
      if (grouped > 0.0) speedup.push_back(wall.back() / grouped);
    }
    row.wall_ms[b] = quartilesOf(std::move(wall));
    row.cpu_ms[b] = quartilesOf(std::move(cpu));
    row.ns_per_item[b] = quartilesOf(std::move(each)).median;
    row.speedup[b] = quartilesOf(std::move(speedup));
  }
  return row;
}

}  // namespace

BaselineBench::BaselineBench(const scenes::Scene& scene, GroupingOptions grouping, RenderSettings settings,
                             TaskPool& pool, const grouping::Progress& progress)
    : original_(prepareScene(scene, pool)), settings_(settings), renderer_(pool) {
  grouping.use_groups = true;
  grouped_ = prepareScene(scene, pool, grouping, progress);
  for (const scenes::Instance& instance : original_.instances)
    vertex_count_ += original_.meshes[instance.mesh].vertex_count;
}

BaselineRun BaselineBench::run(std::span<const scenes::Camera> cameras, int frames,
                               const std::function<void(double)>& done) {
  assert(!cameras.empty() && frames > 0);
  BaselineRun result;
  const std::size_t middle = (std::min(cameras.size(), static_cast<std::size_t>(frames)) - 1) / 2;
  for (int f = 0; f < frames; ++f) {
    const std::size_t view = static_cast<std::size_t>(f) % cameras.size();
    result.frames.emplace_back();
    for (std::size_t b = 0; b < kBaselineCount; ++b) {
      settings_.culling = kCulling[b];
      const PreparedScene& scene = b == kGrouped ? grouped_ : original_;
      renderer_.render(scene, cameras[view], settings_, drawn_[b]);
      const std::int64_t begin_ns = nowNs();
      renderer_.render(scene, cameras[view], settings_, drawn_[b]);
      const Frame& frame = drawn_[b];
      result.frames.back()[b] = {begin_ns, frame.wall_ns, frame.cpu, frame.wall, frame.counters, {}};
    }
    if (drawn_[kClassic].color != drawn_[kModern].color) ++result.differing_frames;
    if (view == middle && result.picture.empty()) result.picture = drawn_[kGrouped].color;
    done(static_cast<double>(f + 1) / frames);
  }
  return result;
}

Quartiles quartilesOf(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  return {values.front(), atRank(values, 0.25), atRank(values, 0.5), atRank(values, 0.75), values.back(), mean};
}

std::vector<BaselineRow> summarize(const BaselineRun& run, std::uint64_t vertex_count) {
  std::vector<BaselineRow> rows;
  for (const RowKind& kind : rowKinds()) rows.push_back(summarizeRow(run, kind, vertex_count));
  return rows;
}

PerBaseline<Counters> meanCounters(const BaselineRun& run) {
  PerBaseline<Counters> means;
  for (std::size_t b = 0; b < kBaselineCount; ++b)
    for (const auto& [name, field] : kCounterNames) {
      std::uint64_t sum = 0;
      for (const PerBaseline<FrameTimes>& frame : run.frames) sum += frame[b].counters.*field;
      const std::uint64_t count = std::max<std::size_t>(1, run.frames.size());
      means[b].*field = (sum + count / 2) / count;
    }
  return means;
}

double rowMs(const FrameTimes& frame, std::string_view row) {
  const auto& kinds = rowKinds();
  const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const RowKind& k) { return k.name == row; });
  assert(kind != kinds.end());
  return wallMs(frame, *kind);
}

}  // namespace sheaf::pipeline
