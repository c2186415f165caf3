#include "scenes/ply_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "core/file.h"
#include "scenes/paint.h"

namespace sheaf::scenes {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

std::string headerOf(const mesh::Mesh& mesh) {
  std::string text = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n",
      mesh.vertexCount());
  if (!mesh.normals.empty()) text += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!mesh.texcoords.empty()) text += "property float s\nproperty float t\n";
  if (!mesh.colors.empty())
    text += "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";
  return text +
         fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n", mesh.triangleCount());
}

template <typename Value>
void append(std::string& bytes, const Value& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void appendColor(std::string& bytes, const Vec4& color) {
  for (int i = 0; i < 3; ++i) append(bytes, srgbByte(color[i]));
  append(bytes, static_cast<std::uint8_t>(255.0F * std::clamp(color.a, 0.0F, 1.0F) + 0.5F));
}

}  // namespace

std::string encodePly(const mesh::Mesh& mesh) {
  mesh::assertValid(mesh);
  std::string bytes = headerOf(mesh);
  const std::size_t vertex_size = 12 + (mesh.normals.empty() ? 0 : 12) + (mesh.texcoords.empty() ? 0 : 8) +
                                  (mesh.colors.empty() ? std::size_t{0} : 4);
  bytes.reserve(bytes.size() + vertex_size * mesh.vertexCount() + 13 * mesh.triangleCount());
  for (std::size_t v = 0; v < mesh.vertexCount(); ++v) {
    append(bytes, mesh.positions[v]);
    if (!mesh.normals.empty()) append(bytes, mesh.normals[v]);
    if (!mesh.texcoords.empty()) append(bytes, Vec2(mesh.texcoords[v].x, 1.0F - mesh.texcoords[v].y));
    if (!mesh.colors.empty()) appendColor(bytes, mesh.colors[v]);
  }
  for (const mesh::Triangle& triangle : mesh.triangles) {
    append(bytes, std::uint8_t{3});
    append(bytes, triangle);
  }
  return bytes;
}

void writePly(const std::filesystem::path& path, const mesh::Mesh& mesh) {
  writeFile(path, encodePly(mesh));
}

}  // namespace sheaf::scenes
