#include <zlib.h>

#include "import_helpers.h"

namespace sheaf::scenes {
namespace {

const std::string kObj = "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n";

std::string gzipped(const std::string& bytes) {
  const TestFolder folder;
  const std::string path = (folder.path() / "x.gz").string();
  gzFile file = gzopen(path.c_str(), "wb");
  gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size()));
  gzclose(file);
  return readFile(path, false);
}

}  // namespace

TEST_CASE("scenes/load: extensions in any case, and .gz") {
  CHECK(loadText("a.OBJ", kObj).triangleCount() == 1);
  CHECK(loadText("a.obj.gz", gzipped(kObj)).triangleCount() == 1);
  CHECK(loadText("a.Obj.GZ", gzipped(kObj)).name == "a.Obj.GZ");
}

TEST_CASE("scenes/load: without a known extension the content decides") {
  CHECK(loadText("data", kObj).triangleCount() == 1);
  CHECK(loadText("data.txt", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").triangleCount() == 1);
  CHECK(refusal("data", "ply\nformat ascii 1.0\nend_header\n") == "data: has no triangles");
  CHECK(refusal("data", "{}") == "data: is not a glTF file: it has no asset.version");
  CHECK(refusal("data", "solid x\nendsolid x\n") == "data: has no triangles");
  CHECK(refusal("data", "hello", ErrorCode::kUnsupported).find("is of no known format") != std::string::npos);
}

TEST_CASE("scenes/load: empty files, folders and missing files") {
  for (const char* name : {"a.obj", "a.ply", "a.stl", "a.off", "a.gltf", "a.glb", "a"})
    CHECK(refusal(name, "") == std::string(name) + ": file is empty");
  const TestFolder folder;
  CHECK_THROWS_AS(loadScene(folder.path().string()), Error);
  CHECK_THROWS_AS(loadScene((folder.path() / "missing.obj").string()), Error);
}

TEST_CASE("scenes/load: z_up turns +Z to +Y and keeps the handedness") {
  ImportOptions options;
  options.z_up = true;
  const Scene scene = loadText("a.obj", kObj, options);
  const DMat4& m = scene.instances.at(0).world_from_object;
  CHECK(m * DVec4(0, 0, 1, 1) == DVec4(0, 1, 0, 1));
  CHECK(m * DVec4(0, 1, 0, 1) == DVec4(0, 0, -1, 1));
  CHECK(glm::determinant(m) == doctest::Approx(1.0));
}

TEST_CASE("scenes/load: texture coordinates that are not finite become 0") {
  const mesh::Mesh m =
      loadText("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt nan 0\nvt 0.5 inf\nf 1/1 2/2 3/2\n").meshes.at(0);
  CHECK(m.texcoords == std::vector<Vec2>(3, Vec2(0)));
}

TEST_CASE("scenes/load: the crease angle decides which edges stay sharp") {
  const std::string bent = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 -1\nf 1 2 3\nf 2 1 4\n";
  ImportOptions sharp;
  sharp.crease_angle_rad = radians(30.0);
  CHECK(loadText("a.obj", bent).vertexCount() == 4);
  CHECK(loadText("a.obj", bent, sharp).vertexCount() == 6);
}

TEST_CASE("scenes/load: what is not to be drawn gets no normals and may be points alone") {
  ImportOptions plain;
  plain.for_drawing = false;
  const std::string bent = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 -1\nf 1 2 3\nf 2 1 4\n";
  const mesh::Mesh obj = loadText("a.obj", bent, plain).meshes.at(0);
  CHECK(obj.vertexCount() == 4);
  CHECK(obj.normals.empty());
  // Normals for some corners only do not count.
  CHECK(loadText("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3\n", plain).meshes.at(0).normals.empty());
  const mesh::Mesh off = loadText("a.off", "OFF\n2 0 0\n0 0 0\n1 2 3\n", plain).meshes.at(0);
  CHECK(off.positions == std::vector<Vec3>{{0, 0, 0}, {1, 2, 3}});
  const std::string points =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 "
      "3\n";
  CHECK(loadText("a.ply", points, plain).meshes.at(0).vertexCount() == 1);
  CHECK(loadText("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", plain).meshes.at(0).normals.empty());
}

}  // namespace sheaf::scenes
