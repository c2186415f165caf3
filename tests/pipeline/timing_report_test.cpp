#include "pipeline/timing_report.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

namespace sheaf::pipeline {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// Three frames of 10, 30 and 20 ms; import 5, prepare 7, encode 11 ms; 2 ms are spent elsewhere.
RunTimes sampleRun() {
  RunTimes run;
  run.begin_ns = 1000 * kMs;
  std::int64_t now = run.begin_ns + 1 * kMs;
  const auto phase = [&](std::int64_t ms) {
    const PhaseTime p{now, now + ms * kMs, ms * kMs / 2};
    now = p.end_ns;
    return p;
  };
  run.import = phase(5);
  run.prepare = phase(7);
  for (const std::int64_t ms : {10, 30, 20}) {
    Frame frame;
    frame.wall_ns = ms * kMs;
    frame.wall[Stage::kTransform] = ms * kMs / 5;
    frame.cpu[Stage::kTransform] = 2 * ms * kMs / 5;
    frame.wall[Stage::kRaster] = 3 * ms * kMs / 5;
    frame.cpu[Stage::kRaster] = 6 * ms * kMs / 5;
    frame.counters.vertices_transformed = 4000;
    frame.counters.triangles_in = 1234567;
    frame.counters.bin_entries = 99;
    frame.spans = {{Stage::kTransform, 0, now, now + kMs}, {Stage::kRaster, 1, now + kMs, now + 3 * kMs}};
    run.addFrame(now, frame);
    now += frame.wall_ns;
  }
  run.encode = phase(11);
  run.end_ns = now + 1 * kMs;
  run.pixels = 5000;
  return run;
}

RunContext sampleContext() {
  return {.input = "a\xff.ply",
          .width = 100,
          .height = 50,
          .threads = 2,
          .simd_target = "AVX2",
          .build = "b",
          .revision = "r",
          .flags = "-f",
          .cpu = "c"};
}

const StageRow& rowOf(const TimingReport& report, const std::string& name) {
  for (const StageRow& row : report.stages)
    if (row.name == name) return row;
  FAIL("no row " << name);
  return report.stages.front();
}

}  // namespace

TEST_CASE("pipeline/timing_report: the stages come in the order of the pipeline") {
  const TimingReport report = makeTimingReport(sampleRun(), sampleContext());
  REQUIRE(report.stages.size() == kStageCount);
  for (std::size_t i = 0; i < kStageCount; ++i) CHECK(report.stages[i].name == kStageNames[i]);
}

TEST_CASE("pipeline/timing_report: medians and spread are those of the frames") {
  const TimingReport report = makeTimingReport(sampleRun(), sampleContext());
  CHECK(report.frames == 3);
  CHECK(report.frame_ms.median == doctest::Approx(20.0));
  CHECK(report.frame_ms.min == doctest::Approx(10.0));
  CHECK(report.frame_ms.max == doctest::Approx(30.0));
  const StageRow& raster = rowOf(report, "raster");
  CHECK(raster.wall_ms.median == doctest::Approx(12.0));
  CHECK(raster.wall_ms.max == doctest::Approx(18.0));
  CHECK(raster.cpu_ms.median == doctest::Approx(24.0));
  CHECK(rowOf(report, "import").wall_ms.median == doctest::Approx(5.0));
  CHECK(rowOf(report, "import").cpu_ms.median == doctest::Approx(2.5));
}

TEST_CASE("pipeline/timing_report: an even number of frames has the mean of the middle two as median") {
  RunTimes run = sampleRun();
  run.frames.pop_back();
  CHECK(makeTimingReport(run, sampleContext()).frame_ms.median == doctest::Approx(20.0));
}

TEST_CASE("pipeline/timing_report: rows and 'other' add up to the total, and shares to one") {
  const TimingReport report = makeTimingReport(sampleRun(), sampleContext());
  double sum = report.other_ms;
  double shares = report.other_ms / report.total_ms;
  for (const StageRow& row : report.stages) {
    sum += row.wall_ms.median;
    shares += row.share;
  }
  CHECK(sum == doctest::Approx(report.total_ms));
  CHECK(shares == doctest::Approx(1.0));
  // 2 ms outside of everything, and a fifth of the median frame.
  CHECK(report.other_ms == doctest::Approx(2.0 + 4.0));
}

TEST_CASE("pipeline/timing_report: rates are items by wall time, and 0 without time") {
  const TimingReport report = makeTimingReport(sampleRun(), sampleContext());
  const StageRow& transform = rowOf(report, "transform");
  CHECK(transform.item == "vertices");
  CHECK(transform.items == 4000);
  CHECK(transform.items_per_s == doctest::Approx(4000 / 4e-3));
  CHECK(rowOf(report, "clip").items_per_s == 0.0);
  CHECK(rowOf(report, "encode").items == 5000);
}

TEST_CASE("pipeline/timing_report: a run without any time has no shares and no rates") {
  RunTimes run;
  run.addFrame(0, Frame{});
  const TimingReport report = makeTimingReport(run, {});
  CHECK(report.total_ms == 0.0);
  for (const StageRow& row : report.stages) {
    CHECK(row.share == 0.0);
    CHECK(row.items_per_s == 0.0);
  }
  CHECK(!formatTable(report).empty());
}

TEST_CASE("pipeline/timing_report: the table names wall and cpu, aligned, with the counters below") {
  const std::string table = formatTable(makeTimingReport(sampleRun(), sampleContext()));
  for (const char* word : {"wall ms", "cpu ms", "share", "items/s", "other", "sum", "setup+bin", "triangles in",
                           "1,234,567", "AVX2", "median of 3"})
    CHECK_MESSAGE(table.find(word) != std::string::npos, word);
  std::istringstream lines(table);
  std::string line;
  std::set<std::size_t> widths;
  for (int i = 0; i < 2 + kStageCount && std::getline(lines, line); ++i) widths.insert(line.size());
  CHECK(widths.size() == 1);
}

TEST_CASE("pipeline/timing_report: the JSON says the same as the report") {
  const TimingReport report = makeTimingReport(sampleRun(), sampleContext());
  const auto json = nlohmann::json::parse(toJson(report));
  CHECK(json["frames"] == 3);
  CHECK(json["stages"].size() == kStageCount);
  CHECK(json["stages"][6]["name"] == "raster");
  CHECK(json["stages"][6]["wall_ms"]["median"].get<double>() == doctest::Approx(12.0));
  CHECK(json["total_wall_ms"].get<double>() == doctest::Approx(report.total_ms));
  CHECK(json["other_wall_ms"].get<double>() == doctest::Approx(report.other_ms));
  CHECK(json["counters"]["triangles_in"] == 1234567);
  CHECK(json["context"]["simd_target"] == "AVX2");
  CHECK(json["context"]["revision"] == "r");
  CHECK(json["context"]["flags"] == "-f");
}

TEST_CASE("pipeline/timing_report: the trace has a named track per thread and spans in microseconds") {
  const auto json = nlohmann::json::parse(toTraceJson(sampleRun(), sampleContext()));
  std::set<std::string> tracks;
  std::set<int> track_ids;
  int frames = 0;
  bool import_found = false;
  for (const auto& event : json["traceEvents"]) {
    REQUIRE(event.contains("pid"));
    REQUIRE(event.contains("tid"));
    if (event["ph"] == "M") {
      if (event["name"] == "thread_name") {
        tracks.insert(event["args"]["name"].get<std::string>());
        track_ids.insert(event["tid"].get<int>());
      }
      continue;
    }
    REQUIRE(event["ph"] == "X");
    CHECK(event["ts"].get<double>() >= 0.0);
    CHECK(event["dur"].get<double>() > 0.0);
    CHECK(track_ids.count(event["tid"].get<int>()) == 1);
    if (event["name"] == "import") {
      import_found = true;
      CHECK(event["ts"].get<double>() == doctest::Approx(1000.0));
      CHECK(event["dur"].get<double>() == doctest::Approx(5000.0));
    }
    if (event["name"].get<std::string>().starts_with("frame ")) ++frames;
  }
  CHECK(import_found);
  CHECK(frames == 3);
  CHECK(tracks == std::set<std::string>{"main", "worker 0", "worker 1"});
}

TEST_CASE("pipeline/timing_report: whole numbers have commas between thousands") {
  CHECK(withCommas(0) == "0");
  CHECK(withCommas(999) == "999");
  CHECK(withCommas(1000) == "1,000");
  CHECK(withCommas(1234567) == "1,234,567");
}

TEST_CASE("pipeline/timing_report: timePhase measures its work") {
  bool done = false;
  const PhaseTime phase = timePhase([&] { done = true; });
  CHECK(done);
  CHECK(phase.wallNs() >= 0);
  CHECK(phase.cpu_ns >= 0);
}

}  // namespace sheaf::pipeline
