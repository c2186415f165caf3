// `sheaf cluster`, run as a whole.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "grouping/clusters_file.h"
#include "mesh/weld.h"
#include "raster/image_io.h"
#include "scenes/scene.h"
#include "tests/cli/run.h"

namespace sheaf::cli {
namespace {

using Json = nlohmann::json;
using Words = std::vector<std::string>;

constexpr const char* kSphere = "builtin:sphere?n=32";

// Two triangles that share an edge, each with vertices of its own there, and one by itself.
constexpr const char* kThreeFaces =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\nv 6 5 5\nv 5 6 5\nf 1 2 3\nf 4 5 6\nf 7 8 9\n";

RunResult cluster(const TempFolder& folder, const std::string& input, Words options) {
  options.insert(options.begin(), {"cluster", input});
  return runSheaf(folder, options);
}

Json clusterJson(const TempFolder& folder, const std::string& input, Words options) {
  options.emplace_back("--json");
  const RunResult result = cluster(folder, input, std::move(options));
  CAPTURE(result.err);
  REQUIRE(result.code == 0);
  return Json::parse(result.out);
}

mesh::Mesh load(const TempFolder& folder, const std::string& name) {
  scenes::ImportOptions as_it_is;
  as_it_is.for_drawing = false;
  return scenes::loadScene(folder.file(name), as_it_is).meshes.at(0);
}

}  // namespace

TEST_CASE("cli/cluster: cuts by number, by tolerance and by size") {
  const TempFolder folder;
  const Json plain = clusterJson(folder, kSphere, {});
  CHECK(plain["clusters"] == 64);
  CHECK(plain["components"] == 1);  // its seam is closed
  CHECK(plain["cut"] == Json({{"clusters", 64}, {"tolerance", nullptr}, {"max_faces", nullptr}}));
  CHECK(plain["weights"]["balance"] == 0.1);
  CHECK(clusterJson(folder, kSphere, {"--clusters", "7"})["clusters"] == 7);
  const Json flat = clusterJson(folder, kSphere, {"--tolerance", "2%"});
  CHECK(flat["planarity_fraction"]["max"] <= 0.02);
  CHECK(flat["planarity_fraction"]["max"] > 0.005);
  CHECK(flat["cut"]["tolerance"] == 0.02);
  const Json small = clusterJson(folder, kSphere, {"--max-faces", "50"});
  CHECK(small["faces_per_cluster"]["max"] <= 50);
  CHECK(small["faces_per_cluster"]["max"] > 25);
  CHECK(small["faces_per_cluster"]["mean"] ==
        doctest::Approx(small["faces"].get<double>() / small["clusters"].get<double>()));
  CHECK(folder.fileCount() == 0);
}

TEST_CASE("cli/cluster: weights decide; three of them leave the fourth alone") {
  const TempFolder folder;
  const Json w = clusterJson(folder, kSphere, {"--weights", "1,2,0.5"})["weights"];
  CHECK(w == Json({{"fit", 1.0}, {"direction", 2.0}, {"shape", 0.5}, {"balance", 0.1}}));
  const auto count = [&](const char* weights) -> int {
    return clusterJson(folder, kSphere, {"--weights", weights, "--max-faces", "64"})["clusters"];
  };
  CHECK(count("0,0,0,1") < count("1,1,1,0"));  // balanced clusters fill the limit
}

TEST_CASE("cli/cluster: the report is a table") {
  const TempFolder folder;
  const RunResult text = cluster(folder, kSphere, {"--clusters", "20"});
  CHECK(text.code == 0);
  CHECK(text.err.empty());
  for (const char* word :
       {"mesh", " faces, 1 component\n", "cut         20 clusters\n", "clusters    20\n", "faces each", "median",
        "cost", "weights 1, 1, 1, 0.1\n", "planarity", "RMS", "of the extent", " ms\n"})
    CHECK_MESSAGE(text.out.find(word) != std::string::npos, word);
}

TEST_CASE("cli/cluster: a PLY has every face once, in a colour per cluster, with vertices of each cluster's own") {
  const TempFolder folder;
  const Json report = clusterJson(folder, kSphere, {"--clusters", "30", "-o", "out.ply"});
  CHECK(folder.fileCount() == 1);
  const mesh::Mesh mesh = load(folder, "out.ply");
  CHECK(mesh.triangleCount() == report["faces"]);
  CHECK(mesh.vertexCount() > report["surface_vertices"]);
  REQUIRE(mesh.colors.size() == mesh.vertexCount());
  std::set<std::array<float, 3>> colors;
  for (const mesh::Triangle& t : mesh.triangles) {
    const Vec4& c = mesh.colors[t[0]];
    CHECK((c == mesh.colors[t[1]] && c == mesh.colors[t[2]]));
    colors.insert({c.r, c.g, c.b});
  }
  CHECK(colors.size() == 8);
  // Where the two faces of an edge have vertices of their own, they differ in colour.
  std::map<std::set<std::array<float, 3>>, std::vector<mesh::Triangle>> faces_of_edge;
  const auto place = [&](std::uint32_t v) {
    return std::array<float, 3>{mesh.positions[v].x, mesh.positions[v].y, mesh.positions[v].z};
  };
  for (const mesh::Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) faces_of_edge[{place(t[k]), place(t[(k + 1) % 3])}].push_back(t);
  std::size_t borders = 0;
  for (const auto& [edge, faces] : faces_of_edge) {
    REQUIRE(faces.size() == 2);
    const auto shared = std::ranges::count_if(
        faces[0], [&](std::uint32_t v) { return std::ranges::find(faces[1], v) != faces[1].end(); });
    if (shared == 2) continue;
    CHECK(mesh.colors[faces[0][0]] != mesh.colors[faces[1][0]]);
    ++borders;
  }
  CHECK(borders > 100);
}

TEST_CASE("cli/cluster: a picture shows the clusters in their colours, and depends on the view") {
  const TempFolder folder;
  const auto draw = [&](const std::string& name, Words options) {
    options.insert(options.end(), {"-o", name, "--size", "160x120"});
    const RunResult result = cluster(folder, kSphere, options);
    CAPTURE(result.err);
    REQUIRE(result.code == 0);
    return raster::readImage(folder.file(name));
  };
  const Image8 picture = draw("a.png", {"--clusters", "12", "--background", "white"});
  CHECK(picture.width() == 160);
  CHECK(picture.height() == 120);
  std::map<int, int> hues;  // in steps of 30 degrees, of what is coloured
  for (const Rgba8& p : picture.pixels()) {
    const int most = std::max({p.r, p.g, p.b}), least = std::min({p.r, p.g, p.b}), range = most - least;
    if (range < 40) continue;
    const double sixth = most == p.r   ? double(p.g - p.b) / range
                         : most == p.g ? 2.0 + double(p.b - p.r) / range
                                       : 4.0 + double(p.r - p.g) / range;
    ++hues[int(2.0 * sixth + 12.0) % 12];
  }
  int seen = 0;
  for (const auto& [hue, count] : hues) seen += count > 100;
  CHECK(seen >= 4);
  CHECK(draw("b.png", {"--clusters", "12", "--background", "white", "--threads", "3"}) == picture);
  CHECK(draw("c.png", {"--clusters", "12", "--background", "white", "--view", "back"}) != picture);
  CHECK(draw("d.png", {"--clusters", "12", "--background", "white", "--weights", "1,1,0"}) != picture);
}

TEST_CASE("cli/cluster: seams do not part neighbours, pieces of their own stay apart") {
  const TempFolder folder;
  folder.write("three.obj", kThreeFaces);
  const Json report = clusterJson(folder, "three.obj", {"--clusters", "1", "-o", "out.ply"});
  CHECK(report["faces"] == 3);
  CHECK(report["surface_vertices"] == 7);
  CHECK(report["components"] == 2);
  CHECK(report["clusters"] == 2);
  CHECK(report["faces_per_cluster"]["min"] == 1);
  CHECK(report["faces_per_cluster"]["max"] == 2);
  CHECK(report["planarity_fraction"]["max"] == doctest::Approx(0.0));
  CHECK(load(folder, "out.ply").vertexCount() == 7);
  CHECK(clusterJson(folder, "three.obj", {"--clusters", "1000"})["max_cost"] == 0.0);
}

TEST_CASE("cli/cluster: the saved hierarchy is the whole one, whatever the cut") {
  const TempFolder folder;
  const Json report = clusterJson(folder, kSphere, {"--clusters", "5", "--hierarchy", "a.sheaf"});
  clusterJson(folder, kSphere, {"--max-faces", "9", "--hierarchy", "b.sheaf"});
  clusterJson(folder, kSphere, {"--weights", "1,1,0", "--hierarchy", "c.sheaf"});
  CHECK(folder.read("a.sheaf") == folder.read("b.sheaf"));
  CHECK(folder.read("a.sheaf") != folder.read("c.sheaf"));
  const mesh::Mesh mesh = mesh::surfaceOf(scenes::loadScene(kSphere).meshes.at(0));
  const grouping::FaceClusters clusters = grouping::loadClusters(folder.file("a.sheaf"), mesh);
  CHECK(clusters.faceCount() == report["faces"]);
  CHECK(clusters.roots.size() == 1);
}

TEST_CASE("cli/cluster: a saved hierarchy gives the same cuts, pictures and PLY files as a new one") {
  const TempFolder folder;
  clusterJson(folder, kSphere, {"--hierarchy", "a.sheaf"});
  for (const Words& cut : {Words{"--clusters", "9"}, Words{"--tolerance", "2%"}, Words{"--max-faces", "30"}}) {
    CAPTURE(cut[0]);
    const auto run = [&](const std::string& name, Words more) {
      more.insert(more.end(), cut.begin(), cut.end());
      more.insert(more.end(), {"-o", name});
      return clusterJson(folder, kSphere, more);
    };
    Json made = run("made.ply", {}), loaded = run("loaded.ply", {"--from", "a.sheaf"});
    CHECK(loaded["from"] == "a.sheaf");
    CHECK(loaded["weights"] == nullptr);
    CHECK(loaded.contains("load_ms"));
    for (const char* differs : {"from", "weights", "load_ms", "cluster_ms"}) made.erase(differs), loaded.erase(differs);
    CHECK(loaded == made);
    CHECK(folder.read("loaded.ply") == folder.read("made.ply"));
    run("made.png", {"--size", "64x48"});
    run("loaded.png", {"--from", "a.sheaf", "--size", "64x48"});
    CHECK(folder.read("loaded.png") == folder.read("made.png"));
  }
  const RunResult text = cluster(folder, kSphere, {"--from", "a.sheaf"});
  CHECK(text.out.find(" ms to load a.sheaf\n") != std::string::npos);
}

TEST_CASE("cli/cluster: a hierarchy fits its mesh however it is drawn: creased, seamed, turned up") {
  const TempFolder folder;
  // A roof of two sides, so that drawing makes normals on either side of the ridge; faces that nothing holds together.
  folder.write("roof.obj", std::string("v 0 0 0\nv 4 0 0\nv 0 2 3\nv 4 2 3\nv 0 0 6\nv 4 0 6\nv 9 9 9\n") +
                               "f 1 2 3\nf 2 4 3\nf 3 4 5\nf 4 6 5\n");
  clusterJson(folder, "roof.obj", {"--hierarchy", "a.sheaf"});
  for (const Words& how :
       {Words{}, Words{"--crease", "1"}, Words{"--up", "z"}, Words{"--up", "z", "--overlay", "boxes"}}) {
    Words options = {"--from", "a.sheaf", "-o", "a.png", "--size", "64x48"};
    options.insert(options.end(), how.begin(), how.end());
    CHECK(cluster(folder, "roof.obj", options).code == 0);
  }
  // Saved beside a picture that is turned up, it is the same file.
  CHECK(cluster(folder, "roof.obj", {"--up", "z", "-o", "b.png", "--hierarchy", "b.sheaf"}).code == 0);
  CHECK(folder.read("a.sheaf") == folder.read("b.sheaf"));
}

TEST_CASE("cli/cluster: a hierarchy that is damaged or of another mesh is refused: one line, exit code 3, no file") {
  const TempFolder folder;
  clusterJson(folder, kSphere, {"--hierarchy", "a.sheaf"});
  const std::string bytes = folder.read("a.sheaf");
  folder.write("cut.sheaf", bytes.substr(0, bytes.size() / 2));
  std::string flipped = bytes;
  flipped[bytes.size() / 3] = static_cast<char>(flipped[bytes.size() / 3] ^ 4);
  folder.write("flipped.sheaf", flipped);
  folder.write("text.sheaf", "hello\n");
  folder.write("three.obj", kThreeFaces);
  std::string moved = kThreeFaces;
  folder.write("moved.obj", moved.replace(moved.find("v 6 5 5"), 7, "v 7 5 5"));
  clusterJson(folder, "three.obj", {"--hierarchy", "three.sheaf"});
  const std::size_t files = folder.fileCount();
  const auto refusedBy = [&](const char* command, const std::string& input, const std::string& file,
                             const std::string& reason) {
    Words words = {command, input, "--from", file, "-o", "a.png", "--size", "64x48"};
    if (std::string(command) == "render") words.insert(words.end(), {"--color-by", "cluster"});
    const RunResult result = runSheaf(folder, words);
    CAPTURE(result.err);
    CHECK(result.code == 3);
    CHECK(result.out.empty());
    CHECK(isOneErrorLine(result.err));
    CHECK(result.err.starts_with("sheaf: " + file + ": "));
    CHECK(result.err.find(reason) != std::string::npos);
    CHECK(folder.fileCount() == files);
  };
  const auto refused = [&](const std::string& input, const std::string& file, const std::string& reason) {
    for (const char* command : {"cluster", "render"}) refusedBy(command, input, file, reason);
  };
  refused(kSphere, "cut.sheaf", "bytes of face clusters in place of");
  refused(kSphere, "flipped.sheaf", "is damaged: checksum");
  refusedBy("cluster", kSphere, "text.sheaf", "text.sheaf: is not a file of face clusters\n");
  // Which of its two kinds of files it is given is for render to find out.
  refusedBy("render", kSphere, "text.sheaf",
            "text.sheaf: is no file that sheaf has saved, neither vertex groups nor face clusters\n");
  refused(kSphere, "none.sheaf", "none.sheaf: cannot be opened: ");
  refused("builtin:sphere?n=20", "a.sheaf", "belongs to another mesh: its clusters are of");
  refused("moved.obj", "three.sheaf", "belongs to another mesh: as many faces, but other corners");
}

TEST_CASE("cli/cluster: overlays of boxes and planes change the picture, and each in its way") {
  const TempFolder folder;
  const auto draw = [&](const std::string& name, Words options) {
    options.insert(options.end(), {"-o", name, "--size", "160x120", "--clusters", "8"});
    const RunResult result = cluster(folder, kSphere, options);
    CAPTURE(result.err);
    REQUIRE(result.code == 0);
    return folder.read(name);
  };
  const std::string plain = draw("a.png", {}), boxes = draw("b.png", {"--overlay", "boxes"}),
                    planes = draw("c.png", {"--overlay", "planes"});
  CHECK(boxes != plain);
  CHECK(planes != plain);
  CHECK(planes != boxes);
  CHECK(draw("d.png", {"--overlay", "boxes,planes"}) == draw("e.png", {"--overlay", "planes,boxes"}));
}

TEST_CASE("cli/cluster: wrong usage is refused with the reason: one line, exit code 2, no file") {
  const TempFolder folder;
  const std::vector<std::pair<Words, std::string>> wrong = {
      {{"--clusters", "5", "--tolerance", "1%"}, "--clusters and --tolerance each choose a cut"},
      {{"--max-faces", "5", "--tolerance", "1%"}, "--tolerance and --max-faces each choose a cut"},
      {{"--clusters", "0"}, "--clusters 0: expected a whole number"},
      {{"--max-faces", "few"}, "--max-faces few: expected a whole number"},
      {{"--tolerance", "-1%"}, "--tolerance -1%: expected a percentage"},
      {{"--weights", "1,1"}, "--weights 1,1: expected 3 to 4 numbers"},
      {{"--weights", "1,1,-1"}, "--weights 1,1,-1: expected 3 to 4 numbers"},
      {{"-o", "x.obj"}, "-o x.obj: expected a name that ends in .ply"},
      {{"-o", "-"}, "-o -: expected a name that ends in .ply"},
      {{"--hierarchy", "x.ply"}, "--hierarchy x.ply: expected a name that ends in .sheaf"},
      {{"-o", "x.ply", "--size", "10x10"}, "--size is about the picture"},
      {{"--view", "front"}, "--view is about the picture"},
      {{"-o", "x.ply", "--overlay", "boxes"}, "--overlay is about the picture"},
      {{"-o", "x.png", "--overlay", "lines"}, "--overlay lines: expected boxes, planes or boxes,planes"},
      {{"--from", ""}, "--from: the name of the file is empty"},
      {{"--from", "a.sheaf", "--weights", "1,1,1"}, "--weights decide how clusters are made"},
      {{"--from", "a.sheaf", "--hierarchy", "b.sheaf"}, "--hierarchy would save what --from has loaded"},
      {{"--simd", "SCALAR"}, "--simd is about the picture"},
      {{"--orthographic"}, "--orthographic is about the picture"},
      {{"-o", "x.png", "--view", "front", "--orbit", "1,2"}, "each choose a camera"},
      {{"-o", "x.jpg", "--background", "transparent"}, "JPEG has no alpha channel"},
      {{"-o", "x.png", "--simd", "NONE"}, "--simd NONE"},
      {{"--nonsense"}, "--nonsense"},
  };
  for (const auto& [options, reason] : wrong) {
    CAPTURE(reason);
    const RunResult result = cluster(folder, kSphere, options);
    CAPTURE(result.err);
    CHECK(result.code == 2);
    CHECK(result.out.empty());
    CHECK(isOneErrorLine(result.err));
    CHECK(result.err.find(reason) != std::string::npos);
    CHECK(folder.fileCount() == 0);
  }
}

TEST_CASE("cli/cluster: points, missing files and outputs over the input are refused") {
  const TempFolder folder;
  folder.write("p.ply",
               "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
               "z\nend_header\n0 0 0\n");
  const RunResult points = cluster(folder, "p.ply", {});
  CHECK(points.code == 3);
  CHECK(points.err == "sheaf: p.ply: has no faces to cluster\n");
  CHECK(cluster(folder, "none.ply", {}).code == 3);
  CHECK(cluster(folder, "p.ply", {"-o", "p.ply"}).code == 2);
  CHECK(folder.fileCount() == 1);
}

}  // namespace sheaf::cli
