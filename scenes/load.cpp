// scenes/load: which importer reads a file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <string_view>
#include <utility>

#include "core/file.h"
#include "scenes/builtin.h"
#include "scenes/import.h"
#include "scenes/text_scanner.h"

namespace sheaf::scenes {
namespace fs = std::filesystem;
namespace {

enum class Format { kUnknown, kGltf, kObj, kPly, kStl, kOff };

Format formatOfExtension(const fs::path& path) {
  fs::path name = path.filename();
  if (equalNoCase(name.extension().string(), ".gz")) name = name.stem();
  const std::string extension = name.extension().string();
  const auto is = [&](std::string_view known) { return equalNoCase(extension, known); };
  if (is(".gltf") || is(".glb")) return Format::kGltf;
  if (is(".obj")) return Format::kObj;
  if (is(".ply")) return Format::kPly;
  if (is(".stl")) return Format::kStl;
  if (is(".off")) return Format::kOff;
  return Format::kUnknown;
}

// For files whose name says nothing.
Format formatOfContent(std::string_view bytes) {
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  const std::string_view text = first == std::string_view::npos ? std::string_view() : bytes.substr(first);
  if (bytes.starts_with("glTF") || text.starts_with("{")) return Format::kGltf;
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r")) return Format::kPly;
  if (equalNoCase(text.substr(0, 6), "solid ") || equalNoCase(text.substr(0, 6), "solid\n")) return Format::kStl;
  const std::string_view word = text.substr(0, std::min(text.find_first_of(" \t\r\n"), std::size_t{8}));
  if (word.ends_with("OFF")) return Format::kOff;
  for (const std::string_view keyword : {"v ", "o ", "g ", "mtllib "})
    if (text.starts_with(keyword)) return Format::kObj;
  return Format::kUnknown;
}

Scene import(ImportSource source, const ImportOptions& options) {
  Format format = formatOfExtension(source.path);
  if (format == Format::kUnknown) format = formatOfContent(source.bytes);
  switch (format) {
    case Format::kGltf:
      return importGltf(std::move(source));
    case Format::kObj:
      return importObj(std::move(source), options);
    case Format::kPly:
      return importPly(std::move(source), options);
    case Format::kStl:
      return importStl(std::move(source), options);
    case Format::kOff:
      return importOff(std::move(source), options);
    case Format::kUnknown:
      break;
  }
  refuseUnsupported(source.name, "is of no known format (known are glTF, GLB, OBJ, PLY, STL and OFF)");
}

// What shading may rely on: a mesh that is drawn with a texture has texture coordinates (one texel if the file has
// none), and texture coordinates and colours are finite.
void completeAttributes(Scene& scene) {
  for (mesh::Mesh& mesh : scene.meshes) {
    for (Vec2& uv : mesh.texcoords)
      if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) uv = Vec2(0.0F);
    for (Vec4& color : mesh.colors)
      if (!isFinite(Vec3(color)) || !std::isfinite(color.a)) color = Vec4(1.0F);
  }
  for (const Instance& instance : scene.instances) {
    mesh::Mesh& mesh = scene.meshes[instance.mesh];
    if (scene.materials[instance.material].base_color_texture.texture >= 0 && mesh.texcoords.empty())
      mesh.texcoords.resize(mesh.vertexCount(), Vec2(0.0F));
  }
}

// +Z up to +Y up: (x, y, z) becomes (x, z, -y).
void turnZUp(Scene& scene) {
  const DMat4 turn(DVec4(1, 0, 0, 0), DVec4(0, 0, -1, 0), DVec4(0, 1, 0, 0), DVec4(0, 0, 0, 1));
  const DMat3 turn3(turn);
  for (Instance& instance : scene.instances) instance.world_from_object = turn * instance.world_from_object;
  for (Camera& camera : scene.cameras) {
    camera.eye = turn3 * camera.eye;
    camera.target = turn3 * camera.target;
    camera.up = turn3 * camera.up;
  }
  for (Light& light : scene.lights)
    light.direction_to_light_world = Vec3(turn3 * DVec3(light.direction_to_light_world));
}

}  // namespace

Scene loadScene(const std::string& input, const ImportOptions& options) {
  constexpr std::string_view kBuiltin = "builtin:";
  if (input.starts_with(kBuiltin)) return buildBuiltin(input.substr(kBuiltin.size()));
  const fs::path path(input);
  try {
    ImportSource source{path, path.string(), readFile(path)};
    if (source.bytes.empty()) refuse(source.name, "file is empty");
    Scene scene = import(std::move(source), options);
    completeAttributes(scene);
    scene.name = path.filename().string();
    if (options.z_up) turnZUp(scene);
    return scene;
  } catch (const std::bad_alloc&) {
    refuse(input, "does not fit into memory");
  }
}

}  // namespace sheaf::scenes
