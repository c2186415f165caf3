#include "scenes/ply_writer.h"

#include "import_helpers.h"
#include "scenes/import.h"

namespace sheaf::scenes {
namespace {

mesh::Mesh twoTriangles() {
  mesh::Mesh m;
  m.positions = {{0, 0, 0}, {1.1F, 0, 0}, {1, 1, 1e-20F}, {0, -3e20F, 0.1F}};
  m.normals = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {0.6F, 0.8F, 0}};
  m.texcoords = {{0, 0}, {0.25F, 0.75F}, {-2, 3}, {1, 1}};
  m.colors = {{0, 0, 0, 0}, {1, 1, 1, 1}, {0, 0, 0, 0}, {2, -1, 0, 1}};
  for (int i = 0; i < 3; ++i) m.colors[2][i] = linearFromSrgb8(static_cast<std::uint8_t>(1 + 100 * i));
  m.colors[2].a = 200.0F / 255.0F;
  m.triangles = {{0, 1, 2}, {2, 3, 0}};
  return m;
}

mesh::Mesh readBack(const mesh::Mesh& m) {
  const TestFolder folder;
  const std::string path = (folder.path() / "a.ply").string();
  writePly(path, m);
  return loadScene(path).meshes.at(0);
}

}  // namespace

TEST_CASE("scenes/ply_writer: what is written is read again, colours as bytes") {
  const mesh::Mesh m = twoTriangles();
  const mesh::Mesh read = readBack(m);
  CHECK(read.positions == m.positions);
  CHECK(read.normals == m.normals);
  CHECK(read.texcoords == m.texcoords);
  CHECK(read.triangles == m.triangles);
  CHECK(read.colors[0] == m.colors[0]);
  CHECK(read.colors[1] == m.colors[1]);
  CHECK(read.colors[2] == m.colors[2]);
  CHECK(read.colors[3] == Vec4(1, 0, 0, 1));  // clamped
}

TEST_CASE("scenes/ply_writer: attributes that the mesh has not are not in the file") {
  mesh::Mesh m = twoTriangles();
  m.normals.clear();
  m.texcoords.clear();
  m.colors.clear();
  const std::string bytes = encodePly(m);
  const std::string header = bytes.substr(0, bytes.find("end_header\n") + 11);
  for (const char* absent : {"nx", " s\n", "red"}) CHECK(header.find(absent) == std::string::npos);
  CHECK(bytes.size() == header.size() + 4 * 12 + 2 * 13);
  CHECK(readBack(m).texcoords.empty());
  CHECK(readBack(m).positions == m.positions);
}

TEST_CASE("scenes/ply_writer: a mesh without anything is a valid file") {
  CHECK(encodePly({}).ends_with("element face 0\nproperty list uchar int vertex_indices\nend_header\n"));
  CHECK(refusal("a.ply", encodePly({})) == "a.ply: has no triangles");
}

TEST_CASE("scenes/ply_writer: a folder that is not there is named, and nothing is left") {
  const TestFolder folder;
  const std::string path = (folder.path() / "none" / "a.ply").string();
  CHECK_THROWS_WITH_AS(writePly(path, twoTriangles()), doctest::Contains(path.c_str()), Error);
}

}  // namespace sheaf::scenes
