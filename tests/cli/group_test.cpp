// `sheaf group`, run as a whole.
#include <doctest/doctest.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "grouping/groups_file.h"
#include "scenes/scene.h"
#include "tests/cli/run.h"

namespace sheaf::cli {
namespace {

using Words = std::vector<std::string>;
using nlohmann::json;

constexpr const char* kSphere = "builtin:sphere?n=12";

json grouped(const TempFolder& folder, Words options, const std::string& input = kSphere) {
  options.insert(options.begin(), {"group", input, "--json"});
  const RunResult result = runSheaf(folder, options);
  CAPTURE(result.err);
  REQUIRE(result.code == 0);
  CHECK(result.err.empty());
  return json::parse(result.out);
}

std::string pyramidObj() {
  return "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
}

}  // namespace

TEST_CASE("cli/group: a table on stdout, nothing on stderr, no file") {
  const TempFolder folder;
  const RunResult result = runSheaf(folder, {"group", kSphere});
  CHECK(result.code == 0);
  CHECK(result.err.empty());
  CHECK(folder.fileCount() == 0);
  for (const char* word :
       {"planar, 3 axis planes; distance metric", "epsilon           0.5 %", "eliminated", "defining", "free", "groups",
        "displacement", "RMS", "normal deviation", "flipped", "bits per vertex", " ms\n"})
    CHECK_MESSAGE(result.out.find(word) != std::string::npos, word);
}

TEST_CASE("cli/group: the JSON's counts add up and its displacements keep to epsilon") {
  const TempFolder folder;
  const json j = grouped(folder, {});
  const auto count = [&](const char* name) { return j[name].get<int>(); };
  CHECK(count("grouped_vertices") + count("defining_vertices") + count("free_vertices") == count("used_vertices"));
  CHECK(count("used_vertices") <= count("joined_vertices"));
  CHECK(j["eliminated_fraction"].get<double>() ==
        doctest::Approx(double(count("grouped_vertices")) / count("used_vertices")));
  CHECK(j["displacement_fraction"]["max"].get<double>() <= 0.005001);
  CHECK(j["displacement_fraction"]["mean"] <= j["displacement_fraction"]["rms"]);
  CHECK(j["method"] == "planar");
  CHECK(j["metric"] == "distance");
  CHECK(j["limit"].is_null());
  CHECK(j["planes"] == 3);
  CHECK(j["key"] == "auto");
  CHECK(j["bits_per_vertex"]["floats"] == 96.0);
  CHECK(j["bits_per_vertex"]["grid_bits"] == 14);
}

TEST_CASE("cli/group: every option reaches the search") {
  const TempFolder folder;
  const json plain = grouped(folder, {});
  CHECK(grouped(folder, {"--epsilon", "0.5%"})["groups"] == plain["groups"]);
  CHECK(grouped(folder, {"--epsilon", "0.005"})["groups"] == plain["groups"]);
  CHECK(grouped(folder, {"--epsilon", "2%"})["eliminated_fraction"] > plain["eliminated_fraction"]);
  CHECK(grouped(folder, {"--planes", "dodecahedron"})["planes"] == 6);
  CHECK(grouped(folder, {"--planes", "both"})["planes"] == 9);
  CHECK(grouped(folder, {"--key", "dynamic"})["key"] == "dynamic");
  CHECK(grouped(folder, {"--key", "dynamic"})["eliminated_fraction"] >= plain["eliminated_fraction"]);

  const json linear = grouped(folder, {"--method", "linear"});
  CHECK(linear["method"] == "linear");
  CHECK(linear["planes"].is_null());
  CHECK(linear["key"].is_null());
  CHECK(linear["segment_only"] == false);
  CHECK(linear["eliminated_fraction"] < plain["eliminated_fraction"]);
  const json segments = grouped(folder, {"--method", "linear", "--segment-only"});
  CHECK(segments["segment_only"] == true);

  const json quadric = grouped(folder, {"--metric", "quadric", "--epsilon", "1%"});
  CHECK(quadric["metric"] == "quadric");
  CHECK(quadric["limit"] == "safe");
  CHECK(quadric["flipped_faces"] == 0);
  const json paper = grouped(folder, {"--metric", "quadric", "--epsilon", "1%", "--limit", "paper"});
  CHECK(paper["limit"] == "paper");
  CHECK(paper["groups"] != quadric["groups"]);
}

TEST_CASE("cli/group: --no-flips leaves no flipped face where there were some") {
  const TempFolder folder;
  CHECK(grouped(folder, {"--epsilon", "4%"}, "builtin:teapot?n=6")["flipped_faces"] > 0);
  const json held = grouped(folder, {"--epsilon", "4%", "--no-flips"}, "builtin:teapot?n=6");
  CHECK(held["flipped_faces"] == 0);
  CHECK(held["collapsed_faces"] == 0);
  CHECK(held["restored_vertices"] > 0);
}

TEST_CASE("cli/group: planes from a file, and a file that cannot be used") {
  const TempFolder folder;
  folder.write("axes.txt", "1 0 0\n0 1 0\n0 0 1\n");
  CHECK(grouped(folder, {"--planes", "axes.txt"})["groups"] == grouped(folder, {})["groups"]);
  const RunResult table = runSheaf(folder, {"group", kSphere, "--planes", "axes.txt"});
  CHECK(table.out.find("3 planes of axes.txt") != std::string::npos);
  folder.write("axes.txt", "1 0 0\n0 1\n");
  const RunResult bad = runSheaf(folder, {"group", kSphere, "--planes", "axes.txt"});
  CHECK(bad.code == 3);
  CHECK(isOneErrorLine(bad.err));
  CHECK(bad.err.find("axes.txt:2: ") != std::string::npos);
}

TEST_CASE("cli/group: -o saves groups that load again, --snapped the mesh with its vertices moved") {
  const TempFolder folder;
  const json j = grouped(folder, {"-o", "g.sheaf", "--snapped", "s.ply"});
  CHECK(folder.fileCount() == 2);
  const grouping::VertexGroups groups = grouping::loadGroups(folder.file("g.sheaf"));
  CHECK(groups.groups.size() == j["groups"]);
  CHECK(groups.stats.grouped == j["grouped_vertices"]);
  const scenes::Scene scene = scenes::loadScene(folder.file("s.ply"));
  CHECK(scene.meshes.at(0).positions == groups.positions);
  // Fewer bits make a smaller file, and what they cost is reported for as many.
  const json coarse = grouped(folder, {"-o", "c.sheaf", "--bits", "10"});
  CHECK(coarse["bits_per_vertex"]["grid_bits"] == 10);
  CHECK(folder.read("c.sheaf").size() < folder.read("g.sheaf").size());
}

TEST_CASE("cli/group: a file's own vertices are grouped, not those that drawing splits at creases") {
  const TempFolder folder;
  folder.write("pyramid.obj", pyramidObj());
  CHECK(grouped(folder, {}, "pyramid.obj")["joined_vertices"] == 5);
  // Two materials cut the surface up; it is grouped whole.
  folder.write("two.obj", pyramidObj() + "usemtl other\nf 1 3 2\nf 1 4 3\n");
  const json two = grouped(folder, {"-q"}, "two.obj");
  CHECK(two["joined_vertices"] == 5);
  CHECK(two["triangles"] == 6);
}

TEST_CASE("cli/group: points without faces are grouped by distance, and a warning says so") {
  const TempFolder folder;
  folder.write("p.off", "OFF\n3 0 0\n0 0 0\n1 2 3\n0 5 6\n");
  const RunResult result = runSheaf(folder, {"group", "p.off", "--metric", "quadric"});
  CHECK(result.code == 0);
  CHECK(result.err.find("warning: p.off: ") == 0);
  CHECK(result.out.find("distance metric") != std::string::npos);
  CHECK(runSheaf(folder, {"group", "p.off", "--metric", "quadric", "-q"}).err.empty());
  const json j = grouped(folder, {"--metric", "quadric"}, "p.off");
  CHECK(j["metric"] == "distance");
  CHECK(j["warnings"].size() == 1);
  folder.write("p.off", "OFF\n3 0 0\n0 0 0\n1 nan 3\n0 5 6\n");
  const RunResult bad = runSheaf(folder, {"group", "p.off"});
  CHECK(bad.code == 3);
  CHECK(isOneErrorLine(bad.err));
  CHECK(bad.err.find("p.off: vertex 1") != std::string::npos);
}

TEST_CASE("cli/group: by cluster, every patch has a frame, and the saved groups are whole") {
  const TempFolder folder;
  const json j =
      grouped(folder, {"--method", "cluster", "-o", "g.sheaf", "--snapped", "s.ply"}, "builtin:terrain?n=65");
  CHECK(j["method"] == "cluster");
  CHECK(j["key"].is_null());
  CHECK(j["planes"] > 10);
  CHECK(j["eliminated_fraction"].get<double>() > 0.3);
  CHECK(j["displacement_fraction"]["max"].get<double>() <= 0.005001);
  const grouping::VertexGroups groups = grouping::loadGroups(folder.path() / "g.sheaf");
  CHECK(groups.groups.size() == j["groups"]);
  CHECK(groups.planes.size() == j["planes"]);
  CHECK(grouped(folder, {"--method", "cluster", "--no-flips"}, "builtin:terrain?n=65")["flipped_faces"] == 0);
  const RunResult text = runSheaf(folder, {"group", kSphere, "--method", "cluster", "--metric", "quadric"});
  CHECK(text.out.find("cluster, a frame for each patch; quadric metric, safe limit") != std::string::npos);
}

TEST_CASE("cli/group: what makes no sense is refused with the reason: one line, exit code 2, no file") {
  const TempFolder folder;
  folder.write("t.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const std::vector<std::pair<Words, std::string>> wrong = {
      {{"--method", "linear", "--planes", "axis"}, "--planes is for planar"},
      {{"--method", "linear", "--key", "sum"}, "--key is for planar"},
      {{"--segment-only"}, "--segment-only is for linear"},
      {{"--method", "cluster", "--planes", "axis"}, "--planes is for planar"},
      {{"--method", "cluster", "--key", "sum"}, "--key is for planar"},
      {{"--limit", "safe"}, "--limit is for the quadric metric"},
      {{"--metric", "distance", "--limit", "paper"}, "--limit is for the quadric metric"},
      {{"--metric", "quadric", "--no-flips"}, "no face flip"},
      {{"--bits", "8"}, "add -o"},
      {{"--bits", "17", "-o", "x.sheaf"}, "1 to 16"},
      {{"--method", "circular"}, "linear, planar"},
      {{"--metric", "l1"}, "distance, quadric"},
      {{"--limit", "none", "--metric", "quadric"}, "safe, paper"},
      {{"--key", "best"}, "auto, union, sum, dynamic"},
      {{"--epsilon", "2"}, "0.5%"},
      {{"--epsilon", "-1%"}, "0.5%"},
      {{"--planes", ""}, "--planes"},
      {{"-o", "x.ply"}, ".sheaf"},
      {{"-o", ""}, ".sheaf"},
      {{"--snapped", "x.obj"}, ".ply"},
      {{"--nonsense"}, "--nonsense"},
  };
  for (const auto& [options, reason] : wrong) {
    CAPTURE(reason);
    Words arguments = {"group", "t.off"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const RunResult result = runSheaf(folder, arguments);
    CAPTURE(result.err);
    CHECK(result.code == 2);
    CHECK(result.out.empty());
    CHECK(isOneErrorLine(result.err));
    CHECK(result.err.find(reason) != std::string::npos);
    CHECK(folder.fileCount() == 1);
  }
}

TEST_CASE("cli/group: outputs that cannot be written are refused before anything is done") {
  const TempFolder folder;
  folder.write("t.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  CHECK(runSheaf(folder, {"group", "t.off", "-o", "none/x.sheaf"}).code == 3);
  CHECK(runSheaf(folder, {"group", "none.off", "-o", "x.sheaf"}).code == 3);
  folder.write("t.ply", "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nend_header\n");
  const RunResult result = runSheaf(folder, {"group", "t.ply", "--snapped", "t.ply"});
  CHECK(result.code == 2);
  CHECK(result.err.find("would overwrite the input") != std::string::npos);
  CHECK(folder.fileCount() == 2);
}

TEST_CASE("cli/group: a signal ends a long run as signals do, without any file") {
  const TempFolder folder;
  for (const int signal : {SIGINT, SIGTERM}) {
    RunSettings settings;
    settings.signal = signal;
    const RunResult result = runSheaf(
        folder, {"group", "builtin:terrain?n=256", "--method", "linear", "-o", "x.sheaf", "--snapped", "x.ply"},
        settings);
    CHECK(result.code == 128 + signal);
    CHECK(result.out.empty());
    CHECK(folder.fileCount() == 0);
  }
}

TEST_CASE("cli/group: progress is shown on a terminal only, and cleared") {
  const TempFolder folder;
  const Words arguments = {"group", "builtin:sphere?n=20", "--method", "linear"};
  CHECK(runSheaf(folder, arguments).err.empty());
  RunSettings settings;
  settings.err_is_terminal = true;
  const std::string shown = runSheaf(folder, arguments, settings).err;
  CHECK(shown.starts_with("\rgrouping "));
  CHECK(shown.find(" %") != std::string::npos);
  CHECK(shown.ends_with("\r"));
  Words quiet = arguments;
  quiet.emplace_back("-q");
  CHECK(runSheaf(folder, quiet, settings).err.empty());
}

}  // namespace sheaf::cli
