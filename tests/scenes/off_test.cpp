#include "import_helpers.h"

namespace sheaf::scenes {

TEST_CASE("scenes/off: triangles, polygons, comments and colours after a face") {
  const Scene scene = loadText("a.off",
                               "OFF # a comment\n# another\n\n5 2 0\n0 0 0\n1 0 0 # end\n1 1 0\n0 1 0\n0 0 1\n"
                               "4 0 1 2 3 255 0 0\n3 0 1 4\n");
  const mesh::Mesh& m = scene.meshes.at(0);
  CHECK(m.triangleCount() == 3);
  CHECK(m.positions[m.triangles.back()[2]] == Vec3(0, 0, 1));
}

TEST_CASE("scenes/off: faces of more than nine corners are kept") {
  std::string text = "OFF\n12 1 0\n";
  for (int i = 0; i < 12; ++i) {
    const double a = 2.0 * kPi * i / 12.0;
    text += std::to_string(std::cos(a)) + " " + std::to_string(std::sin(a)) + " 0\n";
  }
  CHECK(loadText("a.off", text + "12 0 1 2 3 4 5 6 7 8 9 10 11\n").triangleCount() == 10);
}

TEST_CASE("scenes/off: counts may stand on the line of the word OFF") {
  CHECK(loadText("a.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").triangleCount() == 1);
}

TEST_CASE("scenes/off: normals, colours and texture coordinates by the keyword's letters") {
  const mesh::Mesh m = loadText("a.off",
                                "STCNOFF\n3 1 0\n0 0 0 0 0 1 255 128 0 255 0 0\n1 0 0 0 0 1 0 0 0 255 1 0\n0 1 0 0 0 1 "
                                "0 0 0 255 0 1\n3 0 1 2\n")
                           .meshes.at(0);
  CHECK(m.normals.at(0) == Vec3(0, 0, 1));
  CHECK(m.colors.at(0).r == 1.0F);
  CHECK(m.colors[0].g == doctest::Approx(0.2158605));
  CHECK(m.texcoords.at(2) == Vec2(0, 0));
}

TEST_CASE("scenes/off: refusals name the place and the reason") {
  CHECK(refusal("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n") ==
        "a.off:6: face refers to vertex 7 (counted from 0), the mesh has 3");
  CHECK(refusal("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n") ==
        "a.off:6: face refers to vertex -1 (counted from 0), the mesh has 3");
  CHECK(refusal("a.off", "OFF\n3000000000 1 0\n0 0 0\n").find("more than the file can hold") != std::string::npos);
  CHECK(refusal("a.off", "OFF\n1 0 0\n0 0 0\n") == "a.off: has points but no faces");
  CHECK(refusal("a.off", "OFX\n1 0 0\n0 0 0\n") == "a.off:1: is not an OFF file: it does not begin with 'OFF'");
  CHECK(refusal("a.off", "OFF BINARY\n", ErrorCode::kUnsupported) == "a.off: binary OFF is not supported");
  CHECK(refusal("a.off", "4OFF\n1 1 1\n", ErrorCode::kUnsupported).find("4OFF") != std::string::npos);
}

}  // namespace sheaf::scenes
