// Files that sheaf has saved, looked at and used again, run as a whole.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "grouping/clusters_file.h"
#include "grouping/groups_file.h"
#include "tests/cli/run.h"

namespace sheaf::cli {
namespace {

using Words = std::vector<std::string>;
using nlohmann::json;

constexpr const char* kTeapot = "builtin:teapot?n=6";

void run(const TempFolder& folder, const Words& arguments) {
  const RunResult result = runSheaf(folder, arguments);
  CAPTURE(result.err);
  REQUIRE(result.code == 0);
}

json infoOf(const TempFolder& folder, const std::string& name) {
  const RunResult result = runSheaf(folder, {"info", name, "--json"});
  CAPTURE(result.err);
  REQUIRE(result.code == 0);
  return json::parse(result.out);
}

}  // namespace

TEST_CASE("cli/saved_file: info says of saved groups what group has said") {
  const TempFolder folder;
  for (const Words& options : {Words{}, Words{"--method", "linear", "--segment-only"},
                               Words{"--metric", "quadric", "--planes", "both", "--bits", "8"}}) {
    Words arguments = {"group", kTeapot, "-o", "g.sheaf", "--json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const json said = json::parse(runSheaf(folder, arguments).out);
    const json info = infoOf(folder, "g.sheaf");
    CHECK(info["saved"] == "vertex groups");
    CHECK(info["version"] == grouping::kGroupsFileVersion);
    CHECK(info["bytes"] == folder.read("g.sheaf").size());
    CHECK(info["intact"] == true);
    for (const char* key :
         {"extent", "metric", "limit", "epsilon", "planes", "segment_only", "used_vertices", "eliminated_fraction",
          "grouped_vertices", "defining_vertices", "free_vertices", "groups", "displacement_fraction", "flipped_faces"})
      CHECK_MESSAGE(info[key] == said[key], key);
  }
  const RunResult text = runSheaf(folder, {"info", "g.sheaf"});
  for (const char* words : {"vertex groups, version 2, ", "intact", "planes across 9 directions; quadric metric, safe",
                            "joined vertices", "epsilon", "eliminated", "groups"})
    CHECK_MESSAGE(text.out.find(words) != std::string::npos, words);
}

TEST_CASE("cli/saved_file: info says of a saved hierarchy what it holds, whatever its name") {
  const TempFolder folder;
  run(folder, {"cluster", kTeapot, "--hierarchy", "h.sheaf"});
  std::filesystem::rename(folder.path() / "h.sheaf", folder.path() / "h");
  const grouping::FaceClusters clusters = grouping::decodeClusters(folder.read("h"), "h");
  const json info = infoOf(folder, "h");
  CHECK(info["saved"] == "face cluster hierarchy");
  CHECK(info["faces"] == clusters.faceCount());
  CHECK(info["clusters"] == clusters.children.size());
  CHECK(info["clusters_with_box"] == clusters.shapes.size());
  CHECK(info["components"] == clusters.roots.size());
  CHECK(info["root_costs"].size() <= clusters.roots.size());
  CHECK(info["root_costs"][0].get<double>() > 0.0);
  CHECK(info["depth"].get<double>() >= std::log2(clusters.faceCount() / clusters.roots.size()));
  const RunResult text = runSheaf(folder, {"info", "h"});
  for (const char* words : {"face cluster hierarchy, version 2, ", "intact", "faces", "components", "root costs"})
    CHECK_MESSAGE(text.out.find(words) != std::string::npos, words);
}

TEST_CASE("cli/saved_file: info refuses what is damaged, cut short, of another version or no saved file: one line") {
  const TempFolder folder;
  run(folder, {"group", kTeapot, "-o", "g.sheaf"});
  run(folder, {"cluster", kTeapot, "--hierarchy", "h.sheaf"});
  for (const char* name : {"g.sheaf", "h.sheaf"}) {
    const std::string good = folder.read(name);
    std::string damaged = good, newer = good;
    damaged[good.size() / 2] = static_cast<char>(damaged[good.size() / 2] ^ 1);
    newer[8] = 99;
    const std::vector<std::tuple<std::string, int, std::string>> bad = {
        {damaged, 3, "is damaged"},
        {good.substr(0, good.size() - 1), 3, "in place of"},
        {good.substr(0, 12), 3, "ends within its header"},
        {good + "x", 3, "in place of"},
        {newer, 4, "has version 99"},
        {"solid cube", 3, "neither vertex groups nor face clusters"},
        {"", 3, "neither vertex groups nor face clusters"}};
    for (const auto& [bytes, code, reason] : bad) {
      CAPTURE(reason);
      folder.write("bad.sheaf", bytes);
      for (const Words& arguments : {Words{"info", "bad.sheaf"}, Words{"info", "bad.sheaf", "--json"}}) {
        const RunResult result = runSheaf(folder, arguments);
        CAPTURE(result.err);
        CHECK(result.code == code);
        CHECK(result.out.empty());
        CHECK(isOneErrorLine(result.err));
        CHECK(result.err.find("bad.sheaf: ") != std::string::npos);
        CHECK(result.err.find(reason) != std::string::npos);
      }
    }
  }
  CHECK(runSheaf(folder, {"info", "missing.sheaf"}).code == 3);
}

}  // namespace sheaf::cli
