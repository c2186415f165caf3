// OBJ, with materials by tinyobjloader.
//
// The geometry is read here, since tinyobjloader 2.0rc10 turns a NaN into 0, refuses corners of the form `1//`, keeps
// the corner count of a face in a byte, knows no continuation lines, and tells neither the line of a bad index nor that
// there is one.
#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <span>
#include <sstream>
#include <unordered_map>
#include <utility>

#include "mesh/normals.h"
#include "mesh/polygon.h"
#include "scenes/asset_folder.h"
#include "scenes/import.h"
#include "scenes/text_scanner.h"

namespace sheaf::scenes {
namespace {

constexpr std::int32_t kNone = -1;

struct Corner {
  std::int32_t position = kNone;
  std::int32_t texcoord = kNone;
  std::int32_t normal = kNone;
  bool operator==(const Corner&) const = default;
};

/// What the file says, with every index made absolute and in range.
struct ObjFile {
  std::vector<Vec3> positions;
  std::vector<Vec4> colors;  ///< #positions, or 0 if the file has none
  std::vector<Vec2> texcoords;
  std::vector<Vec3> normals;
  std::vector<std::array<Corner, 3>> triangles;
  std::vector<std::int32_t> triangle_materials;  ///< #triangles, index into material_names
  std::vector<std::string> material_names;       ///< in order of use; "" = before any usemtl
  std::vector<std::string> libraries;
};

// A backslash at the end of a line continues it. Blanks take its place, and the line ends are made up for after the
// joined line, so that lines keep their numbers.
void joinContinuationLines(std::string& text) {
  if (text.find("\\\n") == std::string::npos && text.find("\\\r") == std::string::npos) return;
  std::string joined;
  joined.reserve(text.size());
  std::size_t owed = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool crlf = text.compare(i + 1, 2, "\r\n") == 0;
    if (text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == '\n' || text[i + 1] == '\r')) {
      joined += ' ';
      i += crlf ? 2 : 1;
      ++owed;
      continue;
    }
    joined += text[i];
    if (text[i] == '\n') {
      joined.append(owed, '\n');
      owed = 0;
    }
  }
  text = std::move(joined);
}

class ObjParser {
 public:
  ObjParser(std::string_view text, std::string_view name) : scanner_(text, name, '#'), name_(name) {}

  ObjFile parse() {
    while (!scanner_.atEnd()) {
      const std::string_view keyword = scanner_.word("a keyword");
      if (keyword == "v")
        parsePosition();
      else if (keyword == "vt")
        parseTexcoord();
      else if (keyword == "vn")
        parseNormal();
      else if (keyword == "f" || keyword == "fo")
        parseFace();
      else if (keyword == "usemtl")
        useMaterial(std::string(scanner_.restOfLine()));
      else if (keyword == "mtllib")
        file_.libraries.emplace_back(scanner_.restOfLine());
      else if (keyword == "l" || keyword == "p")
        ++lines_and_points_;
      scanner_.skipLine();
    }
    if (any_color_)
      file_.colors.resize(file_.positions.size(), Vec4(1.0F));
    else
      file_.colors = {};
    return std::move(file_);
  }

  std::string_view whyEmpty() const {
    if (not_finite_ > 0) return "has no triangles: each has a position that is infinite or not a number";
    return any_position_ ? "has points but no faces" : "has no triangles";
  }

  void reportTo(std::vector<std::string>& warnings) const {
    const auto report = [&](std::size_t count, std::string_view what) {
      if (count > 0) warnings.push_back(fmt::format("{}: {} {}", name_, count, what));
    };
    report(lines_and_points_, "lines and points left out");
    report(too_few_corners_, "faces with fewer than 3 corners left out");
    report(tangled_, "polygons that cross themselves or are flat lines cut as fans");
    report(not_finite_, "triangles left out: a position is infinite or not a number");
  }

 private:
  // The numbers of the line, at most 8; an Error if there are fewer than `least`.
  std::span<const float> numbers(std::size_t least, std::string_view what) {
    std::size_t count = 0;
    while (count < numbers_.size() && !scanner_.atLineEnd()) numbers_[count++] = scanner_.number(what);
    if (count < least) scanner_.fail(fmt::format("{} has {} numbers, {} are needed", what, count, least));
    return std::span(numbers_).first(count);
  }

  void parsePosition() {
    const auto n = numbers(3, "a vertex");
    if (file_.positions.size() == kMostRecords) scanner_.fail("too many vertices");
    file_.positions.emplace_back(n[0], n[1], n[2]);
    any_position_ = true;
    if (n.size() < 6) return;
    // x y z r g b, or x y z w r g b. The writers in use (MeshLab, Blender) write sRGB-coded colours.
    any_color_ = true;
    file_.colors.resize(file_.positions.size(), Vec4(1.0F));
    const auto rgb = n.subspan(n.size() >= 7 ? 4 : 3, 3);
    for (int i = 0; i < 3; ++i) {
      const float coded = rgb[static_cast<std::size_t>(i)];
      file_.colors.back()[i] = linearFromSrgb(coded >= 0.0F ? std::min(coded, 1.0F) : 0.0F);
    }
  }

  void parseTexcoord() {
    const auto n = numbers(1, "a texture coordinate");
    if (file_.texcoords.size() == kMostRecords) scanner_.fail("too many texture coordinates");
    // OBJ puts (0, 0) at the bottom left.
    file_.texcoords.emplace_back(n[0], 1.0F - (n.size() > 1 ? n[1] : 0.0F));
  }

  void parseNormal() {
    const auto n = numbers(3, "a normal");
    if (file_.normals.size() == kMostRecords) scanner_.fail("too many normals");
    file_.normals.emplace_back(n[0], n[1], n[2]);
  }

  // "7", "-1": counted from 1, or back from the last one so far.
  std::int32_t parseIndex(std::string_view text, std::size_t count, std::string_view what) const {
    std::int64_t index = 0;
    if (!parseInteger(text, index)) scanner_.fail(fmt::format("'{}' is not an index of a {}", printable(text), what));
    const auto size = static_cast<std::int64_t>(count);
    const std::int64_t absolute = index < 0 ? size + index : index - 1;
    if (index == 0 || absolute < 0 || absolute >= size)
      scanner_.fail(fmt::format("face refers to {} {}, the file has {} up to here", what, index, count));
    return static_cast<std::int32_t>(absolute);
  }

  // Indices may refer to vertices further down only in files that no writer makes: they are refused.
  Corner parseCorner(std::string_view word) const {
    const std::size_t slash = word.find('/');
    Corner corner;
    corner.position = parseIndex(word.substr(0, slash), file_.positions.size(), "vertex");
    if (slash == std::string_view::npos) return corner;
    const std::string_view rest = word.substr(slash + 1);
    const std::size_t second = rest.find('/');
    const std::string_view texcoord = rest.substr(0, second);
    if (!texcoord.empty()) corner.texcoord = parseIndex(texcoord, file_.texcoords.size(), "texture coordinate");
    if (second == std::string_view::npos) return corner;
    const std::string_view normal = rest.substr(second + 1);
    if (!normal.empty()) corner.normal = parseIndex(normal, file_.normals.size(), "normal");
    return corner;
  }

  void parseFace() {
    corners_.clear();
    while (!scanner_.atLineEnd()) corners_.push_back(parseCorner(scanner_.word("a corner")));
    if (corners_.size() < 3) {
      ++too_few_corners_;
      return;
    }
    corner_triangles_.clear();
    if (corners_.size() == 3) {
      corner_triangles_.push_back({0, 1, 2});
    } else {
      corner_positions_.clear();
      for (const Corner& c : corners_) corner_positions_.push_back(positionOf(c));
      if (!mesh::triangulatePolygon(corner_positions_, corner_triangles_)) ++tangled_;
    }
    for (const mesh::Triangle& t : corner_triangles_) addTriangle({corners_[t[0]], corners_[t[1]], corners_[t[2]]});
  }

  void addTriangle(const std::array<Corner, 3>& triangle) {
    if (!std::all_of(triangle.begin(), triangle.end(), [&](const Corner& c) { return isFinite(positionOf(c)); })) {
      ++not_finite_;
      return;
    }
    if (material_ == kNone) useMaterial("");
    file_.triangles.push_back(triangle);
    file_.triangle_materials.push_back(material_);
  }

  void useMaterial(std::string name) {
    const auto [it, is_new] = material_numbers_.try_emplace(name, static_cast<std::int32_t>(material_numbers_.size()));
    if (is_new) file_.material_names.push_back(std::move(name));
    material_ = it->second;
  }

  const Vec3& positionOf(const Corner& c) const { return file_.positions[static_cast<std::size_t>(c.position)]; }

  static constexpr std::size_t kMostRecords = std::numeric_limits<std::int32_t>::max();

  TextScanner scanner_;
  std::string_view name_;
  ObjFile file_;
  std::array<float, 8> numbers_{};
  std::vector<Corner> corners_;
  std::vector<Vec3> corner_positions_;
  std::vector<mesh::Triangle> corner_triangles_;
  std::unordered_map<std::string, std::int32_t> material_numbers_;
  std::int32_t material_ = kNone;
  bool any_position_ = false;
  bool any_color_ = false;
  std::size_t lines_and_points_ = 0;
  std::size_t too_few_corners_ = 0;
  std::size_t tangled_ = 0;
  std::size_t not_finite_ = 0;
};

// Normals are made on the surface as the positions alone join it, so that neither texture seams nor borders of
// materials show. A vertex at a crease is split; corners then refer to the parts.
void makeNormals(ObjFile& file, double crease_angle_rad) {
  mesh::Mesh surface;
  surface.positions = std::move(file.positions);
  surface.colors = std::move(file.colors);
  surface.triangles.reserve(file.triangles.size());
  for (const auto& t : file.triangles)
    surface.triangles.push_back({static_cast<std::uint32_t>(t[0].position), static_cast<std::uint32_t>(t[1].position),
                                 static_cast<std::uint32_t>(t[2].position)});
  mesh::makeSmoothNormals(surface, crease_angle_rad);
  for (std::size_t f = 0; f < file.triangles.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::int32_t>(surface.triangles[f][k]);
      file.triangles[f][k].position = v;
      file.triangles[f][k].normal = v;
    }
  file.positions = std::move(surface.positions);
  file.colors = std::move(surface.colors);
  file.normals = std::move(surface.normals);
}

void dropNormals(ObjFile& file) {
  file.normals.clear();
  for (auto& t : file.triangles)
    for (Corner& c : t) c.normal = kNone;
}

// Whether each corner has a normal that can be used; makes them unit length.
bool normalizeNormals(ObjFile& file) {
  for (Vec3& n : file.normals) {
    const double length = glm::length(DVec3(n));
    n = isFinite(n) && length > 1e-30 ? Vec3(DVec3(n) / length) : Vec3(0.0F);
  }
  return std::all_of(file.triangles.begin(), file.triangles.end(), [&](const auto& t) {
    return std::all_of(t.begin(), t.end(), [&](const Corner& c) {
      return c.normal != kNone && file.normals[static_cast<std::size_t>(c.normal)] != Vec3(0.0F);
    });
  });
}

// Turns the triples of one material's triangles into vertices. A position's vertices hang in a chain that starts at
// heads_[position]: there are only a few of them.
class VertexJoiner {
 public:
  explicit VertexJoiner(const ObjFile& file) : file_(file), heads_(file.positions.size(), kNone) {}

  mesh::Mesh join(std::span<const std::uint32_t> triangle_numbers) {
    mesh_ = {};
    corners_.clear();
    next_.clear();
    with_texcoords_ = std::any_of(triangle_numbers.begin(), triangle_numbers.end(), [&](std::uint32_t f) {
      const auto& t = file_.triangles[f];
      return std::any_of(t.begin(), t.end(), [](const Corner& c) { return c.texcoord != kNone; });
    });
    mesh_.triangles.reserve(triangle_numbers.size());
    for (const std::uint32_t f : triangle_numbers) {
      const auto& t = file_.triangles[f];
      const std::uint32_t a = vertexOf(t[0]), b = vertexOf(t[1]), c = vertexOf(t[2]);
      mesh_.triangles.push_back({a, b, c});
    }
    for (const Corner& c : corners_) heads_[static_cast<std::size_t>(c.position)] = kNone;
    return std::move(mesh_);
  }

 private:
  std::uint32_t vertexOf(const Corner& corner) {
    std::int32_t& head = heads_[static_cast<std::size_t>(corner.position)];
    for (std::int32_t v = head; v != kNone; v = next_[static_cast<std::size_t>(v)])
      if (corners_[static_cast<std::size_t>(v)] == corner) return static_cast<std::uint32_t>(v);
    const auto vertex = static_cast<std::int32_t>(corners_.size());
    corners_.push_back(corner);
    next_.push_back(head);
    head = vertex;
    append(corner);
    return static_cast<std::uint32_t>(vertex);
  }

  void append(const Corner& corner) {
    const auto p = static_cast<std::size_t>(corner.position);
    mesh_.positions.push_back(file_.positions[p]);
    if (!file_.normals.empty()) mesh_.normals.push_back(file_.normals[static_cast<std::size_t>(corner.normal)]);
    if (!file_.colors.empty()) mesh_.colors.push_back(file_.colors[p]);
    if (with_texcoords_)
      mesh_.texcoords.push_back(corner.texcoord == kNone ? Vec2(0.0F)
                                                         : file_.texcoords[static_cast<std::size_t>(corner.texcoord)]);
  }

  const ObjFile& file_;
  std::vector<std::int32_t> heads_;
  std::vector<std::int32_t> next_;
  std::vector<Corner> corners_;
  mesh::Mesh mesh_;
  bool with_texcoords_ = false;
};

// The materials of the libraries, by name.
class MaterialLibrary {
 public:
  MaterialLibrary(const ImportSource& source, Scene& scene)
      : path_(source.path), folder_(source.path), name_(source.name), scene_(scene) {}

  void read(const std::string& library) {
    try {
      std::istringstream text(folder_.read(library));
      std::string warnings, errors;
      tinyobj::LoadMtl(&numbers_, &materials_, &text, &warnings, &errors);
      if (!errors.empty()) warn(fmt::format("{}: {}", library, printable(errors)));
    } catch (const Error& e) {
      warn(fmt::format("material file not used: {}", e.what()));
    }
  }

  bool empty() const { return materials_.empty(); }

  // Without any MTL, STEM.png, STEM_diffuse.png (or .jpg) beside the file is meant for it.
  void useTextureBesideFile() {
    const std::string stem = path_.stem().extension() == ".obj" ? path_.stem().stem().string() : path_.stem().string();
    for (const std::string_view ending : {".png", ".jpg", "_diffuse.png", "_diffuse.jpg"}) {
      const std::string file_name = stem + std::string(ending);
      std::error_code ec;
      if (!std::filesystem::exists(path_.parent_path() / file_name, ec)) continue;
      const std::int32_t texture = textureOf(file_name);
      if (texture == kNone) return;
      warn(fmt::format("there are no materials: {} is taken as the texture", printable(file_name)));
      for (Instance& instance : scene_.instances) {
        if (scene_.meshes[instance.mesh].texcoords.empty()) continue;
        scene_.materials[instance.material].base_color = Vec4(1.0F);
        scene_.materials[instance.material].base_color_texture.texture = texture;
      }
      return;
    }
  }

  Material make(const std::string& material_name, bool has_vertex_colors) {
    Material material = plainMaterial(has_vertex_colors);
    material.name = material_name;
    const auto it = numbers_.find(material_name);
    if (it == numbers_.end()) {
      if (!material_name.empty()) warn(fmt::format("material '{}' is not defined", printable(material_name)));
      return material;
    }
    const tinyobj::material_t& source = materials_[static_cast<std::size_t>(it->second)];
    const auto unit = [](float value) { return value >= 0.0F ? std::min(value, 1.0F) : 0.0F; };
    // Kd and Ks are taken as linear. The highlight has one strength: that of the strongest channel.
    material.base_color = {unit(source.diffuse[0]), unit(source.diffuse[1]), unit(source.diffuse[2]), 1.0F};
    material.specular = unit(std::max({source.specular[0], source.specular[1], source.specular[2]}));
    material.shininess = source.shininess >= 1.0F ? std::min(source.shininess, 4096.0F) : 1.0F;
    if (source.dissolve < 1.0F) warn(fmt::format("material '{}' is drawn opaque", printable(material_name)));
    material.base_color_texture.texture = textureOf(source.diffuse_texname);
    if (source.diffuse_texopt.clamp)
      material.base_color_texture.wrap_u = material.base_color_texture.wrap_v = Wrap::kClamp;
    return material;
  }

 private:
  std::int32_t textureOf(const std::string& file_name) {
    if (file_name.empty()) return kNone;
    const auto [it, is_new] = textures_.try_emplace(file_name, kNone);
    if (!is_new) return it->second;
    try {
      scene_.textures.push_back({file_name, decodeImage(folder_.read(file_name), printable(file_name))});
      it->second = static_cast<std::int32_t>(scene_.textures.size()) - 1;
    } catch (const Error& e) {
      warn(fmt::format("texture not used: {}", e.what()));
    }
    return it->second;
  }

  void warn(std::string_view text) { scene_.warnings.push_back(fmt::format("{}: {}", name_, text)); }

  std::filesystem::path path_;
  AssetFolder folder_;
  std::string name_;
  Scene& scene_;
  std::map<std::string, int> numbers_;
  std::vector<tinyobj::material_t> materials_;
  std::map<std::string, std::int32_t> textures_;
};

void addMeshes(const ObjFile& file, MaterialLibrary& library, Scene& scene) {
  std::vector<std::vector<std::uint32_t>> triangles_of(file.material_names.size());
  for (std::size_t f = 0; f < file.triangles.size(); ++f)
    triangles_of[static_cast<std::size_t>(file.triangle_materials[f])].push_back(static_cast<std::uint32_t>(f));
  VertexJoiner joiner(file);
  for (std::size_t m = 0; m < triangles_of.size(); ++m) {
    if (triangles_of[m].empty()) continue;
    const auto number = static_cast<std::uint32_t>(scene.meshes.size());
    scene.meshes.push_back(joiner.join(triangles_of[m]));
    scene.materials.push_back(library.make(file.material_names[m], !file.colors.empty()));
    scene.instances.push_back({number, number, DMat4(1.0)});
  }
}

}  // namespace

Scene importObj(ImportSource source, const ImportOptions& options) {
  Scene scene;
  joinContinuationLines(source.bytes);
  ObjParser parser(source.bytes, source.name);
  ObjFile file = parser.parse();
  source.bytes = {};
  parser.reportTo(scene.warnings);
  if (file.triangles.empty()) refuse(source.name, parser.whyEmpty());
  if (!normalizeNormals(file)) {
    if (!file.normals.empty())
      scene.warnings.push_back(fmt::format("{}: some corners have no normal; {}", source.name,
                                           options.for_drawing ? "normals are made anew" : "they are left out"));
    if (options.for_drawing)
      makeNormals(file, options.crease_angle_rad);
    else
      dropNormals(file);
  }
  MaterialLibrary library(source, scene);
  for (const std::string& name : file.libraries) library.read(name);
  addMeshes(file, library, scene);
  if (library.empty()) library.useTextureBesideFile();
  return scene;
}

}  // namespace sheaf::scenes
