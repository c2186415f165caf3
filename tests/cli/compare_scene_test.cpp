// `sheaf compare INPUT`, run as a whole.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "raster/image_io.h"
#include "tests/cli/run.h"

namespace sheaf::cli {
namespace {

using Json = nlohmann::json;

RunResult compare(const TempFolder& folder, std::vector<std::string> more) {
  std::vector<std::string> arguments = {"compare", "builtin:teapot?n=4", "--size", "160x120"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return runSheaf(folder, arguments);
}

Json compareJson(const TempFolder& folder, std::vector<std::string> more) {
  more.emplace_back("--json");
  return Json::parse(compare(folder, std::move(more)).out);
}

}  // namespace

TEST_CASE("cli/compare_scene: grouping is lossy, so without a limit what counts is that it is drawn right") {
  const TempFolder folder;
  const RunResult result = compare(folder, {});
  CAPTURE(result.out);
  CHECK(result.code == 0);
  CHECK(result.err.empty());
  for (const char* word :
       {"planar groups, distance metric, epsilon 0.5 %, 16-bit parameters", "pictures          equal", "PSNR",
        "silhouette", "eliminated", "bytes per vertex", "drawn right"})
    CHECK_MESSAGE(result.out.find(word) != std::string::npos, word);
  const Json json = compareJson(folder, {});
  CHECK(json["drawing_right"] == true);
  CHECK(json["views"].size() == 1);
  CHECK(json["views"][0]["drawing"]["equal"] == true);
  CHECK(json["views"][0]["quality"]["equal"] == false);
  CHECK(json["views"][0]["quality"]["silhouette_shift"]["max_px"].get<double>() > 0.0);
  CHECK(json["eliminated_fraction"].get<double>() > 0.5);
  CHECK(json["drawn_by_groups_fraction"].get<double>() > 0.3);
  const Json in_full = compareJson(folder, {"--prefer", "speed"});
  CHECK(in_full["drawn_by_groups_fraction"] == 0.0);
  CHECK(in_full["views"][0]["quality"] == json["views"][0]["quality"]);
  CHECK(json["displacement_fraction"]["max"].get<double>() <= 0.00501);
  CHECK(json["bytes_per_vertex"]["original"].get<double>() >= 12.0);
}

TEST_CASE("cli/compare_scene: limits are about quality, of any view") {
  const TempFolder folder;
  CHECK(compare(folder, {"--max-error", "255"}).code == 0);
  CHECK(compare(folder, {"--max-differing", "100%"}).code == 0);
  const RunResult result = compare(folder, {"--max-differing", "0", "--min-psnr", "90", "--views", "orbit:3"});
  CHECK(result.code == 1);
  CHECK(result.out.find("quality beyond --max-differing --min-psnr") != std::string::npos);
  CHECK(compareJson(folder, {"--max-differing", "0"})["beyond"] == Json::array({"--max-differing"}));
  // Epsilon 0 moves nothing, so every limit is kept, and PSNR is infinite.
  CHECK(compare(folder, {"--epsilon", "0", "--parameters", "float", "--max-differing", "0", "--max-error", "0",
                         "--min-psnr", "1000"})
            .code == 0);
}

TEST_CASE("cli/compare_scene: a larger epsilon costs more, and options of grouping arrive") {
  const TempFolder folder;
  const Json fine = compareJson(folder, {"--epsilon", "0.1%"});
  const Json coarse = compareJson(folder, {"--epsilon", "0.02"});
  CHECK(fine["grouping"]["epsilon"] == 0.001);
  CHECK(coarse["grouping"]["epsilon"] == 0.02);
  CHECK(fine["views"][0]["quality"]["rms"].get<double>() < coarse["views"][0]["quality"]["rms"].get<double>());
  const Json other =
      compareJson(folder, {"--grouping", "linear", "--metric", "quadric", "--limit", "paper", "--parameters", "float"});
  CHECK(other["grouping"]["method"] == "linear");
  CHECK(other["grouping"]["metric"] == "quadric");
  CHECK(other["grouping"]["limit"] == "paper");
  CHECK(other["grouping"]["parameters"] == "float");
  CHECK(other["drawing_right"] == true);
}

TEST_CASE("cli/compare_scene: of several views each is in the JSON and the worst is named") {
  const TempFolder folder;
  const Json json = compareJson(folder, {"--views", "orbit:5", "--orbit", "10,30"});
  REQUIRE(json["views"].size() == 5);
  CHECK(json["views"][0]["name"] == "10,30");
  CHECK(json["views"][1]["name"] == "82,30");
  double worst = 0.0;
  for (const Json& view : json["views"]) worst = std::max(worst, view["quality"]["rms"].get<double>());
  CHECK(json["views"][json["worst_view"].get<std::size_t>()]["quality"]["rms"] == worst);
  CHECK(compareJson(folder, {"--views", "orbit"})["views"].size() == 8);
  CHECK(compareJson(folder, {"--views", "fly:4"})["views"].size() == 4);
  const Json inside = compareJson(folder, {"--views", "inside"});
  REQUIRE(inside["views"].size() == 3);
  CHECK(inside["views"][1]["name"] == "inside 25 %");
}

TEST_CASE("cli/compare_scene: a view of an orbit is the picture that render makes from there") {
  const TempFolder folder;
  CHECK(compare(folder, {"--views", "orbit:1", "--orbit", "120,20", "-o", "x.png"}).code == 0);
  CHECK(runSheaf(folder, {"render", "builtin:teapot?n=4", "--size", "160x120", "--orbit", "120,20", "-o", "r.png"})
            .code == 0);
  const Image8 all = raster::readImage(folder.file("x.png"));
  const Image8 one = raster::readImage(folder.file("r.png"));
  REQUIRE(all.height() == one.height());
  REQUIRE(all.width() > 3 * one.width());
  bool same = true;
  for (int y = 0; y < one.height(); ++y)
    for (int x = 0; x < one.width(); ++x) same = same && all.at(x, y) == one.at(x, y);
  CHECK(same);
}

TEST_CASE("cli/compare_scene: cameras come from a file, in its coordinates as --up says") {
  const TempFolder folder;
  folder.write("c.json", R"([{"name": "low", "eye": [0, -8, 1], "target": [0, 0, 1], "up": [0, 0, 1]}])");
  folder.write("t.stl",
               "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 1\nendloop\nendfacet\n"
               "endsolid t\n");
  const RunResult turned = runSheaf(folder, {"compare", "t.stl", "--up", "z", "--views", "c.json", "--json"});
  CHECK(turned.code == 0);
  const Json json = Json::parse(turned.out);
  CHECK(json["views"][0]["name"] == "low");
  CHECK(json["views"][0]["eye"] == Json::array({0.0, 1.0, 8.0}));
  folder.write("c.json", "[{}]");
  const RunResult bad = runSheaf(folder, {"compare", "t.stl", "--views", "c.json"});
  CHECK(bad.code == 3);
  CHECK(isOneErrorLine(bad.err));
  CHECK(bad.err.find("c.json: camera 0: eye is missing") != std::string::npos);
}

TEST_CASE("cli/compare_scene: the report is one HTML file with both answers and three pictures") {
  const TempFolder folder;
  CHECK(compare(folder, {"--views", "orbit:3", "--report", "r.html", "--max-differing", "0"}).code == 1);
  const std::string html = folder.read("r.html");
  CHECK(html.ends_with("</html>\n"));
  for (const char* word : {"Is grouped drawing right?", "What does grouping cost in quality?", "View by view",
                           "quality beyond --max-differing", "silhouette", "bytes per vertex", "revision"})
    CHECK_MESSAGE(html.find(word) != std::string::npos, word);
  std::size_t pictures = 0;
  for (std::size_t at = html.find("<img "); at != std::string::npos; at = html.find("<img ", at + 1)) ++pictures;
  CHECK(pictures == 3);
  CHECK(folder.fileCount() == 1);
}

TEST_CASE("cli/compare_scene: positions that cannot be grouped are refused by the name of the file") {
  const TempFolder folder;
  folder.write("far.obj", "v 1e38 0 0\nv 0 1e38 0\nv 0 0 0\nf 1 2 3\n");
  for (const char* command : {"compare", "bench"}) {
    const RunResult result = runSheaf(folder, {command, "far.obj", "--size", "8x8"});
    CHECK(result.code == 3);
    CHECK(result.out.empty());
    CHECK(isOneErrorLine(result.err));
    CHECK_MESSAGE(result.err.find("far.obj: vertex 0: ") != std::string::npos, result.err);
  }
}

}  // namespace sheaf::cli
