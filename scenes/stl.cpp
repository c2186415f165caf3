// STL, ascii and binary. Every triangle brings corners of its own, which are joined where they are exactly equal; the
// facets' normals are not used, since many writers leave them 0.
//
// A reader of our own, for the reasons given in ply.cpp; assimp would also hold 175 MB for a million triangles.
#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <utility>

#include "mesh/weld.h"
#include "scenes/import.h"
#include "scenes/text_scanner.h"

namespace sheaf::scenes {
namespace {

constexpr std::size_t kBinaryHeader = 84;  // 80 bytes of text and the count
constexpr std::size_t kBinaryFacet = 50;   // normal, 3 positions, 2 bytes of attributes

std::uint32_t littleEndian32(const char* bytes) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = (value << 8) | static_cast<unsigned char>(bytes[i]);
  return value;
}

float littleEndianFloat(const char* bytes) {
  return std::bit_cast<float>(littleEndian32(bytes));
}

std::uint64_t binarySize(std::string_view bytes) {
  return kBinaryHeader + std::uint64_t{kBinaryFacet} * littleEndian32(bytes.data() + kBinaryHeader - 4);
}

// Binary files may begin with "solid", too: the size decides. Only a file whose size does not fit its count is judged
// by its text.
bool isBinary(std::string_view bytes) {
  if (bytes.size() >= kBinaryHeader && binarySize(bytes) == bytes.size()) return true;
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  const bool says_solid = first != std::string_view::npos && equalNoCase(bytes.substr(first, 5), "solid");
  return !says_solid || bytes.substr(0, 512).find('\0') != std::string_view::npos;
}

void appendTriangle(mesh::Mesh& mesh) {
  const auto last = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.triangles.push_back({last - 3, last - 2, last - 1});
}

mesh::Mesh readBinary(std::string_view bytes, std::string_view name, std::vector<std::string>& warnings) {
  if (bytes.size() < kBinaryHeader)
    refuse(name,
           fmt::format("is neither ascii STL nor as long as the header of a binary one ({} bytes)", bytes.size()));
  const std::uint32_t count = littleEndian32(bytes.data() + kBinaryHeader - 4);
  if (binarySize(bytes) > bytes.size())
    refuse(name, fmt::format("the header promises {} triangles, that is {} bytes, but the file has {}", count,
                             binarySize(bytes), bytes.size()));
  if (count > UINT32_MAX / 3) refuse(name, fmt::format("{} triangles are too many", count));
  if (binarySize(bytes) < bytes.size())
    warnings.push_back(
        fmt::format("{}: {} bytes after the last triangle ignored", name, bytes.size() - binarySize(bytes)));
  mesh::Mesh mesh;
  mesh.positions.reserve(std::size_t{3} * count);
  mesh.triangles.reserve(count);
  for (std::uint32_t f = 0; f < count; ++f) {
    const char* p = bytes.data() + kBinaryHeader + std::size_t{kBinaryFacet} * f + 12;
    for (int corner = 0; corner < 3; ++corner, p += 12)
      mesh.positions.emplace_back(littleEndianFloat(p), littleEndianFloat(p + 4), littleEndianFloat(p + 8));
    appendTriangle(mesh);
  }
  return mesh;
}

mesh::Mesh readAscii(std::string_view bytes, std::string_view name, std::vector<std::string>& warnings) {
  TextScanner scanner(bytes, name, '\0');
  mesh::Mesh mesh;
  int corners_in_loop = -1;  // -1 outside a loop
  bool in_solid = false;
  while (!scanner.atEnd()) {
    const std::string_view keyword = scanner.word("a keyword");
    if (equalNoCase(keyword, "vertex")) {
      if (corners_in_loop < 0) scanner.fail("a vertex outside 'outer loop'");
      if (++corners_in_loop > 3) scanner.fail("a facet with more than 3 vertices");
      const float x = scanner.number("x"), y = scanner.number("y"), z = scanner.number("z");
      mesh.positions.emplace_back(x, y, z);
    } else if (equalNoCase(keyword, "outer")) {
      if (corners_in_loop >= 0) scanner.fail("'outer loop' within a loop");
      corners_in_loop = 0;
      scanner.skipLine();
    } else if (equalNoCase(keyword, "endloop")) {
      if (corners_in_loop != 3) scanner.fail("a facet with fewer than 3 vertices");
      appendTriangle(mesh);
      corners_in_loop = -1;
    } else if (equalNoCase(keyword, "solid") || equalNoCase(keyword, "endsolid")) {
      in_solid = equalNoCase(keyword, "solid");
      scanner.skipLine();
    } else if (equalNoCase(keyword, "facet")) {
      scanner.skipLine();
    } else if (!equalNoCase(keyword, "endfacet")) {
      scanner.fail(fmt::format("unknown word '{}'", printable(keyword)));
    }
    if (mesh.positions.size() > UINT32_MAX - 4) scanner.fail("too many triangles");
  }
  if (corners_in_loop >= 0) scanner.fail("the file ends within a facet");
  if (in_solid) warnings.push_back(fmt::format("{}: no 'endsolid' at the end: it may be truncated", name));
  return mesh;
}

}  // namespace

Scene importStl(ImportSource source, const ImportOptions& options) {
  std::vector<std::string> warnings;
  mesh::Mesh mesh = isBinary(source.bytes) ? readBinary(source.bytes, source.name, warnings)
                                           : readAscii(source.bytes, source.name, warnings);
  source.bytes = {};
  mesh::weldVertices(mesh);
  return sceneOfOneMesh(std::move(mesh), plainMaterial(false), source.name, options, std::move(warnings));
}

}  // namespace sheaf::scenes
