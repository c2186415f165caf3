// `sheaf bench`, run as a whole. Times are not looked at.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tests/cli/run.h"

namespace sheaf::cli {
namespace {

using Json = nlohmann::json;

RunResult bench(const TempFolder& folder, std::vector<std::string> more) {
  std::vector<std::string> arguments = {"bench", "builtin:terrain?n=65", "--size", "160x120"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return runSheaf(folder, arguments);
}

Json benchJson(const TempFolder& folder, std::vector<std::string> more) {
  more.emplace_back("--json");
  const RunResult result = bench(folder, std::move(more));
  CHECK(result.code == 0);
  CHECK(result.err.empty());
  return Json::parse(result.out);
}

}  // namespace

TEST_CASE("cli/bench: the table has every stage for the three baselines, aligned, with what was run on what") {
  const TempFolder folder;
  const RunResult result = bench(folder, {"--frames", "3"});
  CHECK(result.code == 0);
  CHECK(result.err.empty());
  for (const char* word : {"classic",
                           "modern",
                           "grouped",
                           "vs modern",
                           "vs classic",
                           "cull",
                           "transform",
                           "clip",
                           "setup+bin",
                           "raster",
                           "shade",
                           "other",
                           "frame",
                           "geometry",
                           "transform+clip",
                           "ns grouped",
                           "counters that differ",
                           "revision",
                           "orbit: 3 frames from 3 views",
                           "eliminated",
                           "bytes per patch vertex"})
    CHECK_MESSAGE(result.out.find(word) != std::string::npos, word);
  std::istringstream lines(result.out);
  std::set<std::size_t> widths;
  bool in_table = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("ms   ") && line.find("vs modern") != std::string::npos) in_table = true;
    if (line.empty()) in_table = false;
    // A plus-minus sign is two bytes and one column.
    if (in_table) widths.insert(line.size() - (line.find("±") != std::string::npos ? 3 : 0));
  }
  CHECK(widths.size() == 1);
}

TEST_CASE("cli/bench: the JSON has quartiles, items, ratios, counters and the times of each frame") {
  const TempFolder folder;
  const Json json = benchJson(folder, {"--frames", "4", "--threads", "1", "--prefer", "memory"});
  CHECK(json["context"]["threads"] == 1);
  CHECK(json["context"]["flags"].get<std::string>().find("-ffp-contract=off") != std::string::npos);
  CHECK(!json["context"]["revision"].get<std::string>().empty());
  CHECK(json["grouping"]["method"] == "planar");
  CHECK(json["grouping"]["prefer"] == "memory");
  REQUIRE(json["sections"].size() == 1);
  const Json& section = json["sections"][0];
  CHECK(section["name"] == "orbit");
  CHECK(section["frames_changed_by_culling"] == 0);
  std::vector<std::string> names;
  for (const Json& row : section["stages"]) {
    names.push_back(row["name"]);
    for (const char* baseline : {"classic", "modern", "grouped"}) {
      CAPTURE(baseline);
      const Json& q = row["wall_ms"][baseline];
      CHECK(q["min"].get<double>() <= q["lower"].get<double>());
      CHECK(q["lower"].get<double>() <= q["median"].get<double>());
      CHECK(q["median"].get<double>() <= q["upper"].get<double>());
      CHECK(q["upper"].get<double>() <= q["max"].get<double>());
      CHECK(section["frame_wall_ms"][baseline][row["name"].get<std::string>()].size() == 4);
    }
    CHECK(row["speedup"].contains("vs_modern"));
    CHECK(row["speedup"].contains("vs_classic"));
  }
  CHECK(names == std::vector<std::string>{"cull", "transform", "clip", "setup+bin", "raster", "shade", "other", "frame",
                                          "geometry", "transform+clip"});
  CHECK(section["counters"]["classic"]["vertices_full"] == json["patch_vertices"]);
  CHECK(section["counters"]["grouped"]["vertices_grouped"].get<int>() > 0);
}

TEST_CASE("cli/bench: views are an orbit, the inside at three shares, a flight, a file, or one camera") {
  const TempFolder folder;
  const Json inside = benchJson(folder, {"--views", "inside", "--frames", "2"});
  REQUIRE(inside["sections"].size() == 3);
  const double wanted[] = {0.05, 0.25, 0.5};
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(inside["sections"][i]["share_in_view"].get<double>() == doctest::Approx(wanted[i]).epsilon(0.02));
    CHECK(inside["sections"][i]["views"] == 1);
  }
  CHECK(benchJson(folder, {"--views", "fly", "--frames", "5"})["sections"][0]["views"] == 5);
  CHECK(benchJson(folder, {"--views", "orbit:2", "--frames", "5"})["sections"][0]["views"] == 2);
  CHECK(benchJson(folder, {"--view", "top", "--frames", "2"})["sections"][0]["views"] == 1);
  folder.write("c.json", R"([{"eye": [3, 2, 3], "target": [0, 0, 0]}, {"eye": [0, 2, 3], "target": [0, 0, 0]}])");
  CHECK(benchJson(folder, {"--views", "c.json", "--frames", "4"})["sections"][0]["views"] == 2);
}

TEST_CASE("cli/bench: the report is one HTML file with the figures of the table") {
  const TempFolder folder;
  const RunResult result = bench(folder, {"--frames", "2", "--report", "r.html"});
  CHECK(result.code == 0);
  CHECK(result.out.find("transform+clip") != std::string::npos);
  const std::string html = folder.read("r.html");
  CHECK(html.starts_with("<!DOCTYPE html>"));
  CHECK(html.ends_with("</html>\n"));
  for (const char* word : {"classic", "modern", "grouped", "transform+clip", "data:image/png;base64,", "class=\"bar\"",
                           "class=\"lines\"", "prefers-color-scheme: dark", "revision", "SIMD target", "-ffp-contract"})
    CHECK_MESSAGE(html.find(word) != std::string::npos, word);
  CHECK(folder.fileCount() == 1);
}

}  // namespace sheaf::cli
