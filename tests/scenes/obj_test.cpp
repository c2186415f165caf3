#include "import_helpers.h"

namespace sheaf::scenes {
namespace {

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

double area(const mesh::Mesh& m) {
  double sum = 0.0;
  for (const mesh::Triangle& t : m.triangles)
    sum += 0.5 * glm::length(glm::cross(m.positions[t[1]] - m.positions[t[0]], m.positions[t[2]] - m.positions[t[0]]));
  return sum;
}

}  // namespace

TEST_CASE("scenes/obj: every form of a corner, and negative indices") {
  const std::string records = kTriangle + "vt 0.25 0.25\nvn 0 0 2\n";
  for (const std::string_view face : {"f 1 2 3", "f 1/1 2/1 3/1", "f 1//1 2//1 3//1", "f 1/1/1 2/1/1 3/1/1",
                                      "f 1// 2// 3//", "f 1/1/ 2/1/ 3/1/", "f -3/-1/-1 -2/-1/-1 -1/-1/-1"}) {
    CAPTURE(face);
    const Scene scene = loadText("a.obj", records + std::string(face) + "\n");
    const mesh::Mesh& m = scene.meshes.at(0);
    CHECK(m.positions == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    CHECK(m.triangles == std::vector<mesh::Triangle>{{0, 1, 2}});
    CHECK(m.normals.at(0) == Vec3(0, 0, 1));
    if (!m.texcoords.empty()) CHECK(m.texcoords[0] == Vec2(0.25F, 0.75F));
  }
}

TEST_CASE("scenes/obj: vertices are joined by their indices") {
  const std::string quad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\n";
  CHECK(loadText("a.obj", quad + "f 1 2 3\nf 1 3 4\n").vertexCount() == 4);
  CHECK(loadText("a.obj", quad + "f 1/1 2/1 3/1\nf 1/2 3/1 4/1\n").vertexCount() == 5);
}

TEST_CASE("scenes/obj: made normals know no texture seams") {
  // A roof whose two sides meet at 90 degrees; the ridge has other texture coordinates on each side.
  const std::string roof =
      "v -1 0 0\nv -1 0 1\nv 0 1 0\nv 0 1 1\nv 1 0 0\nv 1 0 1\nvt 0 0\nvt 1 1\n"
      "f 1/1 2/1 4/1 3/1\nf 3/2 4/2 6/2 5/2\n";
  const TestFolder folder;
  ImportOptions smooth;
  smooth.crease_angle_rad = kPi;
  const mesh::Mesh m = loadScene(folder.write("a.obj", roof), smooth).meshes.at(0);
  int on_ridge = 0;
  for (std::size_t v = 0; v < m.vertexCount(); ++v)
    if (m.positions[v].y == 1.0F) {
      ++on_ridge;
      CHECK(m.normals[v].y == doctest::Approx(1.0));
    }
  CHECK(on_ridge == 4);
  const mesh::Mesh creased = loadText("b.obj", roof).meshes.at(0);
  for (const Vec3& n : creased.normals) CHECK(std::abs(n.x) == doctest::Approx(std::sqrt(0.5)));
}

TEST_CASE("scenes/obj: polygons, concave too") {
  const Scene scene = loadText("a.obj", "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 2 3 4 1\n");
  CHECK(scene.triangleCount() == 2);
  CHECK(area(scene.meshes.at(0)) == doctest::Approx(4.0));
}

TEST_CASE("scenes/obj: a polygon of 300 corners") {
  std::string text, face = "f";
  for (int i = 0; i < 300; ++i) {
    const double a = 2.0 * kPi * i / 300.0;
    text += "v " + std::to_string(std::cos(a)) + " " + std::to_string(std::sin(a)) + " 0\n";
    face += " " + std::to_string(i + 1);
  }
  const Scene scene = loadText("a.obj", text + face + "\n");
  CHECK(scene.triangleCount() == 298);
  CHECK(area(scene.meshes.at(0)) == doctest::Approx(kPi).epsilon(0.001));
}

TEST_CASE("scenes/obj: continuation lines, and the numbers of the lines after them") {
  CHECK(loadText("a.obj", kTriangle + "f 1 \\\n2 \\\r\n 3\n").triangleCount() == 1);
  CHECK(refusal("a.obj", kTriangle + "f 1 \\\n2 \\\n 3\nf 1 2 9\n") ==
        "a.obj:7: face refers to vertex 9, the file has 3 up to here");
}

TEST_CASE("scenes/obj: colours per vertex are sRGB-coded") {
  const mesh::Mesh m = loadText("a.obj", "v 0 0 0 1 0.5 0\nv 1 0 0 0 0 0\nv 0 1 0\nf 1 2 3\n").meshes.at(0);
  REQUIRE(m.colors.size() == 3);
  CHECK(m.colors[0].r == 1.0F);
  CHECK(m.colors[0].g == doctest::Approx(0.2140411));
  CHECK(m.colors[1] == Vec4(0, 0, 0, 1));
  CHECK(m.colors[2] == Vec4(1));
}

TEST_CASE("scenes/obj: materials, one mesh each, with a texture") {
  const TestFolder folder;
  folder.write("a b.mtl",
               "newmtl red\nKd 1 0 0\nKs 0.5 0.25 0\nNs 100\nnewmtl painted\nKd 1 1 1\nmap_Kd maps\\tiny.png\nd 0.5\n");
  folder.write("maps/tiny.png", tinyPng());
  const Scene scene = loadScene(
      folder.write("a.obj", "mtllib a b.mtl\n" + kTriangle +
                                "vt 0 0\nusemtl red\nf 1 2 3\nusemtl painted\nf 1/1 3/1 2/1\nusemtl red\nf 3 2 1\n"));
  REQUIRE(scene.meshes.size() == 2);
  REQUIRE(scene.materials.size() == 2);
  CHECK(scene.meshes[0].triangleCount() == 2);
  CHECK(scene.materials[0].base_color == Vec4(1, 0, 0, 1));
  CHECK(scene.materials[0].specular == 0.5F);
  CHECK(scene.materials[0].shininess == 100.0F);
  CHECK(scene.materials[1].base_color_texture.texture == 0);
  REQUIRE(scene.textures.size() == 1);
  CHECK(scene.textures[0].pixels.width() == 2);
  CHECK(scene.textures[0].pixels.at(1, 0) == Rgba8{0, 255, 0, 255});
  CHECK(anyContains(scene.warnings, "drawn opaque"));
}

TEST_CASE("scenes/obj: missing or forbidden MTL and textures are warnings") {
  const TestFolder folder;
  folder.write("secret.png", tinyPng());
  folder.write("in/a.mtl",
               "newmtl m\nmap_Kd ../secret.png\nnewmtl n\nmap_Kd absent.png\nnewmtl o\nmap_Kd broken.png\n");
  folder.write("in/broken.png", "\x89PNG but no more");
  const Scene scene = loadScene(
      folder.write("in/a.obj", "mtllib a.mtl\nmtllib /etc/passwd\nmtllib gone.mtl\n" + kTriangle +
                                   "usemtl m\nf 1 2 3\nusemtl n\nf 1 2 3\nusemtl o\nf 1 2 3\nusemtl p\nf 1 2 3\n"));
  CHECK(scene.textures.empty());
  CHECK(anyContains(scene.warnings, "../secret.png: lies outside the folder"));
  CHECK(anyContains(scene.warnings, "/etc/passwd: lies outside the folder"));
  CHECK(anyContains(scene.warnings, "absent.png: does not exist"));
  CHECK(anyContains(scene.warnings, "broken.png: image cannot be decoded"));
  CHECK(anyContains(scene.warnings, "gone.mtl: does not exist"));
  CHECK(anyContains(scene.warnings, "material 'p' is not defined"));
}

TEST_CASE("scenes/obj: without an MTL a picture of the same name is the texture") {
  const TestFolder folder;
  folder.write("room.png", tinyPng());
  const Scene scene = loadScene(folder.write("room.obj", kTriangle + "vt 0 0\nf 1/1 2/1 3/1\n"));
  CHECK(scene.materials.at(0).base_color_texture.texture == 0);
  CHECK(anyContains(scene.warnings, "room.png is taken as the texture"));
}

TEST_CASE("scenes/obj: what cannot be drawn is left out and counted") {
  const Scene scene =
      loadText("a.obj", kTriangle + "v nan 0 0\nv 1e999 0 0\nf 1 2\nl 1 2\nf 1 2 4\nf 1 2 5\nf 1 2 3\n");
  CHECK(scene.triangleCount() == 1);
  CHECK(anyContains(scene.warnings, "1 faces with fewer than 3 corners"));
  CHECK(anyContains(scene.warnings, "2 triangles left out"));
  CHECK(anyContains(scene.warnings, "1 lines and points left out"));
}

TEST_CASE("scenes/obj: refusals name the line and the reason") {
  CHECK(refusal("a.obj", kTriangle + "f 1 2 4\n") == "a.obj:4: face refers to vertex 4, the file has 3 up to here");
  CHECK(refusal("a.obj", kTriangle + "f 1 2 0\n") == "a.obj:4: face refers to vertex 0, the file has 3 up to here");
  CHECK(refusal("a.obj", kTriangle + "f 1 2 -4\n") == "a.obj:4: face refers to vertex -4, the file has 3 up to here");
  CHECK(refusal("a.obj", kTriangle + "f 1/1 2/1 3/1\n") ==
        "a.obj:4: face refers to texture coordinate 1, the file has 0 up to here");
  CHECK(refusal("a.obj", "v 0 zero 0\n") == "a.obj:1: 'zero' is not a number (a vertex is expected)");
  CHECK(refusal("a.obj", "v 0 0\n") == "a.obj:1: a vertex has 2 numbers, 3 are needed");
  CHECK(refusal("a.obj", kTriangle) == "a.obj: has points but no faces");
  CHECK(refusal("a.obj", "# nothing\n") == "a.obj: has no triangles");
  CHECK(refusal("a.obj", "v nan nan nan\nf 1 1 1\n") ==
        "a.obj: has no triangles: each has a position that is infinite or not a number");
}

}  // namespace sheaf::scenes
