#include "import_helpers.h"

namespace sheaf::scenes {
namespace {

std::string header(std::string_view format, std::string_view vertex_properties, int vertices, int faces) {
  return "ply\nformat " + std::string(format) + " 1.0\ncomment made by a test\nelement vertex " +
         std::to_string(vertices) + "\nproperty float x\nproperty float y\nproperty float z\n" +
         std::string(vertex_properties) + "element face " + std::to_string(faces) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string binaryQuad(bool big_endian) {
  ByteWriter out(big_endian);
  out.text(header(big_endian ? "binary_big_endian" : "binary_little_endian", "", 4, 1));
  out.vec({0, 0, 0}).vec({1, 0, 0}).vec({1, 1, 0}).vec({0, 1, 0.5F});
  out.u8(4).u32(0).u32(1).u32(2).u32(3);
  return out.bytes();
}

const std::string kAsciiTriangle = header("ascii", "", 3, 1) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

}  // namespace

TEST_CASE("scenes/ply: ascii, with normals made") {
  const Scene scene = loadText("a.ply", kAsciiTriangle);
  REQUIRE(scene.meshes.size() == 1);
  const mesh::Mesh& m = scene.meshes[0];
  CHECK(m.positions == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  CHECK(m.triangles == std::vector<mesh::Triangle>{{0, 1, 2}});
  REQUIRE(m.normals.size() == 3);
  CHECK(m.normals[0] == Vec3(0, 0, 1));
  CHECK(scene.instances.size() == 1);
  CHECK(scene.materials.size() == 1);
}

TEST_CASE("scenes/ply: both byte orders give the same mesh") {
  const mesh::Mesh little = loadText("a.ply", binaryQuad(false)).meshes.at(0);
  const mesh::Mesh big = loadText("a.ply", binaryQuad(true)).meshes.at(0);
  CHECK(little.triangleCount() == 2);
  CHECK(little.positions == big.positions);
  CHECK(little.triangles == big.triangles);
  CHECK(little.positions[3] == Vec3(0, 1, 0.5F));
}

TEST_CASE("scenes/ply: header lines may end in CR LF or CR, and binary data may begin with LF") {
  for (const std::string_view line_end : {"\r\n", "\r"}) {
    std::string text;
    for (const char c : header("binary_little_endian", "", 3, 1))
      if (c == '\n')
        text += line_end;
      else
        text += c;
    ByteWriter out;
    // 0x0A and 0x0D as the first bytes of the data: they belong to x.
    out.text(text).u32(0x0A0D0D0A).f32(0).f32(0).vec({1, 0, 0}).vec({0, 1, 0}).u8(3).u32(0).u32(1).u32(2);
    const Scene scene = loadText("a.ply", out.bytes());
    CHECK(scene.meshes.at(0).positions[0].x == std::bit_cast<float>(0x0A0D0D0AU));
  }
}

TEST_CASE("scenes/ply: normals, texture coordinates and colours per vertex") {
  const std::string text =
      header("ascii",
             "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n"
             "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float quality\n",
             3, 1) +
      "0 0 0 0 0 2 0.25 0.25 255 0 128 9\n1 0 0 0 0 2 0 1 0 0 0 9\n0 1 0 0 0 2 0 0 0 0 0 9\n3 0 1 2\n";
  const mesh::Mesh m = loadText("a.ply", text).meshes.at(0);
  CHECK(m.normals.at(0) == Vec3(0, 0, 1));
  CHECK(m.texcoords.at(0) == Vec2(0.25F, 0.75F));
  CHECK(m.colors.at(0).r == 1.0F);
  CHECK(m.colors[0].g == 0.0F);
  CHECK(m.colors[0].b == doctest::Approx(0.2158605));  // sRGB 128
  CHECK(m.colors[0].a == 1.0F);
}

TEST_CASE("scenes/ply: strips, with -1 between them") {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 1 2\n";
  const mesh::Mesh m = loadText("a.ply", text).meshes.at(0);
  CHECK(m.triangles == std::vector<mesh::Triangle>{{0, 1, 2}, {1, 3, 2}, {0, 1, 2}});
}

TEST_CASE("scenes/ply: other elements and properties are skipped") {
  const std::string text =
      "ply\nformat ascii 1.0\nelement extra 2\nproperty list uchar float values\nproperty int id\n"
      "element vertex 3\nproperty double x\nproperty list uchar int more\nproperty short y\nproperty int z\n"
      "element face 1\nproperty uchar flags\nproperty list uchar uint vertex_index\nend_header\n"
      "2 0.5 0.5 7\n0 8\n0.5 1 4 0 0\n1 0 0 0\n0 2 1 2 1 0\n255 3 0 1 2\n";
  const mesh::Mesh m = loadText("a.ply", text).meshes.at(0);
  CHECK(m.positions == std::vector<Vec3>{{0.5F, 0, 0}, {1, 0, 0}, {0, 1, 0}});
}

TEST_CASE("scenes/ply: a texture named in a comment") {
  const TestFolder folder;
  folder.write("my paint.png", tinyPng());
  std::string text = header("ascii", "property float u\nproperty float v\n", 3, 1);
  text.replace(text.find("made by a test"), 14, "TextureFile my paint.png");
  const Scene scene = loadScene(folder.write("a.ply", text + "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n"));
  CHECK(scene.materials.at(0).base_color_texture.texture == 0);
  CHECK(scene.textures.at(0).pixels.width() == 2);
}

TEST_CASE("scenes/ply: a concave polygon is cut inside its outline") {
  const std::string text = header("ascii", "", 4, 1) + "0 0 0\n4 0 0\n1 1 0\n0 4 0\n4 1 2 3 0\n";
  const mesh::Mesh m = loadText("a.ply", text).meshes.at(0);
  REQUIRE(m.triangleCount() == 2);
  for (const mesh::Triangle& t : m.triangles) {
    const Vec3 cross = glm::cross(m.positions[t[1]] - m.positions[t[0]], m.positions[t[2]] - m.positions[t[0]]);
    CHECK(cross.z > 0.0F);
  }
}

TEST_CASE("scenes/ply: triangles with infinite or NaN corners are left out and counted") {
  const std::string text = header("ascii", "", 4, 3) + "0 0 0\n1 0 0\n0 1 0\nnan 0 inf\n3 0 1 2\n3 0 1 3\n3 3 1 2\n";
  const Scene scene = loadText("a.ply", text);
  CHECK(scene.triangleCount() == 1);
  CHECK(anyContains(scene.warnings, "2 triangles left out"));
  CHECK(refusal("a.ply", header("ascii", "", 3, 1) + "nan 0 0\n1 0 0\n0 1 0\n3 0 1 2\n") ==
        "a.ply: has no triangles: each has a position that is infinite or not a number");
}

TEST_CASE("scenes/ply: refusals name the place and the reason") {
  CHECK(refusal("a.ply", header("ascii", "", 3, 1) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n") ==
        "a.ply:14: face 0 refers to vertex 3 (counted from 0), the mesh has 3");
  CHECK(refusal("a.ply", header("ascii", "", 3, 1) + "0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n") ==
        "a.ply:12: 'x' is not a number (a value is expected)");
  CHECK(refusal("a.ply", header("ascii", "", 2, 0) + "0 0 0\n1 0 0\n") == "a.ply: has points but no faces");
  CHECK(refusal("a.ply", header("ascii", "", 0, 0)) == "a.ply: has no triangles");
  CHECK(refusal("a.ply", "ply\n") == "a.ply:2: the file ends where end_header is expected");
  CHECK(refusal("a.ply", "plywood") == "a.ply: is not a PLY file: it does not begin with 'ply'");
  CHECK(refusal("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n") ==
        "a.ply:4: unknown property type 'quad'");
}

TEST_CASE("scenes/ply: counts beyond the file's size are refused before memory is taken") {
  const std::string promise = header("binary_little_endian", "", 2000000000, 2000000000);
  CHECK(refusal("a.ply", promise + "123456789012").find("more than the file can hold") != std::string::npos);
  ByteWriter list;
  list.text(
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list int int vertex_indices\nend_header\n");
  list.vec({0, 0, 0}).u32(0x7FFFFFFF).u32(0);
  CHECK(refusal("a.ply", list.bytes()).find("longer than the file") != std::string::npos);
}

}  // namespace sheaf::scenes
