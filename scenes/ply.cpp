// PLY: ascii and binary of both byte orders [Turk94]; elements vertex, face and tristrips; others are skipped.
//
// A reader of our own: a binary file of a million triangles takes assimp 5.2.5 a peak of 65 MB (48 bytes per face)
// before its result is copied into a Mesh of 24 MB; here the peak is 47 MB in all, normals included. Assimp also has
// open memory-safety reports, so that a checking pass as long as a reader would have to come before it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include "scenes/asset_folder.h"
#include "scenes/import.h"
#include "scenes/polygon_builder.h"
#include "scenes/text_scanner.h"

namespace sheaf::scenes {
namespace {

enum class Type : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };
constexpr std::array<std::size_t, 8> kTypeSizes = {1, 1, 2, 2, 4, 4, 4, 8};

std::size_t sizeOf(Type t) {
  return kTypeSizes[static_cast<std::size_t>(t)];
}

struct Property {
  std::string name;
  Type type = Type::kFloat;
  std::optional<Type> count_type;  ///< set for a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding : std::uint8_t { kAscii, kLittleEndian, kBigEndian };

struct Header {
  Encoding encoding = Encoding::kAscii;
  std::vector<Element> elements;
  std::string texture_file;
  std::size_t size = 0;  ///< bytes up to the data
  int line_count = 0;
};

Type parseType(std::string_view word, const TextScanner& scanner) {
  constexpr std::array<std::pair<std::string_view, Type>, 16> kNames = {{{"char", Type::kInt8},
                                                                         {"int8", Type::kInt8},
                                                                         {"uchar", Type::kUint8},
                                                                         {"uint8", Type::kUint8},
                                                                         {"short", Type::kInt16},
                                                                         {"int16", Type::kInt16},
                                                                         {"ushort", Type::kUint16},
                                                                         {"uint16", Type::kUint16},
                                                                         {"int", Type::kInt32},
                                                                         {"int32", Type::kInt32},
                                                                         {"uint", Type::kUint32},
                                                                         {"uint32", Type::kUint32},
                                                                         {"float", Type::kFloat},
                                                                         {"float32", Type::kFloat},
                                                                         {"double", Type::kDouble},
                                                                         {"float64", Type::kDouble}}};
  for (const auto& [name, type] : kNames)
    if (name == word) return type;
  scanner.fail(fmt::format("unknown property type '{}'", printable(word)));
}

Encoding parseFormat(TextScanner& scanner) {
  const std::string_view format = scanner.word("the format");
  scanner.skipLine();
  if (format == "ascii") return Encoding::kAscii;
  if (format == "binary_little_endian") return Encoding::kLittleEndian;
  if (format == "binary_big_endian") return Encoding::kBigEndian;
  scanner.fail(fmt::format("unknown format '{}'", printable(format)));
}

Property parseProperty(TextScanner& scanner) {
  Property property;
  std::string_view type = scanner.word("a property type");
  if (type == "list") {
    property.count_type = parseType(scanner.word("the type of a list's count"), scanner);
    if (*property.count_type >= Type::kFloat) scanner.fail("the count of a list is not a whole number");
    type = scanner.word("the type of a list's values");
  }
  property.type = parseType(type, scanner);
  property.name = scanner.word("a property name");
  return property;
}

void parseHeaderLine(std::string_view keyword, TextScanner& scanner, Header& header, bool& has_format) {
  if (keyword == "format") {
    header.encoding = parseFormat(scanner);
    has_format = true;
    return;
  }
  if (keyword == "comment" || keyword == "obj_info") {
    // MeshLab's way to name a texture.
    constexpr std::string_view kTexture = "TextureFile ";
    const std::string_view text = scanner.restOfLine();
    if (text.starts_with(kTexture)) header.texture_file = text.substr(kTexture.size());
  } else if (keyword == "element") {
    Element element;
    element.name = scanner.word("an element name");
    const std::int64_t count = scanner.integer("the count of an element");
    if (count < 0) scanner.fail(fmt::format("element {} has the count {}", printable(element.name), count));
    element.count = static_cast<std::uint64_t>(count);
    header.elements.push_back(std::move(element));
  } else if (keyword == "property") {
    if (header.elements.empty()) scanner.fail("a property before any element");
    header.elements.back().properties.push_back(parseProperty(scanner));
  } else {
    scanner.fail(fmt::format("unknown word '{}' in the header", printable(keyword)));
  }
  scanner.skipLine();
}

// Where the data begin. A reader of words would also take the first data byte of a binary file for a line end.
std::size_t headerSize(std::string_view bytes, std::size_t end_of_keyword, std::string_view name) {
  const std::size_t line_end = bytes.find_first_of("\r\n", end_of_keyword);
  if (line_end == std::string_view::npos) refuse(name, "the file ends with the header");
  // A lone CR ends header lines only in files that do so from the first line on.
  const bool lone_cr = bytes.size() > 4 && bytes[3] == '\r' && bytes[4] != '\n';
  if (bytes[line_end] == '\n' || lone_cr) return line_end + 1;
  if (line_end + 1 < bytes.size() && bytes[line_end + 1] == '\n') return line_end + 2;
  refuse(name, "the line end after end_header is damaged");
}

Header parseHeader(std::string_view bytes, std::string_view name) {
  if (!bytes.starts_with("ply\n") && !bytes.starts_with("ply\r"))
    refuse(name, "is not a PLY file: it does not begin with 'ply'");
  TextScanner scanner(bytes, name, '\0');
  scanner.skipLine();
  Header header;
  bool has_format = false;
  for (;;) {
    const std::string_view keyword = scanner.word("end_header");
    if (keyword == "end_header") break;
    parseHeaderLine(keyword, scanner, header, has_format);
  }
  if (!has_format) scanner.fail("the header has no format");
  header.size = headerSize(bytes, bytes.size() - scanner.remaining(), name);
  header.line_count = scanner.line();
  return header;
}

// The values of an ascii file.
class TextValues {
 public:
  TextValues(std::string_view bytes, std::string_view name, int first_line) : scanner_(bytes, name, '\0', first_line) {}

  float number(Type) { return scanner_.number("a value"); }
  std::int64_t integer(Type type) {
    if (type >= Type::kFloat) fail("an index is not a whole number");
    return scanner_.integer("an index");
  }
  /// Whether `count` values of `size` bytes in a binary file may still follow: here each takes a digit and a separator.
  bool mayFollow(std::uint64_t count, std::size_t) const { return count <= (scanner_.remaining() + 1) / 2; }
  std::size_t rowBytes(const Element& element) const { return element.properties.size(); }
  void skip(Type) { scanner_.word("a value"); }
  [[noreturn]] void fail(std::string_view reason) const { scanner_.fail(reason); }

 private:
  TextScanner scanner_;
};

// The values of a binary file.
class BinaryValues {
 public:
  BinaryValues(std::string_view bytes, std::size_t begin, bool swap, std::string_view name)
      : bytes_(bytes), at_(begin), swap_(swap), name_(name) {}

  float number(Type type) { return read<float>(type); }
  std::int64_t integer(Type type) {
    if (type >= Type::kFloat) fail("an index is not a whole number");
    return read<std::int64_t>(type);
  }
  bool mayFollow(std::uint64_t count, std::size_t size) const { return size == 0 || count <= remaining() / size; }
  /// Least bytes of a row.
  std::size_t rowBytes(const Element& element) const {
    std::size_t sum = 0;
    for (const Property& p : element.properties) sum += sizeOf(p.count_type.value_or(p.type));
    return sum;
  }
  void skip(Type type) {
    need(sizeOf(type));
    at_ += sizeOf(type);
  }
  [[noreturn]] void fail(std::string_view reason) const { refuse(fmt::format("{}:byte {}", name_, at_), reason); }

 private:
  std::size_t remaining() const { return bytes_.size() - at_; }
  void need(std::size_t size) const {
    if (remaining() < size) fail("the file ends within the data");
  }

  template <typename Stored, typename To>
  To readAs() {
    need(sizeof(Stored));
    std::array<char, sizeof(Stored)> raw;
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof(Stored));
    if (swap_) std::reverse(raw.begin(), raw.end());
    at_ += sizeof(Stored);
    return static_cast<To>(std::bit_cast<Stored>(raw));
  }

  template <typename To>
  To read(Type type) {
    switch (type) {
      case Type::kInt8:
        return readAs<std::int8_t, To>();
      case Type::kUint8:
        return readAs<std::uint8_t, To>();
      case Type::kInt16:
        return readAs<std::int16_t, To>();
      case Type::kUint16:
        return readAs<std::uint16_t, To>();
      case Type::kInt32:
        return readAs<std::int32_t, To>();
      case Type::kUint32:
        return readAs<std::uint32_t, To>();
      case Type::kFloat:
        return readAs<float, To>();
      case Type::kDouble:
        break;
    }
    return readAs<double, To>();
  }

  std::string_view bytes_;
  std::size_t at_;
  bool swap_;
  std::string_view name_;
};

// What a vertex property is for: the slot of its value in a row.
enum Slot : std::uint8_t { kX, kY, kZ, kNx, kNy, kNz, kS, kT, kRed, kGreen, kBlue, kAlpha, kSlotCount };

Slot slotOf(const std::string& name) {
  constexpr std::array<std::pair<std::string_view, Slot>, 24> kNames = {
      {{"x", kX},         {"y", kY},         {"z", kZ},     {"nx", kNx},       {"ny", kNy},        {"nz", kNz},
       {"s", kS},         {"t", kT},         {"u", kS},     {"v", kT},         {"texture_u", kS},  {"texture_v", kT},
       {"texture_s", kS}, {"texture_t", kT}, {"red", kRed}, {"green", kGreen}, {"blue", kBlue},    {"alpha", kAlpha},
       {"r", kRed},       {"g", kGreen},     {"b", kBlue},  {"a", kAlpha},     {"texcoord_s", kS}, {"texcoord_t", kT}}};
  for (const auto& [known, slot] : kNames)
    if (known == name) return slot;
  return kSlotCount;
}

// Whole numbers are sRGB-coded bytes or shorts, as every writer has them; floats are taken as linear. Alpha is linear.
float colorValue(float value, Type type, bool is_alpha) {
  switch (type) {
    case Type::kUint8: {
      const auto byte = static_cast<std::uint8_t>(std::clamp(value, 0.0F, 255.0F));
      return is_alpha ? static_cast<float>(byte) / 255.0F : linearFromSrgb8(byte);
    }
    case Type::kUint16: {
      const float unit = std::clamp(value, 0.0F, 65535.0F) / 65535.0F;
      return is_alpha ? unit : linearFromSrgb(unit);
    }
    default:
      return value >= 0.0F && value <= 1.0F ? value : (value > 1.0F ? 1.0F : 0.0F);
  }
}

template <typename Values>
void checkCount(const Element& element, Values& values) {
  if (!values.mayFollow(element.count, values.rowBytes(element)) && values.rowBytes(element) > 0)
    values.fail(fmt::format("the header promises {} of element {}, more than the file can hold", element.count,
                            printable(element.name)));
}

template <typename Values>
std::uint64_t listLength(const Property& property, Values& values) {
  const std::int64_t length = values.integer(*property.count_type);
  if (length < 0 || !values.mayFollow(static_cast<std::uint64_t>(length), sizeOf(property.type)))
    values.fail(fmt::format("a list of {} values is longer than the file", length));
  return static_cast<std::uint64_t>(length);
}

template <typename Values>
void skipProperty(const Property& property, Values& values) {
  const std::uint64_t count = property.count_type ? listLength(property, values) : 1;
  for (std::uint64_t i = 0; i < count; ++i) values.skip(property.type);
}

template <typename Values>
void readVertices(const Element& element, Values& values, mesh::Mesh& mesh) {
  std::vector<Slot> slots;
  std::array<bool, kSlotCount> has{};
  std::array<Type, kSlotCount> types{};
  for (const Property& p : element.properties) {
    const Slot slot = p.count_type ? kSlotCount : slotOf(p.name);
    slots.push_back(slot);
    if (slot == kSlotCount) continue;
    has[slot] = true;
    types[slot] = p.type;
  }
  if (!has[kX] || !has[kY] || !has[kZ]) values.fail("the vertices have no x, y and z");
  const auto count = static_cast<std::size_t>(element.count);
  mesh.positions.resize(count);
  if (has[kNx] && has[kNy] && has[kNz]) mesh.normals.resize(count);
  if (has[kS] && has[kT]) mesh.texcoords.resize(count);
  if (has[kRed] && has[kGreen] && has[kBlue]) mesh.colors.resize(count);
  std::array<float, kSlotCount> row{};
  for (std::size_t v = 0; v < count; ++v) {
    for (std::size_t i = 0; i < slots.size(); ++i) {
      if (slots[i] == kSlotCount)
        skipProperty(element.properties[i], values);
      else
        row[slots[i]] = values.number(element.properties[i].type);
    }
    mesh.positions[v] = {row[kX], row[kY], row[kZ]};
    if (!mesh.normals.empty()) mesh.normals[v] = {row[kNx], row[kNy], row[kNz]};
    // Writers put (0, 0) at the bottom left of the texture.
    if (!mesh.texcoords.empty()) mesh.texcoords[v] = {row[kS], 1.0F - row[kT]};
    if (!mesh.colors.empty())
      mesh.colors[v] = {colorValue(row[kRed], types[kRed], false), colorValue(row[kGreen], types[kGreen], false),
                        colorValue(row[kBlue], types[kBlue], false),
                        has[kAlpha] ? colorValue(row[kAlpha], types[kAlpha], true) : 1.0F};
  }
}

// -1 ends a strip.
void addStrips(std::span<const std::int64_t> indices, PolygonBuilder& builder) {
  while (!indices.empty()) {
    std::size_t length = 0;
    while (length < indices.size() && indices[length] != -1) ++length;
    builder.addStrip(indices.first(length));
    indices = indices.subspan(std::min(length + 1, indices.size()));
  }
}

template <typename Values>
void readFaces(const Element& element, bool strips, Values& values, mesh::Mesh& mesh, PolygonBuilder& builder) {
  if (!strips) mesh.triangles.reserve(mesh.triangles.size() + static_cast<std::size_t>(element.count));
  std::vector<std::int64_t> corners;
  for (std::uint64_t f = 0; f < element.count; ++f)
    for (const Property& p : element.properties) {
      if (!p.count_type || (p.name != "vertex_indices" && p.name != "vertex_index")) {
        skipProperty(p, values);
        continue;
      }
      corners.resize(static_cast<std::size_t>(listLength(p, values)));
      for (std::int64_t& corner : corners) {
        corner = values.integer(p.type);
        const bool strip_end = strips && corner == -1;
        if (!strip_end && (corner < 0 || corner >= static_cast<std::int64_t>(mesh.vertexCount())))
          values.fail(fmt::format("{} {} {}", strips ? "strip" : "face", f, badIndexText(corner, mesh.vertexCount())));
      }
      if (strips)
        addStrips(corners, builder);
      else
        builder.addFace(corners);
    }
}

template <typename Values>
mesh::Mesh readData(const Header& header, Values values, std::string_view name, std::vector<std::string>& warnings) {
  mesh::Mesh mesh;
  PolygonBuilder builder(mesh);
  bool vertices_seen = false;
  for (const Element& element : header.elements) {
    checkCount(element, values);
    const bool faces = element.name == "face";
    const bool strips = element.name == "tristrips";
    if (element.name == "vertex") {
      if (vertices_seen) values.fail("a second element vertex");
      if (element.count >= std::numeric_limits<std::uint32_t>::max()) values.fail("has more than 2^32 - 2 vertices");
      vertices_seen = true;
      readVertices(element, values, mesh);
    } else if (faces || strips) {
      if (!vertices_seen) values.fail("faces before the vertices are not understood");
      readFaces(element, strips, values, mesh, builder);
    } else {
      const std::uint64_t rows = element.properties.empty() ? 0 : element.count;
      for (std::uint64_t row = 0; row < rows; ++row)
        for (const Property& p : element.properties) skipProperty(p, values);
    }
  }
  builder.reportTo(warnings, name);
  return mesh;
}

mesh::Mesh readMesh(const Header& header, std::string_view bytes, std::string_view name,
                    std::vector<std::string>& warnings) {
  if (header.encoding == Encoding::kAscii)
    return readData(header, TextValues(bytes.substr(header.size), name, header.line_count + 1), name, warnings);
  const bool file_is_little = header.encoding == Encoding::kLittleEndian;
  const bool swap = file_is_little != (std::endian::native == std::endian::little);
  return readData(header, BinaryValues(bytes, header.size, swap, name), name, warnings);
}

void addTexture(const Header& header, const ImportSource& source, Scene& scene) {
  if (header.texture_file.empty() || scene.meshes.front().texcoords.empty()) return;
  try {
    Image8 pixels = decodeImage(AssetFolder(source.path).read(header.texture_file), header.texture_file);
    scene.textures.push_back({header.texture_file, std::move(pixels)});
    scene.materials.front().base_color_texture.texture = 0;
    scene.materials.front().base_color = Vec4(1.0F);
  } catch (const Error& e) {
    scene.warnings.push_back(fmt::format("{}: texture not used: {}", source.name, e.what()));
  }
}

}  // namespace

Scene importPly(ImportSource source, const ImportOptions& options) {
  const Header header = parseHeader(source.bytes, source.name);
  std::vector<std::string> warnings;
  mesh::Mesh mesh = readMesh(header, source.bytes, source.name, warnings);
  source.bytes = {};
  if (mesh.triangles.empty() && !mesh.positions.empty() && options.for_drawing)
    refuse(source.name, "has points but no faces");
  const bool has_colors = !mesh.colors.empty();
  Scene scene = sceneOfOneMesh(std::move(mesh), plainMaterial(has_colors), source.name, options, std::move(warnings));
  addTexture(header, source, scene);
  return scene;
}

}  // namespace sheaf::scenes
