// Damaged files: each must load or be refused by an Error of one line. What else goes wrong is for the sanitizers.
#include <random>

#include "import_helpers.h"

namespace sheaf::scenes {
namespace {

struct Sample {
  const char* name;
  std::string bytes;
};

std::vector<Sample> samples() {
  std::vector<Sample> out;
  out.push_back({"a.obj",
                 "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 \\\n0.5\nvt 0 0\nvn 0 0 1\nusemtl m\n"
                 "f 1/1/1 2/1/1 3/1/1 4/1/1\nf -1//-1 -2//-1 -3//-1\ns 1\n"});
  out.push_back({"ascii.ply",
                 "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                 "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
                 "property list uchar int vertex_indices\nelement tristrips 1\nproperty list int int vertex_indices\n"
                 "end_header\n0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n0 1 0 1 2 3\n4 0 1 2 3\n5 0 1 2 -1 3\n"});
  for (const bool big : {false, true}) {
    ByteWriter ply(big);
    ply.text(std::string("ply\nformat binary_") + (big ? "big" : "little") +
             "_endian 1.0\nelement vertex 3\nproperty float x\nproperty double y\nproperty short z\nelement face 1\n"
             "property list uchar uint vertex_indices\nend_header\n");
    for (int i = 0; i < 3; ++i) ply.f32(static_cast<float>(i)).u32(0).u32(0).u16(static_cast<std::uint32_t>(i * i));
    ply.u8(3).u32(0).u32(1).u32(2);
    out.push_back({big ? "big.ply" : "little.ply", ply.bytes()});
  }
  out.push_back({"ascii.stl",
                 "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e0 0\nendloop\n"
                 "endfacet\nendsolid x\n"});
  ByteWriter stl;
  stl.text(std::string(80, 's')).u32(1).vec({0, 0, 1}).vec({0, 0, 0}).vec({1, 0, 0}).vec({0, 1, 0}).u16(0);
  out.push_back({"binary.stl", stl.bytes()});
  out.push_back(
      {"a.off",
       "COFF\n4 2 0\n0 0 0 255 0 0 255\n1 0 0 0 0 0\n1 1 0 0 0 0\n0 1 0 0 0 0\n4 0 1 2 3\n3 0 1 2 0.5 0.5 1\n"});
  ByteWriter bin;
  bin.vec({0, 0, 0}).vec({1, 0, 0}).vec({0, 1, 0}).u16(0).u16(1).u16(2).u16(0);
  const std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"scale":[1,2,-1]}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],)"
      R"("materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1],"baseColorTexture":{"index":0}}}],)"
      R"("textures":[{"source":0,"sampler":0}],"samplers":[{"wrapS":33071}],"images":[{"bufferView":2}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":3,"sparse":{"count":1,)"
      R"("indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":0}}},)"
      R"({"bufferView":1,"componentType":5123,"type":"SCALAR","count":3}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6},)";
  const std::string png = tinyPng();
  const std::string rest = R"({"buffer":0,"byteOffset":44,"byteLength":)" + std::to_string(png.size()) +
                           R"(}],"buffers":[{"byteLength":)" + std::to_string(44 + png.size());
  out.push_back({"a.glb", glb(json + rest + "}]}", bin.bytes() + png)});
  out.push_back({"a.gltf", json + rest + R"(,"uri":"data:application/octet-stream;base64,)" +
                               base64(bin.bytes() + png) + "\"}]}"});
  return out;
}

// True if it loaded. An Error must be one line; anything else ends the test.
bool loadsOrIsRefused(const std::string& path, std::string_view bytes) {
  writeFile(path, bytes);
  try {
    const Scene scene = loadScene(path);
    CHECK(scene.triangleCount() > 0);
    for (const Instance& i : scene.instances) {
      REQUIRE(i.mesh < scene.meshes.size());
      REQUIRE(i.material < scene.materials.size());
    }
    for (const mesh::Mesh& m : scene.meshes)
      for (const mesh::Triangle& t : m.triangles)
        for (const std::uint32_t v : t) {
          REQUIRE(v < m.vertexCount());
          REQUIRE(isFinite(m.positions[v]));
        }
    return true;
  } catch (const Error& e) {
    CHECK(std::string_view(e.what()).find('\n') == std::string_view::npos);
    CHECK((e.code() == ErrorCode::kBadInput || e.code() == ErrorCode::kUnsupported));
    return false;
  }
}

}  // namespace

TEST_CASE("scenes/hostile_file: the samples themselves load") {
  const TestFolder folder;
  for (const Sample& s : samples()) {
    CAPTURE(s.name);
    const Scene scene = loadScene(folder.write(s.name, s.bytes));
    CHECK(scene.triangleCount() > 0);
  }
}

TEST_CASE("scenes/hostile_file: truncation at every byte") {
  const TestFolder folder;
  for (const Sample& s : samples()) {
    CAPTURE(s.name);
    const std::string path = (folder.path() / s.name).string();
    for (std::size_t size = 0; size < s.bytes.size(); ++size)
      loadsOrIsRefused(path, std::string_view(s.bytes).substr(0, size));
  }
}

TEST_CASE("scenes/hostile_file: single bytes changed at random") {
  const TestFolder folder;
  std::mt19937 random(20240607);
  for (const Sample& s : samples()) {
    CAPTURE(s.name);
    const std::string path = (folder.path() / s.name).string();
    int loaded = 0;
    for (int round = 0; round < 600; ++round) {
      std::string bytes = s.bytes;
      const std::size_t at = random() % bytes.size();
      // Digits become other digits half of the time: that gets past the parsers.
      const auto c = static_cast<unsigned char>(bytes[at]);
      const auto any = static_cast<unsigned char>(random() & 0xFF);
      const bool digit = c >= '0' && c <= '9' && (round & 1) != 0;
      bytes[at] = static_cast<char>(digit ? '0' + any % 10 : any);
      loaded += loadsOrIsRefused(path, bytes) ? 1 : 0;
    }
    CHECK(loaded > 0);
    CHECK(loaded < 600);
  }
}

}  // namespace sheaf::scenes
