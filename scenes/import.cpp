#include "scenes/import.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "mesh/normals.h"
#include "mesh/weld.h"

namespace sheaf::scenes {

std::string printable(std::string_view text) {
  constexpr std::size_t kLongest = 200;
  std::string out(text.substr(0, kLongest));
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  if (text.size() > kLongest) out += "...";
  return out;
}

void refuse(std::string_view name, std::string_view reason) {
  throw Error(ErrorCode::kBadInput, fmt::format("{}: {}", name, printable(reason)));
}

void refuseUnsupported(std::string_view name, std::string_view reason) {
  throw Error(ErrorCode::kUnsupported, fmt::format("{}: {}", name, printable(reason)));
}

void dropBadTriangles(mesh::Mesh& mesh, std::string_view place, Scene& scene) {
  if (const std::size_t dropped = mesh::dropUnusableTriangles(mesh); dropped > 0)
    scene.warnings.push_back(
        fmt::format("{}: {} triangles left out: a position is infinite or not a number", place, dropped));
}

bool normalizeNormals(mesh::Mesh& mesh) {
  const auto usable = [](const Vec3& n) { return isFinite(n) && glm::dot(DVec3(n), DVec3(n)) > 1e-60; };
  for (const mesh::Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t)
      if (!usable(mesh.normals[v])) return false;
  for (Vec3& n : mesh.normals) n = usable(n) ? Vec3(glm::normalize(DVec3(n))) : Vec3(0.0F, 1.0F, 0.0F);
  return true;
}

Material plainMaterial(bool has_vertex_colors) {
  Material material;
  material.double_sided = true;
  if (has_vertex_colors) material.base_color = Vec4(1.0F);
  return material;
}

Scene sceneOfOneMesh(mesh::Mesh mesh, Material material, std::string_view name, const ImportOptions& options,
                     std::vector<std::string> warnings) {
  Scene scene;
  scene.warnings = std::move(warnings);
  const bool points_alone = mesh.triangles.empty() && !mesh.positions.empty() && !options.for_drawing;
  if (mesh.triangles.empty() && !points_alone) refuse(name, "has no triangles");
  dropBadTriangles(mesh, name, scene);
  if (mesh.triangles.empty() && !points_alone)
    refuse(name, "has no triangles: each has a position that is infinite or not a number");
  if (!mesh.normals.empty() && !normalizeNormals(mesh)) {
    scene.warnings.push_back(fmt::format("{}: some normals have no direction; {}", name,
                                         options.for_drawing ? "normals are made anew" : "they are left out"));
    mesh.normals = {};
  }
  if (mesh.normals.empty() && options.for_drawing) mesh::makeSmoothNormals(mesh, options.crease_angle_rad);
  scene.meshes.push_back(std::move(mesh));
  scene.materials.push_back(std::move(material));
  scene.instances.emplace_back();
  return scene;
}

float linearFromSrgb(float coded) {
  const double c = coded;
  return static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
}

float linearFromSrgb8(std::uint8_t coded) {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = linearFromSrgb(static_cast<float>(i) / 255.0F);
    return t;
  }();
  return table[coded];
}

}  // namespace sheaf::scenes
