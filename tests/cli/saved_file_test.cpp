// Files that sheaf has saved, looked at and used again, run as a whole.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

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

TEST_CASE("cli/saved_file: saved groups of every kind are drawn, and drawn right, in any scene") {
  const TempFolder folder;
  // Two materials, two pieces that touch, corners without normals: drawn with more vertices than are grouped.
  folder.write("two.obj",
               "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 1\nv 2 0.001 0\nv 2 1 0.002\nusemtl a\nf 1 2 5\nf 2 3 5\n"
               "f 3 4 5\nf 4 1 5\nusemtl b\nf 2 6 7 3\n");
  const std::vector<Words> kinds = {{},
                                    {"--method", "linear"},
                                    {"--method", "cluster"},
                                    {"--planes", "both", "--metric", "quadric"},
                                    {"--epsilon", "2%", "--bits", "6"}};
  for (const std::string input : {kTeapot, "builtin:gallery?detail=1", "two.obj"})
    for (const Words& kind : kinds) {
      CAPTURE(input);
      Words arguments = {"group", input, "-o", "g.sheaf", "--json", "-q"};
      arguments.insert(arguments.end(), kind.begin(), kind.end());
      const json said = json::parse(runSheaf(folder, arguments).out);
      const RunResult compared = runSheaf(
          folder, {"compare", input, "--from", "g.sheaf", "--json", "-q", "--size", "160x120", "--views", "orbit:2"});
      CAPTURE(compared.err);
      REQUIRE(compared.code == 0);
      const json report = json::parse(compared.out);
      CHECK(report["drawing_right"] == true);
      CHECK(report["grouping"]["saved"] == true);
      CHECK(report["grouping"]["epsilon"] == said["epsilon"]);
      CHECK(report["grouping"]["metric"] == said["metric"]);
      if (kind.size() < 4)  // exact, but for the grid of 16 bits
        CHECK(report["displacement_fraction"]["max"].get<double>() ==
              doctest::Approx(said["displacement_fraction"]["max"].get<double>()).epsilon(0.01));
      run(folder, {"render", input, "--from", "g.sheaf", "--color-by", "group", "--overlay", "planes", "--size",
                   "90x60", "-o", "x.png", "-q"});
    }
  run(folder, {"group", kTeapot, "-o", "g.sheaf"});
  run(folder, {"bench", kTeapot, "--from", "g.sheaf", "--size", "90x60", "--frames", "2"});
}

TEST_CASE("cli/saved_file: saved groups fit whichever axis is up, and pictures do not depend on threads") {
  const TempFolder folder;
  run(folder, {"simplify", kTeapot, "--faces", "400", "-o", "t.ply", "-q"});
  run(folder, {"group", "t.ply", "-o", "g.sheaf"});
  const auto drawn = [&](const Words& options) {
    Words arguments = {"render", "t.ply", "--from", "g.sheaf", "--size", "100x80", "-o", "x.png", "-q"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    run(folder, arguments);
    return folder.read("x.png");
  };
  CHECK(drawn({"--view", "front"}) == drawn({"--view", "front", "--threads", "1"}));
  for (const char* up : {"y", "z"}) {
    const RunResult compared =
        runSheaf(folder, {"compare", "t.ply", "--from", "g.sheaf", "--up", up, "--json", "--size", "100x80"});
    REQUIRE(compared.code == 0);
    const json report = json::parse(compared.out);
    CHECK(report["displacement_fraction"]["max"].get<double>() > 0.004);
    CHECK(report["displacement_fraction"]["max"].get<double>() < 0.0051);
    CHECK(report["views"][0]["quality"]["silhouette_shift"]["mean_px"].get<double>() < 1.0);
  }
}

TEST_CASE("cli/saved_file: what --from cannot be used for is refused: one line, no file") {
  const TempFolder folder;
  run(folder, {"group", kTeapot, "-o", "g.sheaf"});
  run(folder, {"cluster", kTeapot, "--hierarchy", "h.sheaf"});
  const std::vector<std::tuple<Words, int, std::string>> wrong = {
      {{"render", "builtin:sphere", "--from", "g.sheaf", "-o", "x.png"}, 3, "g.sheaf: belongs to another mesh"},
      {{"compare", "builtin:sphere", "--from", "g.sheaf", "-o", "x.png"}, 3, "g.sheaf: belongs to another mesh"},
      {{"bench", "builtin:sphere", "--from", "g.sheaf"}, 3, "g.sheaf: belongs to another mesh"},
      {{"compare", kTeapot, "--from", "h.sheaf"}, 3, "h.sheaf: is not a file of vertex groups"},
      {{"cluster", kTeapot, "--from", "g.sheaf"}, 3, "g.sheaf: is not a file of face clusters"},
      {{"render", "g.sheaf", "-o", "x.png"}, 2, "g.sheaf holds vertex groups: give the mesh, and this with --from"},
      {{"compare", "h.sheaf"}, 2, "h.sheaf holds face clusters: give the mesh"},
      {{"compare", kTeapot, "g.sheaf"}, 2, "g.sheaf holds vertex groups: give the mesh"},
      {{"bench", "g.sheaf"}, 2, "give the mesh"},
      {{"group", "g.sheaf"}, 2, "give the mesh"},
      {{"cluster", "h.sheaf"}, 2, "give the mesh"},
      {{"cluster", "h.sheaf", "-o", "x.png"}, 2, "give the mesh"},
      {{"simplify", "h.sheaf", "--faces", "9", "-o", "x.ply"}, 2, "give the mesh"},
      {{"render", kTeapot, "--from", "missing.sheaf", "-o", "x.png"}, 3, "missing.sheaf: cannot be opened"},
      {{"render", kTeapot, "--from", "/dev/null", "-o", "x.png"}, 3, "/dev/null: is not a regular file"},
      {{"render", kTeapot, "--from", "", "-o", "x.png"}, 2, "--from: the name of the file is empty"},
      {{"render", kTeapot, "--from", "h.sheaf", "-o", "x.png"}, 2, "holds face clusters: add --color-by cluster"},
      {{"render", kTeapot, "--from", "g.sheaf", "--grouping", "planar", "-o", "x.png"}, 2, "--grouping decides how"},
      {{"render", kTeapot, "--from", "g.sheaf", "--epsilon", "1%", "-o", "x.png"}, 2, "--epsilon decides how"},
      {{"compare", kTeapot, "--from", "g.sheaf", "--metric", "quadric"}, 2, "--metric decides how"},
      {{"render", kTeapot, "--from", "g.sheaf", "--timings=g.sheaf"}, 2, "g.sheaf"},
  };
  for (const auto& [arguments, code, reason] : wrong) {
    CAPTURE(reason);
    const RunResult result = runSheaf(folder, arguments);
    CAPTURE(result.err);
    CHECK(result.code == code);
    CHECK(result.out.empty());
    CHECK(isOneErrorLine(result.err));
    CHECK(result.err.find(reason) != std::string::npos);
    CHECK(folder.fileCount() == 2);
  }
}

TEST_CASE("cli/saved_file: forged groups are not drawn: one line, no file") {
  const TempFolder folder;
  run(folder, {"group", kTeapot, "-o", "g.sheaf"});
  const grouping::VertexGroups good = grouping::loadGroups(folder.file("g.sheaf"));
  const auto free =
      static_cast<std::size_t>(std::ranges::find(good.state, grouping::VertexState::kFree) - good.state.begin());
  REQUIRE(free < good.state.size());
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  grouping::VertexGroups no_normal = good, nowhere = good, far = good;
  no_normal.planes[0].normal = Vec3(kNan);
  nowhere.positions[free] = Vec3(kNan);
  far.positions[free] = Vec3(1e38F);
  for (const auto& [forged, reason] :
       {std::pair{no_normal, "f.sheaf: damaged vertex groups: plane 0 has no orthonormal frame"},
        {nowhere, "is in no group, but not where the mesh has it"},
        {far, "is in no group, but not where the mesh has it"}})
    for (const char* command : {"render", "compare"}) {
      grouping::saveGroups(folder.file("f.sheaf"), forged);
      const RunResult result = runSheaf(folder, {command, kTeapot, "--from", "f.sheaf", "-o", "x.png"});
      CAPTURE(result.err);
      CHECK(result.code == 3);
      CHECK(result.out.empty());
      CHECK(isOneErrorLine(result.err));
      CHECK(result.err.find(reason) != std::string::npos);
      CHECK(folder.fileCount() == 2);
    }
}

}  // namespace sheaf::cli
