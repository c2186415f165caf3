#include "pipeline/baselines.h"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/pipeline/scene_fixture.h"

namespace sheaf::pipeline {
namespace {

constexpr std::int64_t kMs = 1'000'000;

FrameTimes frameOf(std::int64_t transform_ms, std::int64_t clip_ms, std::int64_t raster_ms, std::int64_t frame_ms,
                   std::uint64_t vertices) {
  FrameTimes frame;
  frame.wall[Stage::kTransform] = transform_ms * kMs;
  frame.cpu[Stage::kTransform] = 2 * transform_ms * kMs;
  frame.wall[Stage::kClip] = clip_ms * kMs;
  frame.wall[Stage::kRaster] = raster_ms * kMs;
  frame.wall_ns = frame_ms * kMs;
  frame.counters.vertices_transformed = vertices;
  frame.counters.triangles_in = 1000;
  return frame;
}

/// Two frames; in the second everything takes longer.
BaselineRun sampleRun() {
  BaselineRun run;
  run.frames.push_back({frameOf(8, 4, 10, 25, 4000), frameOf(4, 2, 10, 17, 2000), frameOf(2, 1, 10, 14, 1000)});
  run.frames.push_back({frameOf(16, 8, 10, 40, 4000), frameOf(8, 4, 10, 30, 3000), frameOf(2, 2, 10, 20, 0)});
  return run;
}

BaselineRow rowOf(const std::vector<BaselineRow>& rows, std::string_view name) {
  for (const BaselineRow& row : rows)
    if (row.name == name) return row;
  FAIL("no row " << name);
  return {};
}

}  // namespace

TEST_CASE("pipeline/baselines: quartiles lie between the values where there is none of their rank") {
  const Quartiles five = quartilesOf({5.0, 1.0, 3.0, 2.0, 4.0});
  CHECK(five.min == 1.0);
  CHECK(five.lower == 2.0);
  CHECK(five.median == 3.0);
  CHECK(five.upper == 4.0);
  CHECK(five.max == 5.0);
  CHECK(five.mean == 3.0);
  const Quartiles four = quartilesOf({4.0, 3.0, 2.0, 1.0});
  CHECK(four.lower == 1.75);
  CHECK(four.median == 2.5);
  CHECK(four.upper == 3.25);
  CHECK(quartilesOf({7.0}).lower == 7.0);
  CHECK(quartilesOf({}).median == 0.0);
}

TEST_CASE("pipeline/baselines: rows are stages and their sums, with the time of a frame beside them") {
  const std::vector<BaselineRow> rows = summarize(sampleRun(), 5000);
  CHECK(rowOf(rows, "transform").wall_ms[0].median == doctest::Approx(12.0));
  CHECK(rowOf(rows, "transform").cpu_ms[0].median == doctest::Approx(24.0));
  CHECK(rowOf(rows, "transform+clip").wall_ms[0].median == doctest::Approx(18.0));
  CHECK(rowOf(rows, "geometry").wall_ms[1].min == doctest::Approx(6.0));
  CHECK(rowOf(rows, "geometry").wall_ms[1].max == doctest::Approx(12.0));
  CHECK(rowOf(rows, "other").wall_ms[0].min == doctest::Approx(3.0));
  CHECK(rowOf(rows, "frame").wall_ms[2].max == doctest::Approx(20.0));
  CHECK(rowOf(rows, "cull").wall_ms[0].max == 0.0);
  CHECK(rowMs(sampleRun().frames[1][0], "transform+clip") == doctest::Approx(24.0));
}

TEST_CASE("pipeline/baselines: how many times as fast is taken frame by frame") {
  const std::vector<BaselineRow> rows = summarize(sampleRun(), 5000);
  const BaselineRow transform = rowOf(rows, "transform");
  CHECK(transform.speedup[0].min == doctest::Approx(4.0));
  CHECK(transform.speedup[0].max == doctest::Approx(8.0));
  CHECK(transform.speedup[0].median == doctest::Approx(6.0));
  CHECK(transform.speedup[1].median == doctest::Approx(3.0));
  CHECK(transform.speedup[2].median == 1.0);
  CHECK(rowOf(rows, "cull").speedup[0].median == 0.0);
}

TEST_CASE("pipeline/baselines: items are means, ns per item medians over the frames that have items") {
  const std::vector<BaselineRow> rows = summarize(sampleRun(), 5000);
  const BaselineRow transform = rowOf(rows, "transform");
  CHECK(transform.item == "vertices");
  CHECK(transform.items[0] == doctest::Approx(4000.0));
  CHECK(transform.items[2] == doctest::Approx(500.0));
  CHECK(transform.ns_per_item[0] == doctest::Approx(3000.0));
  CHECK(transform.ns_per_item[2] == doctest::Approx(2000.0));
  CHECK(rowOf(rows, "transform+clip").items[2] == doctest::Approx(5000.0));
  CHECK(rowOf(rows, "clip").ns_per_item[0] == 0.0);
  CHECK(meanCounters(sampleRun())[1].vertices_transformed == 2500);
}

TEST_CASE("pipeline/baselines: all three draw every frame, and only what they should") {
  TaskPool pool(2);
  scenes::Scene scene = scenes::buildBuiltin("terrain?n=129");
  const std::vector cameras = {usualCamera(scene, 1.5), insideCamera(scene)};
  scenes::addDefaultLights(scene, cameras.front());
  RenderSettings settings;
  settings.width = 120;
  settings.height = 80;
  settings.culling = Culling::kNone;
  GroupingOptions grouping;
  grouping.method = Grouping::kPlanar;
  grouping.use_groups = false;
  BaselineBench bench(scene, grouping, settings, pool);
  CHECK(bench.vertexCount() >= scene.vertexCount());
  std::vector<double> progress;
  const BaselineRun run = bench.run(cameras, 5, [&](double share) { progress.push_back(share); });
  REQUIRE(run.frames.size() == 5);
  CHECK(progress == std::vector{0.2, 0.4, 0.6, 0.8, 1.0});
  CHECK(run.differing_frames == 0);
  CHECK(run.picture.width() == 120);
  for (std::size_t f = 0; f < 5; ++f) {
    CAPTURE(f);
    const Counters& classic = run.frames[f][0].counters;
    const Counters& modern = run.frames[f][1].counters;
    const Counters& grouped = run.frames[f][2].counters;
    CHECK(classic.vertices_full == bench.vertexCount());
    CHECK(classic.triangles_in == modern.triangles_in);
    CHECK(modern.vertices_full <= classic.vertices_full);
    CHECK(modern.vertices_grouped == 0);
    CHECK(grouped.vertices_grouped > 0);
    CHECK(run.frames[f][2].wall_ns > 0);
    if (f % 2 == 1) CHECK(modern.vertices_full < classic.vertices_full);
  }
  // Frames 0, 2, 4 are from the same camera.
  CHECK(run.frames[0][2].counters.bin_entries == run.frames[4][2].counters.bin_entries);
  CHECK(run.frames[0][2].counters.bin_entries != run.frames[1][2].counters.bin_entries);
}

}  // namespace sheaf::pipeline
