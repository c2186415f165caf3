// OFF as Geomview defines it, in ascii: [ST][C][N]OFF, polygons, comments. One vertex or face per line.
//
// A reader of our own: assimp 5.2.5 drops faces of more than nine corners without a word.
#include <fmt/format.h>

#include <array>
#include <utility>

#include "scenes/import.h"
#include "scenes/polygon_builder.h"
#include "scenes/text_scanner.h"

namespace sheaf::scenes {
namespace {

struct Layout {
  bool texcoords = false;
  bool colors = false;
  bool normals = false;
};

Layout parseKeyword(TextScanner& scanner, std::string_view name) {
  const std::string_view keyword = scanner.word("the word OFF");
  if (!keyword.ends_with("OFF")) scanner.fail("is not an OFF file: it does not begin with 'OFF'");
  std::string_view prefix = keyword.substr(0, keyword.size() - 3);
  const auto take = [&](std::string_view letters) {
    if (!prefix.starts_with(letters)) return false;
    prefix.remove_prefix(letters.size());
    return true;
  };
  Layout layout;
  layout.texcoords = take("ST");
  layout.colors = take("C");
  layout.normals = take("N");
  if (!prefix.empty())
    refuseUnsupported(name, fmt::format("OFF with 4 or n components per vertex ('{}') is not supported", keyword));
  if (!scanner.atLineEnd()) {
    // "OFF BINARY", or the counts on the same line.
    TextScanner ahead = scanner;
    if (ahead.word("counts") == "BINARY") refuseUnsupported(name, "binary OFF is not supported");
  }
  return layout;
}

std::size_t parseCount(TextScanner& scanner, std::string_view what) {
  const std::int64_t count = scanner.integer(what);
  // A line of a vertex or face takes at least two bytes.
  if (count < 0 || static_cast<std::uint64_t>(count) > scanner.remaining() / 2 || count >= INT64_C(0xFFFFFFFF))
    scanner.fail(fmt::format("{} is {}, more than the file can hold", what, count));
  return static_cast<std::size_t>(count);
}

// Three or four numbers, bytes or fractions; which of the two shows only when all are read.
Vec4 parseColor(TextScanner& scanner) {
  Vec4 color(1.0F, 1.0F, 1.0F, -1.0F);
  for (int i = 0; i < 3; ++i) color[i] = scanner.number("a colour");
  if (!scanner.atLineEnd()) color.a = scanner.number("a colour");
  return color;
}

// Bytes are sRGB-coded; fractions are taken as linear.
void decodeColors(std::vector<Vec4>& colors) {
  bool bytes = false;
  for (const Vec4& c : colors) bytes = bytes || c.r > 1.0F || c.g > 1.0F || c.b > 1.0F || c.a > 1.0F;
  const auto unit = [](float value) { return value >= 0.0F ? std::min(value, 1.0F) : 0.0F; };
  for (Vec4& c : colors) {
    if (c.a < 0.0F) c.a = bytes ? 255.0F : 1.0F;
    for (int i = 0; i < 3; ++i) c[i] = bytes ? linearFromSrgb(unit(c[i] / 255.0F)) : unit(c[i]);
    c.a = unit(bytes ? c.a / 255.0F : c.a);
  }
}

Vec3 parseVec3(TextScanner& scanner, std::string_view what) {
  const float x = scanner.number(what), y = scanner.number(what), z = scanner.number(what);
  return {x, y, z};
}

mesh::Mesh parse(TextScanner& scanner, std::string_view name, std::vector<std::string>& warnings) {
  const Layout layout = parseKeyword(scanner, name);
  const std::size_t vertex_count = parseCount(scanner, "the number of vertices");
  const std::size_t face_count = parseCount(scanner, "the number of faces");
  scanner.skipLine();
  mesh::Mesh mesh;
  mesh.positions.reserve(vertex_count);
  for (std::size_t v = 0; v < vertex_count; ++v) {
    mesh.positions.push_back(parseVec3(scanner, "a position"));
    if (layout.normals) mesh.normals.push_back(parseVec3(scanner, "a normal"));
    // With texture coordinates the colour has four numbers; without, three or four.
    if (layout.colors) mesh.colors.push_back(parseColor(scanner));
    if (layout.texcoords) {
      const float s = scanner.number("a texture coordinate"), t = scanner.number("a texture coordinate");
      mesh.texcoords.emplace_back(s, 1.0F - t);
    }
    scanner.skipLine();
  }
  decodeColors(mesh.colors);
  PolygonBuilder builder(mesh);
  mesh.triangles.reserve(face_count);
  std::vector<std::int64_t> corners;
  for (std::size_t f = 0; f < face_count; ++f) {
    corners.resize(parseCount(scanner, "the number of corners"));
    for (std::int64_t& corner : corners) corner = scanner.integer("a corner of a face");
    if (const std::size_t bad = builder.firstBadCorner(corners); bad < corners.size())
      scanner.fail(fmt::format("face {}", badIndexText(corners[bad], vertex_count)));
    builder.addFace(corners);
    scanner.skipLine();
  }
  builder.reportTo(warnings, name);
  return mesh;
}

}  // namespace

Scene importOff(ImportSource source, const ImportOptions& options) {
  std::vector<std::string> warnings;
  TextScanner scanner(source.bytes, source.name, '#');
  mesh::Mesh mesh = parse(scanner, source.name, warnings);
  source.bytes = {};
  if (mesh.triangles.empty() && !mesh.positions.empty() && options.for_drawing)
    refuse(source.name, "has points but no faces");
  const bool has_colors = !mesh.colors.empty();
  return sceneOfOneMesh(std::move(mesh), plainMaterial(has_colors), source.name, options, std::move(warnings));
}

}  // namespace sheaf::scenes
