#include <meshoptimizer.h>

#include <nlohmann/json.hpp>

#include "import_helpers.h"

namespace sheaf::scenes {
namespace {

using nlohmann::json;

/// Collects a glTF document: buffer 0 and the views and accessors in it.
struct Builder {
  json root = {{"asset", {{"version", "2.0"}}}, {"scene", 0},
               {"scenes", {{{"nodes", {0}}}}},  {"nodes", json::array({{{"mesh", 0}}})},
               {"meshes", json::array()},       {"accessors", json::array()},
               {"bufferViews", json::array()}};
  std::string bin;

  int view(const std::string& bytes, int stride = 0) {
    while (bin.size() % 4 != 0) bin += '\0';
    json v = {{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", bytes.size()}};
    if (stride > 0) v["byteStride"] = stride;
    bin += bytes;
    root["bufferViews"].push_back(v);
    return static_cast<int>(root["bufferViews"].size()) - 1;
  }
  int accessor(int buffer_view, int component_type, const char* type, std::size_t count, json more = json::object()) {
    json a = {{"componentType", component_type}, {"type", type}, {"count", count}};
    if (buffer_view >= 0) a["bufferView"] = buffer_view;
    a.update(more);
    root["accessors"].push_back(a);
    return static_cast<int>(root["accessors"].size()) - 1;
  }
  int vec3s(const std::vector<Vec3>& points) {
    ByteWriter out;
    for (const Vec3& p : points) out.vec(p);
    return accessor(view(out.bytes()), 5126, "VEC3", points.size());
  }
  int indices(const std::vector<std::uint32_t>& values, int component_type = 5123) {
    ByteWriter out;
    for (const std::uint32_t v : values)
      component_type == 5121 ? out.u8(v) : component_type == 5123 ? out.u16(v) : out.u32(v);
    return accessor(view(out.bytes()), component_type, "SCALAR", values.size());
  }
  json& primitive(json p) {
    root["meshes"].push_back({{"primitives", json::array({std::move(p)})}});
    return root["meshes"].back()["primitives"][0];
  }
  std::string asGlb() {
    root["buffers"] = {{{"byteLength", bin.size()}}};
    return glb(root.dump(), bin);
  }
  std::string asGltf(const std::string& uri) {
    root["buffers"] = {{{"byteLength", bin.size()}, {"uri", uri}}};
    return root.dump();
  }
};

const std::vector<Vec3> kSquare = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};

Builder square() {
  Builder b;
  const int positions = b.vec3s(kSquare);
  b.primitive({{"attributes", {{"POSITION", positions}}}, {"indices", b.indices({0, 1, 2, 1, 3, 2})}});
  return b;
}

Scene load(Builder& b) {
  return loadText("a.glb", b.asGlb());
}

}  // namespace

TEST_CASE("scenes/gltf: a mesh without normals is drawn flat") {
  Builder b = square();
  const Scene scene = load(b);
  CHECK(scene.meshes.at(0).positions == kSquare);
  CHECK(scene.meshes[0].triangles == std::vector<mesh::Triangle>{{0, 1, 2}, {1, 3, 2}});
  CHECK(scene.materials.at(0).shading == Shading::kFlat);
  CHECK(scene.materials[0].base_color == Vec4(1));
  CHECK_FALSE(scene.materials[0].double_sided);
}

TEST_CASE("scenes/gltf: all index widths, and none") {
  for (const int type : {5121, 5123, 5125}) {
    Builder b;
    const int positions = b.vec3s(kSquare);
    b.primitive({{"attributes", {{"POSITION", positions}}}, {"indices", b.indices({0, 1, 2, 1, 3, 2}, type)}});
    CHECK(load(b).meshes.at(0).triangles == std::vector<mesh::Triangle>{{0, 1, 2}, {1, 3, 2}});
  }
  Builder b;
  b.primitive({{"attributes", {{"POSITION", b.vec3s({kSquare[0], kSquare[1], kSquare[2]})}}}});
  CHECK(load(b).meshes.at(0).triangles == std::vector<mesh::Triangle>{{0, 1, 2}});
}

TEST_CASE("scenes/gltf: strips and fans keep their winding; points and lines are left out") {
  Builder b = square();
  json& primitive = b.root["meshes"][0]["primitives"][0];
  primitive["indices"] = b.indices({0, 1, 2, 3, 3, 1});
  primitive["mode"] = 5;
  CHECK(load(b).meshes.at(0).triangles == std::vector<mesh::Triangle>{{0, 1, 2}, {1, 3, 2}});
  primitive["indices"] = b.indices({0, 1, 3, 2});
  primitive["mode"] = 6;
  CHECK(load(b).meshes.at(0).triangles == std::vector<mesh::Triangle>{{1, 3, 0}, {3, 2, 0}});
  primitive["mode"] = 1;
  CHECK(refusal("a.glb", b.asGlb()) == "a.glb: has no triangles, only points or lines");
  json points = primitive;
  points["mode"] = 0;
  primitive["mode"] = 4;
  primitive["indices"] = b.indices({0, 1, 2});
  b.root["meshes"][0]["primitives"].push_back(points);
  CHECK(anyContains(load(b).warnings, "1 primitives of points or lines left out"));
}

TEST_CASE("scenes/gltf: nodes: matrix, translation, rotation and scale, nested") {
  Builder b = square();
  b.root["nodes"] =
      json::array({{{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 20, 30, 1}}, {"children", {1, 2}}},
                   {{"mesh", 0},
                    {"translation", {1, 0, 0}},
                    {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}},
                    {"scale", {2, 3, 4}}},
                   {{"mesh", 0}, {"scale", {-1, 1, 1}}}});
  const Scene scene = load(b);
  REQUIRE(scene.meshes.size() == 1);
  REQUIRE(scene.instances.size() == 2);
  // Scaled to (2, 0, 0), turned by 90 degrees about z to (0, 2, 0), then moved.
  const DVec4 p = scene.instances[0].world_from_object * DVec4(1, 0, 0, 1);
  CHECK(p.x == doctest::Approx(11));
  CHECK(p.y == doctest::Approx(22));
  CHECK(p.z == doctest::Approx(30));
  CHECK(glm::determinant(scene.instances[0].world_from_object) == doctest::Approx(24));
  CHECK(glm::determinant(scene.instances[1].world_from_object) == doctest::Approx(-1));
}

TEST_CASE("scenes/gltf: only the default scene is read") {
  Builder b = square();
  b.root["nodes"].push_back({{"mesh", 0}});
  b.root["scenes"].push_back({{"nodes", {0, 1}}});
  CHECK(load(b).instances.size() == 1);
  b.root["scene"] = 1;
  CHECK(load(b).instances.size() == 2);
  b.root.erase("scene");
  b.root.erase("scenes");
  CHECK(load(b).instances.size() == 2);
}

TEST_CASE("scenes/gltf: byteStride, byteOffset and interleaved attributes") {
  Builder b;
  ByteWriter out;
  out.u32(0xDEADBEEF);
  for (const Vec3& p : kSquare) out.vec(p).vec({0, 0, 1}).u32(0);
  const int view = b.view(out.bytes(), 28);
  const int positions = b.accessor(view, 5126, "VEC3", 4, {{"byteOffset", 4}});
  const int normals = b.accessor(view, 5126, "VEC3", 4, {{"byteOffset", 16}});
  b.primitive({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}, {"mode", 5}});
  const Scene scene = load(b);
  CHECK(scene.meshes.at(0).positions == kSquare);
  CHECK(scene.meshes[0].normals == std::vector<Vec3>(4, Vec3(0, 0, 1)));
  CHECK(scene.materials.at(0).shading == Shading::kSmooth);
}

TEST_CASE("scenes/gltf: sparse accessors, with and without a base") {
  for (const bool with_base : {true, false}) {
    Builder b;
    ByteWriter where, what;
    where.u8(1).u8(3);
    what.vec({5, 0, 0}).vec({0, 7, 0});
    const json sparse = {{"sparse",
                          {{"count", 2},
                           {"indices", {{"bufferView", b.view(where.bytes())}, {"componentType", 5121}}},
                           {"values", {{"bufferView", b.view(what.bytes())}}}}}};
    ByteWriter base;
    for (const Vec3& p : kSquare) base.vec(p);
    const int positions = b.accessor(with_base ? b.view(base.bytes()) : -1, 5126, "VEC3", 4, sparse);
    b.primitive({{"attributes", {{"POSITION", positions}}}, {"indices", b.indices({0, 1, 3})}});
    const mesh::Mesh m = load(b).meshes.at(0);
    CHECK(m.positions[1] == Vec3(5, 0, 0));
    CHECK(m.positions[3] == Vec3(0, 7, 0));
    CHECK(m.positions[2] == (with_base ? kSquare[2] : Vec3(0)));
  }
}

TEST_CASE("scenes/gltf: quantized positions, normalised texture coordinates and colours") {
  Builder b;
  b.root["extensionsRequired"] = {"KHR_mesh_quantization"};
  ByteWriter positions, texcoords, colors;
  for (const int x : {0, 100, -100, 0}) positions.u16(static_cast<std::uint32_t>(x)).u16(7).u16(x == 0 ? 1 : 0).u16(0);
  for (int i = 0; i < 4; ++i) texcoords.u16(65535).u16(0);
  for (int i = 0; i < 4; ++i) colors.u8(255).u8(0).u8(51).u8(0);
  const int p = b.accessor(b.view(positions.bytes(), 8), 5122, "VEC3", 4);
  const int t = b.accessor(b.view(texcoords.bytes()), 5123, "VEC2", 4, {{"normalized", true}});
  const int c = b.accessor(b.view(colors.bytes(), 4), 5121, "VEC3", 4, {{"normalized", true}});
  b.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"texCoord", 1}}}}}}};
  b.root["textures"] = {{{"source", 0}}};
  b.root["images"] = {{{"uri", "data:image/png;base64," + base64(tinyPng())}}};
  b.primitive({{"attributes", {{"POSITION", p}, {"TEXCOORD_1", t}, {"COLOR_0", c}}}, {"mode", 5}, {"material", 0}});
  const Scene scene = load(b);
  const mesh::Mesh& m = scene.meshes.at(0);
  CHECK(m.positions[1] == Vec3(100, 7, 0));
  CHECK(m.positions[2] == Vec3(-100, 7, 0));
  CHECK(m.texcoords.at(0) == Vec2(1, 0));
  CHECK(m.colors.at(0) == Vec4(1, 0, 0.2F, 1));
  CHECK(scene.textures.at(0).pixels.at(0, 0) == Rgba8{255, 0, 0, 255});
}

TEST_CASE("scenes/gltf: buffers in data: URIs, files and percent-encoded files") {
  Builder b = square();
  const TestFolder folder;
  CHECK(loadText("a.gltf", b.asGltf("data:application/octet-stream;base64," + base64(b.bin))).triangleCount() == 2);
  folder.write("sub/my data.bin", b.bin + "more");
  CHECK(loadScene(folder.write("a.gltf", b.asGltf("sub/my%20data.bin"))).triangleCount() == 2);
}

TEST_CASE("scenes/gltf: nothing outside the folder is read") {
  Builder b = square();
  const TestFolder folder;
  folder.write("outside.bin", b.bin);
  folder.write("in/inside.bin", b.bin);
  std::filesystem::create_symlink("../outside.bin", folder.path() / "in/link.bin");
  for (const std::string& uri :
       {std::string("../outside.bin"), std::string("x/../../outside.bin"), std::string("%2e%2e/outside.bin"),
        std::string("..\\outside.bin"), std::string("link.bin"), (folder.path() / "in/inside.bin").string(),
        "file://" + (folder.path() / "in/inside.bin").string(), std::string("http://localhost/a.bin"), std::string("."),
        std::string("")}) {
    CAPTURE(uri);
    CHECK_THROWS_AS(loadScene(folder.write("in/a.gltf", b.asGltf(uri))), Error);
  }
  CHECK(loadScene(folder.write("in/a.gltf", b.asGltf("./inside.bin"))).triangleCount() == 2);
}

TEST_CASE("scenes/gltf: materials: factors, double-sided, unlit, sampler and texture transform") {
  Builder b = square();
  b.root["meshes"][0]["primitives"][0]["material"] = 0;
  b.root["materials"] = {
      {{"name", "m"},
       {"doubleSided", true},
       {"alphaMode", "BLEND"},
       {"extensions", {{"KHR_materials_unlit", json::object()}}},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {0.5, 0.25, 1, 1}},
         {"baseColorTexture",
          {{"index", 0},
           {"extensions",
            {{"KHR_texture_transform", {{"offset", {0.5, 0.25}}, {"rotation", kPi / 2}, {"scale", {2, 3}}}}}}}}}}}};
  b.root["textures"] = {{{"source", 0}, {"sampler", 0}}};
  b.root["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
  const std::string png = tinyPng();
  b.root["images"] = {{{"bufferView", b.view(png)}, {"mimeType", "image/png"}}};
  const Scene scene = load(b);
  const Material& m = scene.materials.at(0);
  CHECK(m.base_color == Vec4(0.5F, 0.25F, 1, 1));
  CHECK(m.double_sided);
  CHECK(m.shading == Shading::kUnlit);
  CHECK(m.base_color_texture.wrap_u == Wrap::kClamp);
  CHECK(m.base_color_texture.wrap_v == Wrap::kMirror);
  CHECK(m.base_color_texture.filter == Filter::kNearest);
  const Vec2 uv = m.base_color_texture.offset + m.base_color_texture.linear * Vec2(1, 0);
  CHECK(uv.x == doctest::Approx(0.5));
  CHECK(uv.y == doctest::Approx(0.25 - 2.0));
  CHECK(scene.meshes.at(0).texcoords.size() == 4);
  CHECK(anyContains(scene.warnings, "drawn opaque (alphaMode BLEND)"));
}

TEST_CASE("scenes/gltf: smoother is shinier, and a texture that cannot be read is a warning") {
  Builder b = square();
  b.root["materials"] = {{{"pbrMetallicRoughness", {{"roughnessFactor", 0.2}, {"baseColorTexture", {{"index", 0}}}}}},
                         {{"pbrMetallicRoughness", {{"roughnessFactor", 0.8}}}}};
  b.root["textures"] = {{{"source", 0}}};
  b.root["images"] = {{{"uri", "../no.png"}}};
  json second = b.root["meshes"][0]["primitives"][0];
  b.root["meshes"][0]["primitives"][0]["material"] = 0;
  second["material"] = 1;
  b.root["meshes"][0]["primitives"].push_back(second);
  const Scene scene = load(b);
  REQUIRE(scene.materials.size() == 2);
  CHECK(scene.materials[0].shininess > scene.materials[1].shininess);
  CHECK(scene.materials[0].base_color_texture.texture == -1);
  CHECK(anyContains(scene.warnings, "texture not used: ../no.png: lies outside the folder"));
}

TEST_CASE("scenes/gltf: cameras and directional lights stand where their nodes are") {
  Builder b = square();
  b.root["extensionsUsed"] = {"KHR_lights_punctual"};
  b.root["extensions"] = {
      {"KHR_lights_punctual", {{"lights", {{{"type", "directional"}, {"intensity", kPi}, {"color", {1, 0.5, 0}}}}}}}};
  b.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
  b.root["nodes"][0]["children"] = {1, 2};
  b.root["nodes"].push_back({{"camera", 0}, {"translation", {1, 2, 3}}});
  b.root["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}},
                             {"rotation", {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}});
  const Scene scene = load(b);
  REQUIRE(scene.cameras.size() == 1);
  CHECK(scene.cameras[0].eye == DVec3(1, 2, 3));
  CHECK(scene.cameras[0].target == DVec3(1, 2, 2));
  CHECK(scene.cameras[0].vertical_fov_rad == 0.5);
  REQUIRE(scene.lights.size() == 1);
  CHECK(scene.lights[0].direction_to_light_world.y == doctest::Approx(1));
  CHECK(scene.lights[0].radiance.r == doctest::Approx(1));
  CHECK(scene.lights[0].radiance.g == doctest::Approx(0.5));
}

TEST_CASE("scenes/gltf: EXT_meshopt_compression is unpacked") {
  Builder b;
  b.root["extensionsRequired"] = {"EXT_meshopt_compression"};
  const std::vector<unsigned> indices = {0, 1, 2, 1, 3, 2};
  std::string vertex_bytes(meshopt_encodeVertexBufferBound(4, 12), '\0');
  vertex_bytes.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(vertex_bytes.data()),
                                                 vertex_bytes.size(), kSquare.data(), 4, 12));
  std::string index_bytes(meshopt_encodeIndexBufferBound(6, 4), '\0');
  index_bytes.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(index_bytes.data()), index_bytes.size(),
                                               indices.data(), 6));
  const auto pack = [&](const std::string& bytes, std::size_t count, int stride, const char* mode) {
    const int view = b.view(bytes);
    json& v = b.root["bufferViews"][static_cast<std::size_t>(view)];
    v["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                  {"byteOffset", v["byteOffset"]},
                                                  {"byteLength", bytes.size()},
                                                  {"byteStride", stride},
                                                  {"count", count},
                                                  {"mode", mode}};
    v["buffer"] = 1;  // the fallback, which has no bytes
    v["byteOffset"] = 0;
    v["byteLength"] = count * static_cast<std::size_t>(stride);
    return view;
  };
  const int positions = b.accessor(pack(vertex_bytes, 4, 12, "ATTRIBUTES"), 5126, "VEC3", 4);
  const int index = b.accessor(pack(index_bytes, 6, 2, "TRIANGLES"), 5123, "SCALAR", 6);
  b.primitive({{"attributes", {{"POSITION", positions}}}, {"indices", index}});
  const Scene scene = load(b);
  CHECK(scene.meshes.at(0).positions == kSquare);
  CHECK(scene.triangleCount() == 2);
  b.root["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["count"] = 1000000000;
  CHECK(refusal("a.glb", b.asGlb()).find("1000000000 elements cannot be in") != std::string::npos);
}

TEST_CASE("scenes/gltf: primitives that share vertices keep those that they use") {
  Builder b;
  std::vector<Vec3> many(100, Vec3(9));
  many[40] = {0, 0, 0};
  many[41] = {1, 0, 0};
  many[42] = {0, 1, 0};
  b.primitive({{"attributes", {{"POSITION", b.vec3s(many)}}}, {"indices", b.indices({42, 40, 41})}});
  const mesh::Mesh m = load(b).meshes.at(0);
  CHECK(m.positions == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  CHECK(m.triangles == std::vector<mesh::Triangle>{{2, 0, 1}});
}

TEST_CASE("scenes/gltf: unsupported files are refused by name") {
  Builder b = square();
  b.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  CHECK(refusal("a.glb", b.asGlb(), ErrorCode::kUnsupported) ==
        "a.glb: requires the extension KHR_draco_mesh_compression, which is not supported");
  b = square();
  b.root["asset"]["version"] = "1.0";
  CHECK(refusal("a.glb", b.asGlb(), ErrorCode::kUnsupported) == "a.glb: glTF version 1.0 is not supported");
  b = square();
  b.root["extensionsUsed"] = {"VENDOR_unknown"};
  b.root["skins"] = {{{"joints", {0}}}};
  CHECK(anyContains(load(b).warnings, "skins are not applied"));
}

TEST_CASE("scenes/gltf: refusals name the place and the reason") {
  const auto refused = [](auto change) {
    Builder b = square();
    change(b.root);
    return refusal("a.glb", b.asGlb());
  };
  CHECK(refused([](json& r) { r["accessors"][0]["count"] = 3; }) ==
        "a.glb: mesh 0 primitive 0: index 4 is 3, the mesh has 3 vertices");
  CHECK(refused([](json& r) { r["accessors"][0]["count"] = 4000000000; }).find("reach past the 48 bytes") !=
        std::string::npos);
  CHECK(refused([](json& r) { r["accessors"][0]["bufferView"] = 7; }) ==
        "a.glb: buffer view 7 does not exist, there are 2");
  CHECK(refused([](json& r) {
          r["accessors"][0].erase("bufferView"), r["accessors"][0]["count"] = 4000000000;
        }).find("without a buffer view are too many") != std::string::npos);
  CHECK(refused([](json& r) { r["bufferViews"][0]["byteLength"] = 100000; }).find("reaches past the") !=
        std::string::npos);
  CHECK(refused([](json& r) { r["bufferViews"][0]["buffer"] = 3; }) == "a.glb: buffer 3 does not exist, there are 1");
  CHECK(refused([](json& r) { r["nodes"][0]["mesh"] = 5; }) == "a.glb: mesh 5 does not exist, there are 1");
  CHECK(refused([](json& r) { r["nodes"][0]["children"] = {0}; }) ==
        "a.glb: node 0 has two parents or is its own ancestor");
  CHECK(refused([](json& r) {
          r["nodes"][0]["scale"] = {1e300, 1, 1};
        }) == "a.glb: node 0 has a transform that is not finite");
  CHECK(refused([](json& r) { r["scene"] = 4; }) == "a.glb: scene 4 does not exist, there are 1");
  CHECK(refused([](json& r) { r["meshes"][0]["primitives"][0]["material"] = 4; }) ==
        "a.glb: material 4 does not exist, there are 0");
  CHECK(refused([](json& r) { r["nodes"][0].erase("mesh"); }) == "a.glb: has no triangles");
  CHECK(refusal("a.gltf", "{\"asset\": ").starts_with("a.gltf: JSON: parse error at line 1"));
  CHECK(refusal("a.gltf", "{\"asset\": {\"version\": \"2.0\"}, \"x\": " + std::string(100000, '[')) ==
        "a.gltf: JSON is nested too deeply");
  Builder quoted = square();
  quoted.root["asset"]["generator"] = "a \\\" " + std::string(1000, '[') + "\\";
  CHECK(load(quoted).triangleCount() == 2);
  CHECK(refusal("a.glb", glb("{}", "").substr(0, 15)) == "a.glb: GLB: the file ends within its header");
}

TEST_CASE("scenes/gltf: a chain of nodes as long as one likes") {
  Builder b = square();
  const int length = 100000;
  b.root["nodes"] = json::array();
  for (int i = 0; i < length; ++i) b.root["nodes"].push_back({{"children", {i + 1}}});
  b.root["nodes"].push_back({{"mesh", 0}});
  CHECK(load(b).instances.size() == 1);
}

}  // namespace sheaf::scenes
