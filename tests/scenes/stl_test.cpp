#include "import_helpers.h"

namespace sheaf::scenes {
namespace {

// Two triangles of a square.
std::string binaryStl(std::string header, std::uint32_t count) {
  header.resize(80, ' ');
  ByteWriter out;
  out.text(header).u32(count);
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(1, 1, 0), d(0, 1, 0);
  for (const auto& t : {std::array{a, b, c}, std::array{a, c, d}}) {
    out.vec({0, 0, 0});
    for (const Vec3& p : t) out.vec(p);
    out.u16(0);
  }
  return out.bytes();
}

const std::string kAscii =
    "solid a name\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 0\n"
    "  endloop\n endfacet\nendsolid a name\n";

}  // namespace

TEST_CASE("scenes/stl: equal corners are joined, and normals made") {
  const Scene scene = loadText("a.stl", binaryStl("header", 2));
  const mesh::Mesh& m = scene.meshes.at(0);
  CHECK(m.vertexCount() == 4);
  CHECK(m.triangles == std::vector<mesh::Triangle>{{0, 1, 2}, {0, 2, 3}});
  CHECK(m.normals.at(0) == Vec3(0, 0, 1));
}

TEST_CASE("scenes/stl: a binary file may begin with the word solid") {
  CHECK(loadText("a.stl", binaryStl("solid part", 2)).triangleCount() == 2);
}

TEST_CASE("scenes/stl: ascii, in any case of letters, several solids") {
  std::string upper = kAscii;
  for (char& c : upper) c = static_cast<char>(std::toupper(c));
  CHECK(loadText("a.stl", kAscii).triangleCount() == 1);
  CHECK(loadText("a.stl", upper + kAscii).triangleCount() == 2);
}

TEST_CASE("scenes/stl: bytes after the last triangle are ignored with a warning") {
  const Scene scene = loadText("a.stl", binaryStl("header", 2) + "extra");
  CHECK(scene.triangleCount() == 2);
  CHECK(anyContains(scene.warnings, "5 bytes after the last triangle"));
}

TEST_CASE("scenes/stl: refusals name the place and the reason") {
  CHECK(refusal("a.stl", binaryStl("header", 3)) ==
        "a.stl: the header promises 3 triangles, that is 234 bytes, but the file has 184");
  CHECK(refusal("a.stl", binaryStl("header", 0xFFFFFFFF)).find("the header promises 4294967295") != std::string::npos);
  CHECK(refusal("a.stl", "short") == "a.stl: is neither ascii STL nor as long as the header of a binary one (5 bytes)");
  CHECK(refusal("a.stl", kAscii.substr(0, kAscii.find("endloop"))) == "a.stl:7: the file ends within a facet");
  CHECK(refusal("a.stl", "solid x\nendsolid x\n") == "a.stl: has no triangles");
  CHECK(refusal("a.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nendloop\n") ==
        "a.stl:5: 'endloop' is not a number (z is expected)");
}

}  // namespace sheaf::scenes
