// `sheaf simplify`, run as a whole.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "scenes/scene.h"
#include "tests/cli/run.h"

namespace sheaf::cli {
namespace {

using Words = std::vector<std::string>;

constexpr const char* kSphere = "builtin:sphere?n=32";

mesh::Mesh simplified(const TempFolder& folder, Words options) {
  options.insert(options.begin(), {"simplify", kSphere, "-o", "out.ply"});
  const RunResult result = runSheaf(folder, options);
  CAPTURE(result.err);
  REQUIRE(result.code == 0);
  scenes::ImportOptions as_it_is;
  as_it_is.for_drawing = false;
  return scenes::loadScene(folder.file("out.ply"), as_it_is).meshes.at(0);
}

}  // namespace

TEST_CASE("cli/simplify: to a number of vertices or of faces, positions alone or with attributes") {
  const TempFolder folder;
  const mesh::Mesh by_vertices = simplified(folder, {"--vertices", "200"});
  CHECK(by_vertices.vertexCount() == 200);
  CHECK(by_vertices.normals.empty());
  CHECK(folder.fileCount() == 1);
  const mesh::Mesh by_faces = simplified(folder, {"--faces", "300"});
  CHECK(by_faces.triangleCount() <= 300);
  CHECK(by_faces.triangleCount() >= 298);
  const mesh::Mesh whole = simplified(folder, {"--faces", "300", "--attributes"});
  CHECK(whole.normals.size() == whole.vertexCount());
}

TEST_CASE("cli/simplify: the report says what was and what is, as text and as JSON") {
  const TempFolder folder;
  const RunResult text = runSheaf(folder, {"simplify", kSphere, "-o", "out.ply", "--vertices", "200"});
  CHECK(text.err.empty());
  for (const char* word : {"mesh", "vertices", " to 200\n", "triangles", "distance", "RMS", "time", " ms\n"})
    CHECK_MESSAGE(text.out.find(word) != std::string::npos, word);
  const auto j = nlohmann::json::parse(
      runSheaf(folder, {"simplify", kSphere, "-o", "out.ply", "--vertices", "200", "--json"}).out);
  CHECK(j["vertices"] == 200);
  CHECK(j["triangles"] == 396);  // closed: 2 V - 4
  CHECK(j["vertices_before"] > 200);
  CHECK(j["target_reached"] == true);
  for (const char* way : {"to_result", "from_result"}) {
    CHECK(j["distance_fraction"][way]["max"] > 0.0);
    CHECK(j["distance_fraction"][way]["rms"] < 0.02);
  }
}

TEST_CASE("cli/simplify: a target that topology does not allow is a warning, not a failure") {
  const TempFolder folder;
  const RunResult result = runSheaf(folder, {"simplify", kSphere, "-o", "out.ply", "--vertices", "2"});
  CHECK(result.code == 0);
  CHECK(result.err.starts_with("warning: "));
  CHECK(result.err.find("the target was not reached") != std::string::npos);
  CHECK(folder.has("out.ply"));
  CHECK(runSheaf(folder, {"simplify", kSphere, "-o", "out.ply", "--vertices", "2", "-q"}).err.empty());
}

TEST_CASE("cli/simplify: wrong usage is refused with the reason: one line, exit code 2, no file") {
  const TempFolder folder;
  const std::vector<std::pair<Words, std::string>> wrong = {
      {{}, "-o FILE.ply is missing"},
      {{"-o", "x.ply"}, "--vertices N or --faces N is missing"},
      {{"-o", "x.ply", "--vertices", "5", "--faces", "5"}, "give one of them"},
      {{"-o", "x.ply", "--vertices", "0"}, "--vertices 0: expected a whole number"},
      {{"-o", "x.ply", "--faces", "many"}, "--faces many: expected a whole number"},
      {{"-o", "x.obj", "--faces", "5"}, ".ply"},
      {{"-o", "x.ply", "--faces", "5", "--nonsense"}, "--nonsense"},
  };
  for (const auto& [options, reason] : wrong) {
    CAPTURE(reason);
    Words arguments = {"simplify", kSphere};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const RunResult result = runSheaf(folder, arguments);
    CHECK(result.code == 2);
    CHECK(result.out.empty());
    CHECK(isOneErrorLine(result.err));
    CHECK(result.err.find(reason) != std::string::npos);
    CHECK(folder.fileCount() == 0);
  }
}

TEST_CASE("cli/simplify: points, missing files and outputs over the input are refused") {
  const TempFolder folder;
  folder.write("p.ply",
               "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
               "z\nend_header\n0 0 0\n");
  const RunResult points = runSheaf(folder, {"simplify", "p.ply", "-o", "x.ply", "--faces", "5"});
  CHECK(points.code == 3);
  CHECK(points.err == "sheaf: p.ply: has no triangles to simplify\n");
  CHECK(runSheaf(folder, {"simplify", "none.ply", "-o", "x.ply", "--faces", "5"}).code == 3);
  CHECK(runSheaf(folder, {"simplify", "p.ply", "-o", "p.ply", "--faces", "5"}).code == 2);
  CHECK(folder.fileCount() == 1);
}

}  // namespace sheaf::cli
