// `sheaf render`, run as a whole on small scenes.
#include <doctest/doctest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "raster/image_compare.h"
#include "raster/image_io.h"
#include "tests/cli/run.h"

namespace sheaf::cli {
namespace {

using Words = std::vector<std::string>;

/// Renders a small sphere with further options into `name` and reads the picture.
Image8 rendered(const TempFolder& folder, const std::string& name, Words options = {}) {
  Words arguments = {"render", "builtin:sphere?n=8", "--size", "131x97", "-o", name};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const RunResult result = runSheaf(folder, arguments);
  CAPTURE(result.err);
  REQUIRE(result.code == 0);
  return raster::readImage(folder.file(name));
}

}  // namespace

TEST_CASE("cli/render: a picture of the size asked for, silently, and no other file") {
  const TempFolder folder;
  const RunResult result = runSheaf(folder, {"render", "builtin:sphere?n=8", "--size", "131x97", "-o", "a.png"});
  CHECK(result.code == 0);
  CHECK(result.out.empty());
  CHECK(result.err.empty());
  CHECK(folder.fileCount() == 1);
  const Image8 image = raster::readImage(folder.file("a.png"));
  CHECK(image.width() == 131);
  CHECK(image.height() == 97);
  // The sphere is in the middle and the background at the corners is the light neutral one.
  CHECK(image.at(0, 0) == image.at(130, 96));
  CHECK(image.at(0, 0).r > 220);
  CHECK(!(image.at(65, 48) == image.at(0, 0)));
}

TEST_CASE("cli/render: the default size is 1280x720") {
  const TempFolder folder;
  REQUIRE(runSheaf(folder, {"render", "builtin:sphere?n=2", "-o", "a.png"}).code == 0);
  CHECK(raster::readImage(folder.file("a.png")).width() == 1280);
}

TEST_CASE("cli/render: the same bytes for any number of threads, any SIMD target and any culling") {
  const TempFolder folder;
  const Image8 expected = rendered(folder, "a.png", {"--threads", "1"});
  CHECK(rendered(folder, "b.png", {"--threads", "2"}) == expected);
  CHECK(rendered(folder, "c.png", {"--threads", "7"}) == expected);
  CHECK(rendered(folder, "d.png", {"--no-patch-culling"}) == expected);
  CHECK(folder.read("a.png") == folder.read("c.png"));
  const std::string version = runSheaf(folder, {"--version"}).out;
  const std::string targets = version.substr(version.find("here: ") + 6);
  for (std::size_t at = 0; at < targets.size();) {
    const std::size_t end = targets.find_first_of(",\n", at);
    const std::string target = targets.substr(at, end - at);
    CAPTURE(target);
    CHECK(rendered(folder, "e.png", {"--simd", target}) == expected);
    at = end + (targets[end] == ',' ? 2 : 1);
  }
}

TEST_CASE("cli/render: -o - writes the same PNG to stdout, and the table then goes to stderr") {
  const TempFolder folder;
  rendered(folder, "a.png");
  const Words to_stdout = {"render", "builtin:sphere?n=8", "--size", "131x97", "-o", "-"};
  const RunResult result = runSheaf(folder, to_stdout);
  CHECK(result.code == 0);
  CHECK(result.err.empty());
  CHECK(result.out == folder.read("a.png"));
  Words with_table = to_stdout;
  with_table.emplace_back("--timings");
  const RunResult table = runSheaf(folder, with_table);
  CHECK(table.out == folder.read("a.png"));
  CHECK(table.err.find("setup+bin") != std::string::npos);
}

TEST_CASE("cli/render: the background is what was asked for, transparent too") {
  const TempFolder folder;
  CHECK(rendered(folder, "a.png", {"--background", "#0a141e"}).at(0, 0) == Rgba8{10, 20, 30, 255});
  CHECK(rendered(folder, "b.png", {"--background", "red"}).at(0, 0) == Rgba8{255, 0, 0, 255});
  const Image8 clear = rendered(folder, "c.png", {"--background", "transparent"});
  CHECK(clear.at(0, 0).a == 0);
  CHECK(clear.at(65, 48).a == 255);
  CHECK(rendered(folder, "d.jpg").width() == 131);
}

TEST_CASE("cli/render: views differ where they should and agree where they should") {
  const TempFolder folder;
  const auto teapot = [&](const std::string& name, Words options) {
    Words arguments = {"render", "builtin:teapot?n=2", "--size", "64x48", "-o", name};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const RunResult result = runSheaf(folder, arguments);
    CAPTURE(result.err);
    REQUIRE(result.code == 0);
    return raster::readImage(folder.file(name));
  };
  const Image8 front = teapot("front.png", {"--view", "front"});
  CHECK(teapot("orbit.png", {"--orbit", "0,0"}) == front);
  CHECK(!(teapot("iso.png", {"--view", "iso"}) == front));
  CHECK(!(teapot("parallel.png", {"--view", "front", "--orthographic"}) == front));
  CHECK(!(teapot("wide.png", {"--view", "front", "--fov", "100"}) == front));
  const Words eye = {"--eye", "1,3,9", "--target", "0,1,0"};
  const Image8 upright = teapot("eye.png", eye);
  CHECK(!(upright == front));
  Words tilted = eye;
  tilted.insert(tilted.end(), {"--up", "1,0,0"});
  CHECK(!(teapot("tilted.png", tilted) == upright));
}

TEST_CASE("cli/render: --up z turns a file whose z axis is up") {
  const TempFolder folder;
  // A tall thin triangle along z: seen from the front it is a speck, turned up it fills the height.
  folder.write("z.off", "OFF\n3 1 0\n-0.2 0 0\n0.2 0 0\n0 0 3\n3 0 1 2\n");
  folder.write("y.off", "OFF\n3 1 0\n-0.2 0 0\n0.2 0 0\n0 3 0\n3 0 1 2\n");
  const Words options = {"--view", "front", "--size", "40x60"};
  const auto draw = [&](const std::string& input, const std::string& output, Words more) {
    Words arguments = {"render", input, "-o", output};
    arguments.insert(arguments.end(), options.begin(), options.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult result = runSheaf(folder, arguments);
    CAPTURE(result.err);
    REQUIRE(result.code == 0);
    return raster::readImage(folder.file(output));
  };
  const raster::ImageDifference difference =
      raster::compareImages(draw("z.off", "z.png", {"--up", "z"}), draw("y.off", "y.png", {}));
  CHECK(difference.max_error <= 1);  // normals are rounded in the file's own axes
  CHECK(!(draw("z.off", "flat.png", {}) == draw("y.off", "y.png", {"--up", "y"})));
}

TEST_CASE("cli/render: warnings go to stderr, one line each, unless quiet") {
  const TempFolder folder;
  folder.write("w.obj", "mtllib missing.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Words arguments = {"render", "w.obj", "--size", "16x16", "-o", "a.png"};
  const RunResult result = runSheaf(folder, arguments);
  CHECK(result.code == 0);
  CHECK(result.out.empty());
  CHECK(result.err.starts_with("warning: "));
  CHECK(result.err.find('\x1b') == std::string::npos);  // no colours: not a terminal
  Words quiet = arguments;
  quiet.emplace_back("-q");
  CHECK(runSheaf(folder, quiet).err.empty());
}

TEST_CASE("cli/render: --timings prints the table on stdout, with and without a picture, before or after INPUT") {
  const TempFolder folder;
  for (const Words& arguments : {Words{"render", "builtin:sphere?n=4", "--timings"},
                                 Words{"render", "--timings", "builtin:sphere?n=4", "-o", "a.png"}}) {
    const RunResult result = runSheaf(folder, arguments);
    CHECK(result.code == 0);
    CHECK(result.err.empty());
    for (const char* word : {"import", "prepare", "cull", "transform", "clip", "setup+bin", "raster", "shade", "encode",
                             "other", "sum", "wall ms", "cpu ms"})
      CHECK_MESSAGE(result.out.find(word) != std::string::npos, word);
  }
  CHECK(folder.has("a.png"));
  CHECK(folder.fileCount() == 1);
}

TEST_CASE("cli/render: --timings=FILE.json is JSON whose parts add up, and stdout stays empty") {
  const TempFolder folder;
  const RunResult result = runSheaf(
      folder, {"render", "builtin:sphere?n=8", "--size", "64x64", "-o", "a.png", "--timings=t.json", "--frames", "3"});
  CHECK(result.code == 0);
  CHECK(result.out.empty());
  const auto json = nlohmann::json::parse(folder.read("t.json"));
  CHECK(json["frames"] == 3);
  double sum = json["other_wall_ms"];
  for (const auto& stage : json["stages"]) {
    sum += stage["wall_ms"]["median"].get<double>();
    CHECK(stage["wall_ms"]["min"].get<double>() <= stage["wall_ms"]["max"].get<double>());
  }
  CHECK(sum == doctest::Approx(json["total_wall_ms"].get<double>()));
  CHECK(json["counters"]["triangles_in"] == 12 * 8 * 8);
  CHECK(json["counters"]["pixels_shaded"].get<int>() + json["counters"]["pixels_background"].get<int>() == 64 * 64);
}

TEST_CASE("cli/render: --trace writes a trace with a track per thread") {
  const TempFolder folder;
  REQUIRE(runSheaf(folder, {"render", "builtin:sphere?n=8", "--size", "256x256", "-o", "a.png", "--threads", "2",
                            "--trace", "t.json"})
              .code == 0);
  const auto json = nlohmann::json::parse(folder.read("t.json"));
  std::set<std::string> tracks;
  std::set<std::string> spans;
  for (const auto& event : json["traceEvents"]) {
    if (event["name"] == "thread_name") tracks.insert(event["args"]["name"].get<std::string>());
    if (event["ph"] == "X") spans.insert(event["name"].get<std::string>());
  }
  CHECK(tracks == std::set<std::string>{"main", "worker 0", "worker 1"});
  for (const char* name : {"import", "prepare", "frame 0", "encode", "raster", "shade"})
    CHECK_MESSAGE(spans.count(name) == 1, name);
}

TEST_CASE("cli/render: a failure while writing leaves the old file whole") {
  if (!std::filesystem::exists("/dev/full")) return;
  const TempFolder folder;
  std::filesystem::create_symlink("/dev/full", folder.file("full.png"));
  const RunResult result = runSheaf(folder, {"render", "builtin:sphere?n=8", "-o", "full.png"});
  CHECK(result.code == 3);
  CHECK(isOneErrorLine(result.err));
  CHECK(folder.fileCount() == 1);
}

#ifdef SHEAF_TEST_MODULE_DIR
TEST_CASE("cli/render: an EXR shows the same picture as the PNG, and takes depth and ids") {
  const TempFolder folder;
  const Image8 png = rendered(folder, "a.png");
  setenv("SHEAF_MODULE_DIR", SHEAF_TEST_MODULE_DIR, 1);  // for this program, which reads the picture
  const Image8 exr = rendered(folder, "a.exr", {"--channels", "depth,ids"});
  CHECK(raster::compareImages(png, exr).max_error <= 1);
  const std::string bytes = folder.read("a.exr");
  for (const char* channel : {"instance_id", "triangle_id"}) CHECK(bytes.find(channel) != std::string::npos);
  CHECK(runSheaf(folder, {"compare", "a.png", "a.exr", "--max-error", "1"}).code == 0);
}
#endif

TEST_CASE("cli/render: colours by cluster are those of sheaf cluster, whatever the scene and its instances") {
  const TempFolder folder;
  for (const char* input : {"builtin:sphere?n=16", "builtin:city?blocks=2", "builtin:teapot?n=4"}) {
    CAPTURE(input);
    const auto run = [&](Words words, const std::string& name) {
      words.insert(words.end(), {"-o", name, "--size", "131x97", "--clusters", "40", "--overlay", "boxes"});
      const RunResult result = runSheaf(folder, words);
      CAPTURE(result.err);
      REQUIRE(result.code == 0);
      return folder.read(name);
    };
    const std::string expected = run({"cluster", input, "--hierarchy", "a.sheaf"}, "a.png");
    CHECK(run({"render", input, "--color-by", "cluster"}, "b.png") == expected);
    CHECK(run({"render", input, "--color-by", "cluster", "--from", "a.sheaf"}, "c.png") == expected);
    CHECK(run({"render", input, "--color-by", "cluster", "--threads", "3"}, "d.png") == expected);
  }
}

TEST_CASE("cli/render: colours by patch and by group, and their overlays, are pictures of their own") {
  const TempFolder folder;
  const auto terrain = [&](const std::string& name, Words options) {
    options.insert(options.begin(), {"render", "builtin:terrain?n=65", "--size", "131x97", "--view", "top", "-o", name,
                                     "--grouping", "planar", "--epsilon", "5%"});
    const RunResult result = runSheaf(folder, options);
    CAPTURE(result.err);
    REQUIRE(result.code == 0);
    return raster::readImage(folder.file(name));
  };
  const std::vector<Image8> pictures = {terrain("a.png", {}), terrain("b.png", {"--color-by", "patch"}),
                                        terrain("c.png", {"--color-by", "patch", "--overlay", "boxes"}),
                                        terrain("d.png", {"--color-by", "group"}),
                                        terrain("e.png", {"--color-by", "group", "--overlay", "planes"})};
  for (std::size_t i = 0; i < pictures.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) CHECK(!(pictures[i] == pictures[k]));
  // What is drawn is what is drawn without colours: it covers the same pixels.
  const Image8 plain = terrain("f.png", {"--background", "transparent"});
  const Image8 colored = terrain("g.png", {"--background", "transparent", "--color-by", "group"});
  for (int y = 0; y < plain.height(); ++y)
    for (int x = 0; x < plain.width(); ++x) CHECK(plain.at(x, y).a == colored.at(x, y).a);
}

TEST_CASE("cli/render: colours that cannot be shown are refused: one line, exit code 2, no file") {
  const TempFolder folder;
  const std::vector<std::pair<Words, std::string>> wrong = {
      {{"--color-by", "face"}, "--color-by face: expected one of cluster, group, patch"},
      {{"--color-by", "group"},
       "--color-by group: there are no vertex groups: add --grouping planar, linear or cluster"},
      {{"--color-by", "patch", "--overlay", "planes"}, "--overlay planes: patches have boxes only"},
      {{"--color-by", "group", "--grouping", "planar", "--overlay", "boxes,planes"}, "vertex groups have planes"},
      {{"--overlay", "boxes"}, "--overlay is drawn over parts of a surface: say with --color-by which"},
      {{"--clusters", "9"}, "--clusters is about face clusters: add --color-by cluster"},
      {{"--color-by", "patch", "--tolerance", "1%"}, "--tolerance is about face clusters"},
      {{"--color-by", "cluster", "--clusters", "9", "--max-faces", "9"}, "each choose a cut"},
  };
  for (const auto& [options, reason] : wrong) {
    CAPTURE(reason);
    Words words = {"render", "builtin:sphere?n=8", "-o", "a.png"};
    words.insert(words.end(), options.begin(), options.end());
    const RunResult result = runSheaf(folder, words);
    CAPTURE(result.err);
    CHECK(result.code == 2);
    CHECK(isOneErrorLine(result.err));
    CHECK(result.err.find(reason) != std::string::npos);
    CHECK(folder.fileCount() == 0);
  }
}

TEST_CASE("cli/render: a coloured EXR shows what the PNG shows") {
  setenv("SHEAF_MODULE_DIR", SHEAF_TEST_MODULE_DIR, 1);  // for this program, which reads the picture
  const TempFolder folder;
  const Words words = {"render", "builtin:sphere?n=8", "--size", "64x48", "--color-by", "patch", "-o",
                       "a.exr",  "--channels",         "ids"};
  const RunResult result = runSheaf(folder, words);
  if (result.code == 4) return;  // without the module
  REQUIRE(result.code == 0);
  const Image8 read = raster::readImage(folder.file("a.exr"));
  const RunResult png =
      runSheaf(folder, {"render", "builtin:sphere?n=8", "--size", "64x48", "--color-by", "patch", "-o", "a.png"});
  REQUIRE(png.code == 0);
  CHECK(raster::compareImages(read, raster::readImage(folder.file("a.png"))).max_error <= 2);
}

TEST_CASE("cli/render: linear grouping shows how far it is, on a terminal only, as compare and bench do") {
  const TempFolder folder;
  for (Words arguments : {Words{"render", "builtin:terrain?n=90", "--size", "64x64", "-o", "x.png"},
                          Words{"compare", "builtin:sphere?n=20", "--size", "64x64"},
                          Words{"bench", "builtin:sphere?n=20", "--size", "64x64", "--frames", "1"}}) {
    CAPTURE(arguments.front());
    arguments.insert(arguments.end(), {"--grouping", "linear"});
    CHECK(runSheaf(folder, arguments).err.find("grouping ") == std::string::npos);
    RunSettings settings;
    settings.err_is_terminal = true;
    const std::string shown = runSheaf(folder, arguments, settings).err;
    CHECK(shown.starts_with("\rgrouping "));
    CHECK(shown.find(" %") != std::string::npos);
    arguments.emplace_back("-q");
    CHECK(runSheaf(folder, arguments, settings).err.empty());
  }
}

}  // namespace sheaf::cli
