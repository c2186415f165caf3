// `sheaf compare`, run as a whole.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "raster/image_io.h"
#include "tests/cli/run.h"

namespace sheaf::cli {
namespace {

/// a.png and b.png, 10x10: two pixels of b are off by 3 in red.
void writePair(const TempFolder& folder) {
  TaskPool pool(1);
  Image8 image(10, 10, {100, 100, 100, 255});
  raster::writePng(folder.file("a.png"), image, pool);
  image.at(4, 5).r = 103;
  image.at(6, 7).r = 103;
  raster::writePng(folder.file("b.png"), image, pool);
}

}  // namespace

TEST_CASE("cli/compare: equal pictures exit with 0, different ones with 1, both with figures on stdout") {
  const TempFolder folder;
  writePair(folder);
  const RunResult equal = runSheaf(folder, {"compare", "a.png", "a.png"});
  CHECK(equal.code == 0);
  CHECK(equal.out.find("equal") != std::string::npos);
  CHECK(equal.out.find("infinite") != std::string::npos);
  CHECK(equal.err.empty());
  const RunResult different = runSheaf(folder, {"compare", "a.png", "b.png"});
  CHECK(different.code == 1);
  CHECK(different.out.find("2 of 100 (2 %)") != std::string::npos);
  CHECK(different.out.find("(4, 5)") != std::string::npos);
  CHECK(different.err.empty());
}

TEST_CASE("cli/compare: limits decide, at their edge too, and only those that are given") {
  const TempFolder folder;
  writePair(folder);
  const std::vector<std::pair<std::vector<std::string>, int>> limits = {
      {{"--max-differing", "2"}, 0},
      {{"--max-differing", "1"}, 1},
      {{"--max-differing", "2%"}, 0},
      {{"--max-differing", "1.9%"}, 1},
      {{"--max-error", "3"}, 0},
      {{"--max-error", "2"}, 1},
      {{"--min-psnr", "50"}, 0},
      {{"--min-psnr", "61"}, 1},
      {{"--max-differing", "2", "--max-error", "3", "--min-psnr", "50"}, 0},
      {{"--max-differing", "100", "--max-error", "2"}, 1},
  };
  for (const auto& [options, code] : limits) {
    CAPTURE(options[0]);
    CAPTURE(options[1]);
    std::vector<std::string> arguments = {"compare", "a.png", "b.png"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    CHECK(runSheaf(folder, arguments).code == code);
  }
}

TEST_CASE("cli/compare: the JSON has the figures; no PSNR when equal") {
  const TempFolder folder;
  writePair(folder);
  const auto json = nlohmann::json::parse(runSheaf(folder, {"compare", "a.png", "b.png", "--json"}).out);
  CHECK(json["differing_pixels"] == 2);
  CHECK(json["max_error"] == 3);
  CHECK(json["max_error_rgba"] == nlohmann::json::array({3, 0, 0, 0}));
  CHECK(json["first"] == nlohmann::json::array({4, 5}));
  CHECK(json["box"]["max"] == nlohmann::json::array({7, 8}));
  CHECK(json["within_limits"] == false);
  CHECK(json["beyond"] == nlohmann::json::array({"--max-differing"}));
  const auto equal = nlohmann::json::parse(runSheaf(folder, {"compare", "a.png", "a.png", "--json"}).out);
  CHECK(equal["psnr_db"].is_null());
  CHECK(equal["equal"] == true);
}

TEST_CASE("cli/compare: the heat map has the pictures' size and colours only where they differ") {
  const TempFolder folder;
  writePair(folder);
  CHECK(runSheaf(folder, {"compare", "a.png", "b.png", "-o", "heat.png"}).code == 1);
  const Image8 map = raster::readImage(folder.file("heat.png"));
  REQUIRE(map.width() == 10);
  REQUIRE(map.height() == 10);
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 10; ++x) {
      const bool differs = (x == 4 && y == 5) || (x == 6 && y == 7);
      const Rgba8 p = map.at(x, y);
      CHECK((p.r == p.g && p.g == p.b) == !differs);
    }
}

TEST_CASE("cli/compare: pictures of different sizes cannot be compared: exit code 3, both sizes named, no heat map") {
  const TempFolder folder;
  writePair(folder);
  TaskPool pool(1);
  raster::writePng(folder.file("c.png"), Image8(9, 10), pool);
  const RunResult result = runSheaf(folder, {"compare", "a.png", "c.png", "-o", "heat.png"});
  CHECK(result.code == 3);
  CHECK(isOneErrorLine(result.err));
  CHECK(result.err.find("10x10") != std::string::npos);
  CHECK(result.err.find("9x10") != std::string::npos);
  CHECK(!folder.has("heat.png"));
}

}  // namespace sheaf::cli
