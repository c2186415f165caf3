// The command as a whole: help, version, scenes, info, exit codes, and what goes to which stream.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/cli/run.h"

namespace sheaf::cli {
namespace {

constexpr const char* kTriangleStl =
    "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid "
    "t\n";

}  // namespace

TEST_CASE("cli/command: help goes to stdout and names every option, examples and exit codes") {
  const TempFolder folder;
  const std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>> expected = {
      {{"--help"},
       {"render", "compare", "bench", "info", "group", "simplify", "scenes", "--version", "builtin:", "Examples",
        "Exit codes", "70"}},
      {{"render", "--help"},
       {"INPUT",
        "-o,",
        "--output",
        "--size",
        "--view",
        "--orbit",
        "--eye",
        "--target",
        "--up",
        "--fov",
        "--orthographic",
        "--camera",
        "--background",
        "--threads",
        "--no-patch-culling",
        "--crease",
        "--timings",
        "--trace",
        "--frames",
        "--simd",
        "-q,",
        "--quiet",
        "--channels",
        "--grouping",
        "--epsilon",
        "iso",
        "1280x720",
        "Examples",
        "Exit codes"}},
      {{"compare", "-h"},
       {"-o,", "--max-differing", "--max-error", "--min-psnr", "--json", "--grouping", "--metric", "--limit",
        "--epsilon", "--parameters", "--prefer", "--views", "--report", "--orbit", "--size", "Examples", "Exit codes"}},
      {{"bench", "--help"},
       {"INPUT", "--views", "--frames", "--grouping", "--metric", "--epsilon", "--threads", "--size", "--json",
        "inside", "Examples", "Exit codes"}},
      {{"info", "--help"}, {"--json", "--quiet", "Exit codes"}},
      {{"group", "--help"},
       {"--method", "--metric", "--limit", "--epsilon", "--planes", "--key", "--segment-only", "--no-flips", "-o,",
        "--bits", "--snapped", "--json", "-q,", "linear|planar", "0.5%", "Examples", "Exit codes"}},
      {{"simplify", "--help"},
       {"-o,", "--vertices", "--faces", "--attributes", "--json", "-q,", "Examples", "Exit codes"}},
      {{"scenes", "--help"}, {"--json", "Exit codes"}}};
  for (const auto& [arguments, words] : expected) {
    CAPTURE(arguments.front());
    const RunResult result = runSheaf(folder, arguments);
    CHECK(result.code == 0);
    CHECK(result.err.empty());
    for (const std::string& word : words) CHECK_MESSAGE(result.out.find(word) != std::string::npos, word);
  }
}

TEST_CASE("cli/command: --version names version, compiler and SIMD targets") {
  const RunResult result = runSheaf(TempFolder(), {"--version"});
  CHECK(result.code == 0);
  CHECK(result.out.starts_with("sheaf "));
  CHECK(result.out.find("revision") != std::string::npos);
  CHECK(result.out.find("SIMD targets") != std::string::npos);
  CHECK(result.err.empty());
}

TEST_CASE("cli/command: wrong usage is one line on stderr, nothing on stdout, exit code 2, no file") {
  const TempFolder folder;
  folder.write("t.stl", kTriangleStl);
  const std::vector<std::vector<std::string>> wrong = {
      {},
      {"nosuchcommand"},
      {"--nosuchoption"},
      {"render"},
      {"render", "builtin:sphere"},
      {"render", "builtin:sphere", "-o"},
      {"render", "builtin:sphere", "-o", ""},
      {"render", "builtin:sphere", "-o", "x.xyz"},
      {"render", "builtin:sphere", "-o", "x.png", "--nosuchoption"},
      {"render", "builtin:sphere", "-o", "x.png", "extra"},
      {"render", "builtin:sphere", "-o", "x.png", "--size", "0x0"},
      {"render", "builtin:sphere", "-o", "x.png", "--size", "99999x1"},
      {"render", "builtin:sphere", "-o", "x.png", "--size="},
      {"render", "builtin:sphere", "-o", "x.png", "--size", ""},
      {"render", "builtin:sphere", "-o", "x.png", "--view", "sideways"},
      {"render", "builtin:sphere", "-o", "x.png", "--view", "iso", "--orbit", "1,2"},
      {"render", "builtin:sphere", "-o", "x.png", "--orbit", "0,90"},
      {"render", "builtin:sphere", "-o", "x.png", "--eye", "1,1,1", "--camera", "0"},
      {"render", "builtin:sphere", "-o", "x.png", "--eye", "1,1,1", "--target", "1,1,1"},
      {"render", "builtin:sphere", "-o", "x.png", "--target", "1,1,1"},
      {"render", "builtin:sphere", "-o", "x.png", "--up", "0,1,0"},
      {"render", "builtin:sphere", "-o", "x.png", "--up", "z"},
      {"render", "t.stl", "-o", "x.png", "--up", "z", "--up", "y"},
      {"render", "builtin:sphere", "-o", "x.png", "--crease", "30"},
      {"render", "t.stl", "-o", "x.png", "--crease", "181"},
      {"render", "builtin:sphere", "-o", "x.png", "--fov", "0"},
      {"render", "builtin:sphere", "-o", "x.png", "--fov", "40", "--orthographic"},
      {"render", "builtin:sphere", "-o", "x.png", "--camera", "nosuchcamera"},
      {"render", "builtin:sphere", "-o", "x.png", "--background", "puce"},
      {"render", "builtin:sphere", "-o", "x.jpg", "--background", "transparent"},
      {"render", "builtin:sphere", "-o", "x.png", "--threads", "0"},
      {"render", "builtin:sphere", "-o", "x.png", "--threads", "1.5"},
      {"render", "builtin:sphere", "-o", "x.png", "--frames", "3"},
      {"render", "builtin:sphere", "-o", "x.png", "--timings", "--frames", "0"},
      {"render", "builtin:sphere", "-o", "x.png", "--simd", "MMX"},
      {"render", "builtin:sphere", "-o", "x.png", "--grouping", "circular"},
      {"render", "builtin:sphere", "-o", "x.png", "--epsilon", "1%"},
      {"render", "builtin:sphere", "-o", "x.png", "--grouping", "none", "--metric", "quadric"},
      {"render", "builtin:sphere", "-o", "x.png", "--grouping", "planar", "--epsilon", "-1"},
      {"compare", "builtin:sphere", "--grouping", "none"},
      {"render", "builtin:sphere", "-o", "x.png", "--channels", "depth"},
      {"render", "builtin:sphere", "-o", "x.exr", "--channels", "smell"},
      {"render", "builtin:sphere", "-o", "x.png", "--timings=x.png"},
      {"render", "builtin:sphere", "-o", "x.png", "--trace", "./x.png"},
      {"render", "t.stl", "-o", "x.png", "--trace", "t.stl"},
      {"render", "builtin:nosuchscene", "-o", "x.png"},
      {"render", "builtin:sphere?nosuchparameter=1", "-o", "x.png"},
      {"compare", "a.png"},
      {"compare", "a.png", "b.png", "--max-differing", "lots"},
      {"compare", "a.png", "b.png", "--max-error", "256"},
      {"compare", "a.png", "b.png", "-o", "a.png"},
      {"compare", "a.png", "b.png", "-o", "heat.exr"},
      {"compare", "a.png", "b.png", "-o", ""},
      {"compare", "a.png", "b.png", "--views", "orbit"},
      {"compare", "a.png", "b.png", "--size", "9x9"},
      {"compare", "a.png", "b.png", "-q"},
      {"compare", "builtin:sphere", "-o", "x.exr"},
      {"compare", "builtin:sphere", "-o", "x.png", "--size", "16384x1"},
      {"compare", "builtin:sphere", "--grouping", "none"},
      {"compare", "builtin:sphere", "--metric", "taxi"},
      {"compare", "builtin:sphere", "--limit", "safe"},
      {"compare", "builtin:sphere", "--metric", "quadric", "--limit", "brave"},
      {"compare", "builtin:sphere", "--epsilon", "101%"},
      {"compare", "builtin:sphere", "--parameters", "8bit"},
      {"compare", "builtin:sphere", "--prefer", "both"},
      {"compare", "builtin:sphere", "--views", "everywhere"},
      {"compare", "builtin:sphere", "--views", "orbit:0"},
      {"compare", "builtin:sphere", "--views", "inside:3"},
      {"compare", "builtin:sphere", "--views", "orbit", "--view", "iso"},
      {"compare", "builtin:sphere", "--views", "orbit", "--eye", "1,1,1"},
      {"compare", "builtin:sphere", "--views", "fly", "--orbit", "0,0"},
      {"compare", "builtin:sphere", "--views", "inside", "--orthographic"},
      {"compare", "builtin:sphere", "--views", "c.json", "--fov", "50"},
      {"compare", "builtin:sphere", "--max-differing", "lots"},
      {"compare", "builtin:sphere", "--background", "puce"},
      {"bench"},
      {"bench", "builtin:sphere", "--frames", "0"},
      {"bench", "builtin:sphere", "--frames", "2.5"},
      {"bench", "builtin:sphere", "--views", "somewhere"},
      {"bench", "builtin:sphere", "--views", "orbit", "--eye", "1,1,1"},
      {"bench", "builtin:sphere", "--views", "fly", "--orthographic"},
      {"bench", "builtin:sphere", "--grouping", "none"},
      {"bench", "builtin:sphere", "--epsilon", "lots"},
      {"bench", "builtin:sphere", "--threads", "0"},
      {"bench", "builtin:sphere", "--simd", "MMX"},
      {"bench", "builtin:sphere", "extra"},
      {"bench", "builtin:sphere", "--report", "x.txt"},
      {"bench", "builtin:sphere", "--report", ""},
      {"compare", "builtin:sphere", "--report", "x.png"},
      {"compare", "a.png", "b.png", "--report", "x.html"},
      {"info"},
      {"scenes", "extra"},
  };
  for (const auto& arguments : wrong) {
    std::string line;
    for (const std::string& word : arguments) line += word + " ";
    CAPTURE(line);
    const RunResult result = runSheaf(folder, arguments);
    CAPTURE(result.err);
    CHECK(result.code == 2);
    CHECK(result.out.empty());
    CHECK(isOneErrorLine(result.err));
    CHECK(folder.fileCount() == 1);
  }
}

TEST_CASE("cli/command: bad input is one line that names the file, exit code 3, no file") {
  const TempFolder folder;
  folder.write("empty.stl", "");
  folder.write("cut.stl", std::string(90, '\1'));
  folder.write("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  std::filesystem::create_directory(folder.file("folder"));
  const std::size_t files = folder.fileCount();
  const std::vector<std::vector<std::string>> bad = {
      {"render", "missing.stl", "-o", "x.png"},
      {"render", "empty.stl", "-o", "x.png"},
      {"render", "cut.stl", "-o", "x.png"},
      {"render", "range.obj", "-o", "x.png"},
      {"render", "folder", "-o", "x.png"},
      {"info", "missing.ply"},
      {"compare", "missing.png", "empty.stl"},
      {"compare", "missing.ply"},
      {"bench", "missing.ply"},
      {"bench", "builtin:sphere", "--report", "no/such/folder/x.html"},
      {"bench", "builtin:sphere", "--views", "missing.json"},
      {"compare", "builtin:sphere", "--views", "missing.json"},
      {"compare", "builtin:sphere", "-o", "no/such/folder/x.png"},
      {"compare", "cut.stl", "cut.stl"},
      {"render", "builtin:sphere", "-o", "no/such/folder/x.png"},
      {"render", "builtin:sphere", "--trace", "no/such/folder/x.json"},
      {"render", "builtin:sphere", "--timings=folder"},
      {"render", "builtin:sphere", "-o", "empty.stl/x.png"},
  };
  for (const auto& arguments : bad) {
    CAPTURE(arguments[1]);
    CAPTURE(arguments.back());
    const RunResult result = runSheaf(folder, arguments);
    CAPTURE(result.err);
    CHECK(result.code == 3);
    CHECK(result.out.empty());
    CHECK(isOneErrorLine(result.err));
    CHECK(folder.fileCount() == files);
  }
}

TEST_CASE("cli/command: a format without its module is unsupported, exit code 4") {
  const TempFolder folder;
  folder.write("sheaf_oiio.so", "not a module");
  const RunResult result =
      runSheaf(folder, {"render", "builtin:sphere", "-o", "x.exr"},
               {.environment = {{"SHEAF_MODULE_DIR", folder.path().string()}}, .max_memory = 0, .out_path = {}});
  CAPTURE(result.err);
  CHECK(result.code == 4);
  CHECK(isOneErrorLine(result.err));
  CHECK(!folder.has("x.exr"));
}

#ifndef __SANITIZE_ADDRESS__
TEST_CASE("cli/command: running out of memory is an internal error, exit code 70, no file") {
  const TempFolder folder;
  const RunResult result = runSheaf(folder, {"render", "builtin:sphere", "-o", "x.png", "--size", "16384x16384"},
                                    {.environment = {}, .max_memory = std::size_t{600} << 20, .out_path = {}});
  CAPTURE(result.err);
  CHECK(result.code == 70);
  CHECK(result.err.find("internal error") != std::string::npos);
  CHECK(isOneErrorLine(result.err));
  CHECK(folder.fileCount() == 0);
}
#endif

TEST_CASE("cli/command: a full disk under stdout is noticed") {
  if (!std::filesystem::exists("/dev/full")) return;
  const TempFolder folder;
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"scenes"}, {"render", "builtin:sphere?n=4", "-o", "-"}}) {
    const RunResult result = runSheaf(folder, arguments, {.environment = {}, .max_memory = 0, .out_path = "/dev/full"});
    CHECK(result.code == 3);
    CHECK(isOneErrorLine(result.err));
  }
}

TEST_CASE("cli/command: scenes lists the built-in scenes, as text and as JSON") {
  const TempFolder folder;
  const RunResult text = runSheaf(folder, {"scenes"});
  CHECK(text.code == 0);
  CHECK(text.err.empty());
  const RunResult json_text = runSheaf(folder, {"scenes", "--json"});
  CHECK(json_text.code == 0);
  const auto json = nlohmann::json::parse(json_text.out);
  REQUIRE(json.size() >= 5);
  for (const auto& scene : json) {
    CHECK(text.out.find("builtin:" + scene["name"].get<std::string>()) != std::string::npos);
    for (const auto& parameter : scene["parameters"]) {
      CHECK(parameter["min"].get<double>() <= parameter["default"].get<double>());
      CHECK(parameter["default"].get<double>() <= parameter["max"].get<double>());
    }
  }
}

TEST_CASE("cli/command: info says what is in a file, as text and as JSON, with warnings on stderr") {
  const TempFolder folder;
  folder.write("t.stl", kTriangleStl);
  folder.write("w.obj", "mtllib missing.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const RunResult text = runSheaf(folder, {"info", "t.stl"});
  CHECK(text.code == 0);
  CHECK(text.err.empty());
  CHECK(text.out.find("1 triangles") != std::string::npos);
  const auto json = nlohmann::json::parse(runSheaf(folder, {"info", "t.stl", "--json"}).out);
  CHECK(json["triangles"] == 1);
  CHECK(json["file_vertices"] == 3);
  CHECK(json["bounds"]["max"] == nlohmann::json::array({1.0, 1.0, 0.0}));
  CHECK(json["warnings"].empty());

  const RunResult warned = runSheaf(folder, {"info", "w.obj"});
  CHECK(warned.code == 0);
  CHECK(warned.err.starts_with("warning: "));
  CHECK(warned.out.find("warning: ") == std::string::npos);
  CHECK(runSheaf(folder, {"info", "w.obj", "-q"}).err.empty());
  const RunResult warned_json = runSheaf(folder, {"info", "w.obj", "--json"});
  CHECK(nlohmann::json::parse(warned_json.out)["warnings"].size() == 1);
}

TEST_CASE("cli/command: each count of vertices has its name, the same in every command") {
  const TempFolder folder;
  // A sheet with a fold along its middle: made normals split its 31 vertices. One place is there twice.
  std::string obj;
  for (int y = 0; y <= 30; ++y)
    for (int x = -15; x <= 15; ++x) obj += fmt::format("v {} {} {}\n", x, y, 2 * std::abs(x));
  obj += "v 0 0 0\n";
  for (int y = 0; y < 30; ++y)
    for (int x = 1; x <= 30; ++x) {
      const int a = 31 * y + x;
      obj += fmt::format("f {} {} {} {}\n", a == 16 ? 962 : a, a + 1, a + 32, a + 31);
    }
  folder.write("sheet.obj", obj);
  const auto said = [&](std::vector<std::string> words) {
    words.insert(words.begin() + 1, "sheet.obj");
    const RunResult text = runSheaf(folder, words);
    words.emplace_back("--json");
    const RunResult json = runSheaf(folder, words);
    CAPTURE(json.err);
    REQUIRE(text.code == 0);
    return std::pair(text.out, nlohmann::json::parse(json.out));
  };
  const auto [info, info_json] = said({"info"});
  CHECK(info.find("(962 file vertices, 1800 triangles") != std::string::npos);
  CHECK(info_json["file_vertices"] == 962);
  const auto [group, group_json] = said({"group"});
  CHECK(group.find("962 joined vertices, 1800") != std::string::npos);
  CHECK(group.find("of 962 joined vertices in use)") != std::string::npos);
  CHECK(group_json["joined_vertices"] == 962);
  const auto [cluster, cluster_json] = said({"cluster"});
  CHECK(cluster.find("961 surface vertices") != std::string::npos);
  CHECK(cluster_json["surface_vertices"] == 961);
  const auto [simplify, simplify_json] = said({"simplify", "--faces", "100", "-o", "x.ply"});
  CHECK(simplify.find("962 joined vertices in use to ") != std::string::npos);
  const auto [compare, compare_json] = said({"compare", "--size", "64x48"});
  CHECK(compare.find("of 992 drawn vertices in use)") != std::string::npos);
  CHECK(compare_json["drawn_vertices"] == 992);
  const auto [bench, bench_json] = said({"bench", "--size", "64x48", "--frames", "1"});
  CHECK(bench.find(" patch vertices\n") != std::string::npos);
  CHECK(bench.find("drawn vertices eliminated") != std::string::npos);
  CHECK(bench_json["patch_vertices"] > 992);
}

}  // namespace sheaf::cli
