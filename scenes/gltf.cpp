// glTF 2.0 and GLB: nodes, meshes, cameras and lights of the default scene. Animations and skins are left out: a
// skinned mesh stands where its vertices say.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "scenes/gltf_data.h"
#include "scenes/gltf_document.h"
#include "scenes/gltf_materials.h"
#include "scenes/import.h"

namespace sheaf::scenes {
namespace {

constexpr std::size_t kMostInstances = std::size_t{1} << 24;  // a few bytes of JSON each: no more is meant seriously

// Primitives may share their accessors, so that the size of the file bounds nothing: 2^28 take 3 GB.
constexpr std::size_t kMostTriangles = std::size_t{1} << 28;

// The triangles of a primitive from its list of vertices.
std::vector<mesh::Triangle> assemble(const std::vector<std::uint32_t>& v, int mode) {
  std::vector<mesh::Triangle> triangles;
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    triangles.reserve(v.size() / 3);
    for (std::size_t i = 0; i + 2 < v.size(); i += 3) triangles.push_back({v[i], v[i + 1], v[i + 2]});
    return triangles;
  }
  // glTF 2.0 §3.7.2.1; a vertex twice stitches strips together.
  for (std::size_t i = 0; i + 2 < v.size(); ++i) {
    const mesh::Triangle t = mode == TINYGLTF_MODE_TRIANGLE_STRIP
                                 ? mesh::Triangle{v[i], v[i + 1 + i % 2], v[i + 2 - i % 2]}
                                 : mesh::Triangle{v[i + 1], v[i + 2], v[0]};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
  }
  return triangles;
}

// Several primitives may share one large array of vertices: each keeps those that it uses, if they are few. Returns
// them in ascending order and renumbers the triangles; empty = all are kept.
std::vector<std::uint32_t> selectVertices(std::vector<mesh::Triangle>& triangles, std::size_t vertex_count) {
  if (triangles.size() * 3 > vertex_count / 2) return {};
  std::vector<std::uint32_t> used;
  used.reserve(triangles.size() * 3);
  for (const mesh::Triangle& t : triangles) used.insert(used.end(), t.begin(), t.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (mesh::Triangle& t : triangles)
    for (std::uint32_t& v : t)
      v = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), v) - used.begin());
  return used;
}

template <int N>
std::vector<glm::vec<N, float>> vectorsOf(const std::vector<float>& numbers) {
  std::vector<glm::vec<N, float>> out(numbers.size() / N);
  for (std::size_t i = 0; i < out.size(); ++i)
    for (int c = 0; c < N; ++c) out[i][c] = numbers[i * N + static_cast<std::size_t>(c)];
  return out;
}

// As floats, since that is what drawing makes of them.
bool allFinite(const DMat4& m) {
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r)
      if (!(std::abs(m[c][r]) <= std::numeric_limits<float>::max())) return false;
  return true;
}

// parent_from_node
DMat4 transformOf(const tinygltf::Node& node) {
  DMat4 m(1.0);
  if (node.matrix.size() == 16) {
    for (std::size_t i = 0; i < 16; ++i) m[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = node.matrix[i];
    for (int c = 0; c < 4; ++c) m[c][3] = c == 3 ? 1.0 : 0.0;
    return m;
  }
  const std::vector<double> t = node.translation.size() == 3 ? node.translation : std::vector<double>{0, 0, 0};
  const std::vector<double> s = node.scale.size() == 3 ? node.scale : std::vector<double>{1, 1, 1};
  std::vector<double> q = node.rotation.size() == 4 ? node.rotation : std::vector<double>{0, 0, 0, 1};
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (length > 0.0)
    for (double& c : q) c /= length;
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  m[0] = s[0] * DVec4(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0);
  m[1] = s[1] * DVec4(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0);
  m[2] = s[2] * DVec4(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0);
  m[3] = DVec4(t[0], t[1], t[2], 1);
  return m;
}

class GltfImporter {
 public:
  explicit GltfImporter(ImportSource source) : document_(std::move(source)), materials_(document_, scene_) {}

  Scene import() {
    parts_.resize(document_.model().meshes.size());
    visitNodes();
    if (points_and_lines_ > 0) warn(fmt::format("{} primitives of points or lines left out", points_and_lines_));
    if (unpositioned_ > 0) warn(fmt::format("{} primitives without positions left out", unpositioned_));
    if (document_.hasSkins()) warn("skins are not applied");
    if (scene_.triangleCount() == 0) document_.fail(whyEmpty());
    return std::move(scene_);
  }

 private:
  /// A primitive as it is drawn.
  struct Part {
    std::uint32_t mesh;
    std::uint32_t material;
  };
  struct Visit {
    int node;
    DMat4 world_from_parent;
  };

  std::string_view whyEmpty() const {
    if (not_finite_ > 0) return "has no triangles: each has a position that is infinite or not a number";
    return points_and_lines_ > 0 ? "has no triangles, only points or lines" : "has no triangles";
  }

  std::vector<int> rootNodes() const {
    const tinygltf::Model& model = document_.model();
    if (!model.scenes.empty()) {
      const int number = model.defaultScene < 0 ? 0 : model.defaultScene;
      if (static_cast<std::size_t>(number) >= model.scenes.size())
        document_.fail(fmt::format("scene {} does not exist, there are {}", number, model.scenes.size()));
      return model.scenes[static_cast<std::size_t>(number)].nodes;
    }
    // No scene: all nodes that are nobody's child.
    std::vector<bool> is_child(model.nodes.size(), false);
    for (const tinygltf::Node& node : model.nodes)
      for (const int child : node.children)
        if (child >= 0 && static_cast<std::size_t>(child) < is_child.size())
          is_child[static_cast<std::size_t>(child)] = true;
    std::vector<int> roots;
    for (std::size_t n = 0; n < is_child.size(); ++n)
      if (!is_child[n]) roots.push_back(static_cast<int>(n));
    return roots;
  }

  // Depth first, children in order. The list of what is to be visited takes the place of recursion, whose depth a file
  // could choose.
  void visitNodes() {
    const auto& nodes = document_.model().nodes;
    std::vector<bool> visited(nodes.size(), false);
    std::vector<Visit> stack;
    const auto push = [&](const std::vector<int>& children, const DMat4& world_from_parent) {
      for (auto it = children.rbegin(); it != children.rend(); ++it) stack.push_back({*it, world_from_parent});
    };
    push(rootNodes(), DMat4(1.0));
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      if (visit.node < 0 || static_cast<std::size_t>(visit.node) >= nodes.size())
        document_.fail(fmt::format("node {} does not exist, there are {}", visit.node, nodes.size()));
      const auto n = static_cast<std::size_t>(visit.node);
      if (visited[n]) document_.fail(fmt::format("node {} has two parents or is its own ancestor", visit.node));
      visited[n] = true;
      const DMat4 world_from_node = visit.world_from_parent * transformOf(nodes[n]);
      if (!allFinite(world_from_node))
        document_.fail(fmt::format("node {} has a transform that is not finite", visit.node));
      addNode(nodes[n], world_from_node);
      push(nodes[n].children, world_from_node);
    }
  }

  void addNode(const tinygltf::Node& node, const DMat4& world_from_node) {
    if (node.mesh >= 0) {
      for (const Part& part : partsOf(node.mesh))
        scene_.instances.push_back({part.mesh, part.material, world_from_node});
      if (scene_.instances.size() > kMostInstances) document_.fail("has too many instances");
    }
    if (node.camera >= 0) addCamera(node, world_from_node);
    const auto light = node.extensions.find("KHR_lights_punctual");
    if (light != node.extensions.end() && light->second.Has("light") && light->second.Get("light").IsInt())
      addLight(light->second.Get("light").GetNumberAsInt(), world_from_node);
  }

  const std::vector<Part>& partsOf(int mesh) {
    const auto& meshes = document_.model().meshes;
    if (static_cast<std::size_t>(mesh) >= meshes.size())
      document_.fail(fmt::format("mesh {} does not exist, there are {}", mesh, meshes.size()));
    std::optional<std::vector<Part>>& parts = parts_[static_cast<std::size_t>(mesh)];
    if (parts) return *parts;
    parts.emplace();
    const auto& primitives = meshes[static_cast<std::size_t>(mesh)].primitives;
    for (std::size_t p = 0; p < primitives.size(); ++p)
      addPrimitive(primitives[p], fmt::format("mesh {} primitive {}", mesh, p), *parts);
    return *parts;
  }

  static int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
    const auto it = primitive.attributes.find(name);
    return it == primitive.attributes.end() ? -1 : it->second;
  }

  // The vertices of a primitive in drawing order.
  std::vector<std::uint32_t> vertexList(const tinygltf::Primitive& primitive, std::size_t vertex_count,
                                        const std::string& place) {
    std::vector<std::uint32_t> list;
    if (primitive.indices >= 0) {
      list = readIndices(document_, primitive.indices);
      for (std::size_t i = 0; i < list.size(); ++i)
        if (list[i] >= vertex_count)
          document_.fail(fmt::format("{}: index {} is {}, the mesh has {} vertices", place, i, list[i], vertex_count));
      return list;
    }
    list.resize(vertex_count);
    for (std::size_t i = 0; i < vertex_count; ++i) list[i] = static_cast<std::uint32_t>(i);
    return list;
  }

  // The numbers of an attribute; empty if the primitive has none.
  std::vector<float> attributeNumbers(const tinygltf::Primitive& primitive, const std::string& name, int components,
                                      int least_components, std::size_t vertex_count,
                                      const std::vector<std::uint32_t>& selection, const std::string& place) {
    const int accessor = attribute(primitive, name);
    if (accessor < 0) return {};
    if (const std::size_t count = accessorCount(document_, accessor); count != vertex_count)
      document_.fail(fmt::format("{}: {} has {} elements, POSITION has {}", place, name, count, vertex_count));
    return readAccessor(document_, accessor, components, least_components, selection);
  }

  void addPrimitive(const tinygltf::Primitive& primitive, const std::string& place, std::vector<Part>& parts) {
    const int mode = primitive.mode == -1 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    if (mode < TINYGLTF_MODE_POINTS || mode > TINYGLTF_MODE_TRIANGLE_FAN)
      document_.fail(fmt::format("{}: unknown mode {}", place, mode));
    if (mode < TINYGLTF_MODE_TRIANGLES) {
      ++points_and_lines_;
      return;
    }
    const int positions = attribute(primitive, "POSITION");
    if (positions < 0) {
      ++unpositioned_;
      return;
    }
    const std::size_t vertex_count = accessorCount(document_, positions);
    // A count is believed only after the bytes have been found.
    readAccessor(document_, positions, 3, 3, std::array<std::uint32_t, 1>{0});
    mesh::Mesh mesh;
    mesh.triangles = assemble(vertexList(primitive, vertex_count, place), mode);
    const std::vector<std::uint32_t> selection = selectVertices(mesh.triangles, vertex_count);
    const auto numbers = [&](const std::string& name, int components, int least) {
      return attributeNumbers(primitive, name, components, least, vertex_count, selection, place);
    };
    if (mesh.triangles.empty()) return;
    triangle_count_ += mesh.triangleCount();
    if (triangle_count_ > kMostTriangles) document_.fail(fmt::format("has more than {} triangles", kMostTriangles));
    mesh.positions = vectorsOf<3>(numbers("POSITION", 3, 3));
    mesh.normals = vectorsOf<3>(numbers("NORMAL", 3, 3));
    mesh.colors = vectorsOf<4>(numbers("COLOR_0", 4, 3));
    if (const int set = materials_.texcoordSet(primitive.material); set >= 0)
      mesh.texcoords = vectorsOf<2>(numbers(fmt::format("TEXCOORD_{}", set), 2, 2));
    dropBadTriangles(mesh, fmt::format("{}: {}", document_.name(), place), scene_);
    if (mesh.triangles.empty()) {
      ++not_finite_;
      return;
    }
    if (!mesh.normals.empty() && !normalizeNormals(mesh)) {
      warn(fmt::format("{}: some normals have no direction; drawn flat", place));
      mesh.normals = {};
    }
    const std::uint32_t material = materials_.number(primitive.material, mesh.normals.empty());
    parts.push_back({static_cast<std::uint32_t>(scene_.meshes.size()), material});
    scene_.meshes.push_back(std::move(mesh));
  }

  void addCamera(const tinygltf::Node& node, const DMat4& world_from_node) {
    const auto& cameras = document_.model().cameras;
    if (static_cast<std::size_t>(node.camera) >= cameras.size())
      document_.fail(fmt::format("camera {} does not exist, there are {}", node.camera, cameras.size()));
    const tinygltf::Camera& source = cameras[static_cast<std::size_t>(node.camera)];
    const bool parallel = source.type == "orthographic";
    const double size = parallel ? 2.0 * std::abs(source.orthographic.ymag) : source.perspective.yfov;
    const DVec3 back(world_from_node[2]), up(world_from_node[1]);
    const bool usable = size > 0.0 && (parallel || size < kPi) && glm::length(back) > 0.0 && glm::length(up) > 0.0;
    if (!usable) {
      warn(fmt::format("camera {} left out: it sees nothing", node.camera));
      return;
    }
    Camera camera;
    camera.name = source.name.empty() ? node.name : source.name;
    camera.eye = DVec3(world_from_node[3]);
    camera.target = camera.eye - glm::normalize(back);
    camera.up = glm::normalize(up);
    if (parallel)
      camera.orthographic_height = size;
    else
      camera.vertical_fov_rad = size;
    const double near = parallel ? source.orthographic.znear : source.perspective.znear;
    const double far = parallel ? source.orthographic.zfar : source.perspective.zfar;
    if (near > 0.0) camera.near = near;
    if (far > camera.near) camera.far = far;
    scene_.cameras.push_back(std::move(camera));
  }

  // Illuminance in lux to the radiance that a white Lambert surface returns: over pi.
  void addLight(int number, const DMat4& world_from_node) {
    const auto& lights = document_.model().lights;
    if (number < 0 || static_cast<std::size_t>(number) >= lights.size())
      document_.fail(fmt::format("light {} does not exist, there are {}", number, lights.size()));
    const tinygltf::Light& source = lights[static_cast<std::size_t>(number)];
    const DVec3 to_light(world_from_node[2]);
    if (source.type != "directional" || glm::length(to_light) == 0.0) {
      warn(fmt::format("light {} left out: only directional ones are supported", number));
      return;
    }
    DVec3 color(1.0);
    if (source.color.size() == 3) color = {source.color[0], source.color[1], source.color[2]};
    const DVec3 radiance = color * (source.intensity / kPi);
    if (!(std::min({radiance.r, radiance.g, radiance.b}) >= 0.0 &&
          std::max({radiance.r, radiance.g, radiance.b}) < 1e30)) {
      warn(fmt::format("light {} left out: its intensity cannot be used", number));
      return;
    }
    scene_.lights.push_back({Vec3(glm::normalize(to_light)), Vec3(radiance)});
  }

  void warn(std::string_view text) { scene_.warnings.push_back(fmt::format("{}: {}", document_.name(), text)); }

  Scene scene_;
  GltfDocument document_;
  GltfMaterials materials_;
  std::vector<std::optional<std::vector<Part>>> parts_;
  std::size_t triangle_count_ = 0;
  std::size_t points_and_lines_ = 0;
  std::size_t unpositioned_ = 0;
  std::size_t not_finite_ = 0;  ///< primitives all of whose triangles were left out
};

}  // namespace

Scene importGltf(ImportSource source) {
  return GltfImporter(std::move(source)).import();
}

}  // namespace sheaf::scenes
