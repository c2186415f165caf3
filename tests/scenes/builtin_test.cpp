#include "scenes/builtin.h"

#include <doctest/doctest.h>

#include <cstring>
#include <map>
#include <tuple>

#include "core/error.h"
#include "scenes/camera.h"

namespace sheaf::scenes {
namespace {

/// FNV-1a over the bytes of values that have no padding.
class Hash {
 public:
  template <typename T>
  void add(const std::vector<T>& values) {
    for (const T& v : values) add(&v, sizeof v);
  }
  void add(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) value_ = (value_ ^ bytes[i]) * 0x100000001b3ULL;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

std::uint64_t hashOfScene(const Scene& scene) {
  Hash hash;
  for (const mesh::Mesh& m : scene.meshes) {
    hash.add(m.positions);
    hash.add(m.normals);
    hash.add(m.texcoords);
    hash.add(m.colors);
    hash.add(m.triangles);
  }
  for (const Texture& t : scene.textures) hash.add(t.pixels.pixels().data(), t.pixels.pixels().size_bytes());
  for (const Instance& i : scene.instances) {
    hash.add(&i.mesh, sizeof i.mesh);
    hash.add(&i.material, sizeof i.material);
    const glm::mat4 placed(i.world_from_object);  // what the last bit of a double is does not matter
    hash.add(&placed, sizeof placed);
  }
  return hash.value();
}

/// Small specs of every scene, so that whatever holds for all of them is quick to check.
const std::vector<std::string>& smallSpecs() {
  static const std::vector<std::string> specs = {"gallery",      "teapot?n=6",    "sphere?n=5",  "torusknot?u=64&v=12",
                                                 "terrain?n=33", "city?blocks=3", "cornell?n=4", "fill?layers=3"};
  return specs;
}

using Point = std::tuple<float, float, float>;
using Edge = std::pair<Point, Point>;

Point pointOf(const Vec3& p) {
  return {p.x + 0.0F, p.y + 0.0F, p.z + 0.0F};  // -0 becomes 0
}

/// Directed edges that have no partner in the other direction, after welding by position.
std::size_t openEdges(const mesh::Mesh& m) {
  std::map<Edge, int> balance;
  for (const mesh::Triangle& t : m.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const Point a = pointOf(m.positions[t[i]]);
      const Point b = pointOf(m.positions[t[(i + 1) % 3]]);
      if (a < b)
        ++balance[{a, b}];
      else
        --balance[{b, a}];
    }
  std::size_t open = 0;
  for (const auto& [edge, count] : balance)
    if (count != 0) ++open;
  return open;
}

double volumeOf(const mesh::Mesh& m) {
  double six_volumes = 0.0;
  for (const mesh::Triangle& t : m.triangles)
    six_volumes += glm::dot(DVec3(m.positions[t[0]]), glm::cross(DVec3(m.positions[t[1]]), DVec3(m.positions[t[2]])));
  return six_volumes / 6.0;
}

}  // namespace

TEST_CASE("scenes/builtin: the list names every scene once, with sound defaults") {
  CHECK(builtinScenes().size() == smallSpecs().size());
  for (std::size_t i = 0; i < builtinScenes().size(); ++i) {
    const BuiltinInfo& info = builtinScenes()[i];
    CHECK(smallSpecs()[i].substr(0, smallSpecs()[i].find('?')) == info.name);
    CHECK(!info.description.empty());
    for (const BuiltinParameter& p : info.parameters) {
      CAPTURE(p.name);
      CHECK(p.default_value >= p.min);
      CHECK(p.default_value <= p.max);
      CHECK(!p.meaning.empty());
      if (!p.words.empty()) CHECK(static_cast<double>(p.words.size()) == p.max + 1.0);
    }
  }
}

TEST_CASE("scenes/builtin: scenes are valid: indices in range, numbers finite, normals unit") {
  for (const std::string& spec : smallSpecs()) {
    CAPTURE(spec);
    const Scene scene = buildBuiltin(spec);
    CHECK(scene.name == spec.substr(0, spec.find('?')));
    CHECK(!scene.materials.empty());
    CHECK(!scene.instances.empty());
    CHECK(scene.triangleCount() > 0);
    for (const Instance& i : scene.instances) {
      REQUIRE(i.mesh < scene.meshes.size());
      REQUIRE(i.material < scene.materials.size());
      for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) REQUIRE(std::isfinite(i.world_from_object[c][r]));
      CHECK(glm::determinant(DMat3(i.world_from_object)) > 0.0);
    }
    for (const Material& m : scene.materials)
      CHECK(m.base_color_texture.texture < static_cast<std::int32_t>(scene.textures.size()));
    for (const Texture& t : scene.textures) CHECK(!t.pixels.empty());
    for (const Light& l : scene.lights) CHECK(glm::length(l.direction_to_light_world) == doctest::Approx(1.0F));
    for (const mesh::Mesh& m : scene.meshes) {
      const std::size_t n = m.vertexCount();
      REQUIRE(m.normals.size() == n);
      REQUIRE((m.texcoords.size() == n || m.texcoords.empty()));
      REQUIRE((m.colors.size() == n || m.colors.empty()));
      bool all_finite = true;
      bool all_unit = true;
      for (const Vec3& p : m.positions) all_finite = all_finite && isFinite(p);
      for (const Vec3& v : m.normals) all_unit = all_unit && std::abs(glm::length(v) - 1.0F) < 1e-5F;
      for (const Vec2& t : m.texcoords) all_finite = all_finite && std::isfinite(t.x) && std::isfinite(t.y);
      CHECK(all_finite);
      CHECK(all_unit);
      for (const mesh::Triangle& t : m.triangles) REQUIRE(std::max({t[0], t[1], t[2]}) < n);
    }
    const Camera camera =
        fitClipPlanes(scene.cameras.empty() ? fitCamera(scene, namedView("iso"), 1.0, 1.0, false) : scene.cameras[0],
                      boundsOf(scene));
    CHECK(camera.near > 0.0);
    CHECK(camera.far > camera.near);
  }
}

TEST_CASE("scenes/builtin: triangles turn the way their normals point, and none has two equal corners") {
  for (const std::string& spec : smallSpecs()) {
    CAPTURE(spec);
    const Scene scene = buildBuiltin(spec);
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
      const mesh::Mesh& m = scene.meshes[i];
      CAPTURE(i);
      std::size_t against = 0;
      std::size_t degenerate = 0;
      for (const mesh::Triangle& t : m.triangles) {
        const DVec3 a(m.positions[t[0]]);
        const DVec3 b(m.positions[t[1]]);
        const DVec3 c(m.positions[t[2]]);
        if (a == b || b == c || c == a) ++degenerate;
        const DVec3 normals = DVec3(m.normals[t[0]]) + DVec3(m.normals[t[1]]) + DVec3(m.normals[t[2]]);
        if (glm::dot(glm::cross(b - a, c - a), normals) <= 0.0) ++against;
      }
      CHECK(against == 0);
      CHECK(degenerate == 0);
    }
  }
}

TEST_CASE("scenes/builtin: closed shapes are closed and not inside out") {
  for (const char* spec :
       {"sphere?n=1", "sphere?n=7", "torusknot?u=64&v=12", "torusknot?p=3&q=7&u=211&v=9&radius=0.1"}) {
    CAPTURE(spec);
    const Scene scene = buildBuiltin(spec);
    CHECK(openEdges(scene.meshes[0]) == 0);
    CHECK(volumeOf(scene.meshes[0]) > 0.0);
  }
  for (const mesh::Mesh& m : buildBuiltin("city?blocks=1").meshes) {
    CHECK(openEdges(m) == 0);
    CHECK(volumeOf(m) > 0.0);
  }
  const double sphere = volumeOf(buildBuiltin("sphere?n=64").meshes[0]);
  CHECK(sphere == doctest::Approx(4.0 / 3.0 * kPi).epsilon(0.002));
}

TEST_CASE("scenes/builtin: parameters set what they say they set") {
  CHECK(buildBuiltin("sphere?n=10").triangleCount() == 12 * 100);
  CHECK(buildBuiltin("sphere?n=10").vertexCount() == 6 * 100 + 2);
  CHECK(buildBuiltin("torusknot?u=100&v=20").triangleCount() == 2 * 100 * 20);
  CHECK(buildBuiltin("terrain?n=65").triangleCount() == 2 * 64 * 64);
  CHECK(buildBuiltin("terrain?n=65").vertexCount() == 65 * 65);
  CHECK(buildBuiltin("fill?layers=7&n=3").triangleCount() == 7 * 2 * 9);
  CHECK(buildBuiltin("cornell?n=3").triangleCount() == (6 + 2 * 5) * 2 * 9);
  // Two of the 32 patches of every quarter end in a pole, which takes one triangle from each quad there.
  CHECK(buildBuiltin("teapot?n=5").triangleCount() == 32 * 2 * 25 - 2 * 4 * 5);
  CHECK(buildBuiltin("city?blocks=6").instances.size() > 4 * buildBuiltin("city?blocks=2").instances.size());
  CHECK(buildBuiltin("gallery?detail=2").triangleCount() > 3 * buildBuiltin("gallery").triangleCount());
  for (const char* name : {"terrain?n=33&seed=", "city?blocks=2&seed="}) {
    const std::string spec = name;
    CHECK(hashOfScene(buildBuiltin(spec + "1")) != hashOfScene(buildBuiltin(spec + "2")));
  }
  const Scene flat = buildBuiltin("terrain?n=9&relief=0");
  CHECK(boundsOf(flat).size().y == 0.0F);
}

TEST_CASE("scenes/builtin: fill draws its layers in the order asked for, each over the whole picture") {
  const auto depths = [](const std::string& order) {
    std::vector<double> z;
    for (const Instance& i : buildBuiltin("fill?layers=20&order=" + order).instances)
      z.push_back(i.world_from_object[3].z);
    return z;
  };
  const std::vector<double> near_first = depths("front_to_back");
  const std::vector<double> far_first = depths("back_to_front");
  std::vector<double> shuffled = depths("shuffled");
  CHECK(std::is_sorted(near_first.rbegin(), near_first.rend()));
  CHECK(std::is_sorted(far_first.begin(), far_first.end()));
  CHECK(depths("1") == far_first);
  CHECK(shuffled != near_first);
  CHECK(shuffled != far_first);
  std::sort(shuffled.begin(), shuffled.end());
  CHECK(shuffled == far_first);

  const Scene scene = buildBuiltin("fill?layers=5");
  CHECK(scene.materials[0].base_color != scene.materials[1].base_color);
  for (const double aspect : {0.1, 1.0, 16.0}) {
    const Camera& camera = scene.cameras[0];
    const DMat4 clip_from_world = clipFromView(camera, aspect) * viewFromWorld(camera);
    for (const Instance& i : scene.instances)
      for (const Vec3& p : scene.meshes[0].positions) {
        const DVec4 clip = clip_from_world * (i.world_from_object * DVec4(DVec3(p), 1.0));
        CHECK(std::abs(clip.x) >= clip.w);
        CHECK(std::abs(clip.y) >= clip.w);
        CHECK(clip.z > 0.0);
        CHECK(clip.z < clip.w);
      }
  }
}

TEST_CASE("scenes/builtin: the same text gives the same scene") {
  for (const std::string& spec : smallSpecs()) {
    CAPTURE(spec);
    CHECK(hashOfScene(buildBuiltin(spec)) == hashOfScene(buildBuiltin(spec)));
  }
}

TEST_CASE("scenes/builtin: scenes made by +, -, *, / and square roots alone are the same bytes everywhere") {
  CHECK(hashOfScene(buildBuiltin("sphere?n=16")) == 0x222acd6fef6fb649ULL);
  CHECK(hashOfScene(buildBuiltin("terrain?n=65&seed=3")) == 0xf05946e0184c8e29ULL);
  CHECK(hashOfScene(buildBuiltin("fill?layers=9&order=shuffled")) == 0xf2c31fba03deee70ULL);
}

TEST_CASE("scenes/builtin: unknown names, parameters and values are refused with what exists") {
  const auto refusal = [](const std::string& spec) -> std::string {
    try {
      buildBuiltin(spec);
    } catch (const Error& e) {
      CHECK(e.code() == ErrorCode::kUsage);
      return e.what();
    }
    return "accepted";
  };
  CHECK(refusal("teacup") ==
        "builtin:teacup: no such scene; there are gallery, teapot, sphere, torusknot, terrain, "
        "city, cornell, fill");
  CHECK(refusal("").find("no such scene") != std::string::npos);
  CHECK(refusal("sphere?m=3") == "builtin:sphere: no parameter \"m\"; there are n=1..1024");
  CHECK(refusal("sphere?n=1.5") == "builtin:sphere: n is \"1.5\", must be a whole number, n=1..1024");
  CHECK(refusal("fill?order=sideways").find("front_to_back|back_to_front|shuffled") != std::string::npos);
  for (const char* spec : {"sphere?n", "sphere?n=", "sphere?n=x", "sphere?n=3x", "sphere?n=nan", "sphere?n=1e999",
                           "sphere?n=3&n=4", "sphere?&", "sphere?=3", "sphere?N=3"}) {
    CAPTURE(spec);
    CHECK(refusal(spec).rfind("builtin:sphere: ", 0) == 0);
  }
  CHECK_NOTHROW(buildBuiltin("sphere?n=3&"));
  CHECK_NOTHROW(buildBuiltin("sphere?"));
  for (const BuiltinInfo& info : builtinScenes())
    for (const BuiltinParameter& p : info.parameters)
      for (const double value : {p.min - 1.0, p.max + 1.0}) {
        const std::string spec = info.name + "?" + p.name + "=" + std::to_string(value);
        CAPTURE(spec);
        CHECK(refusal(spec).find(p.name + " is ") != std::string::npos);
      }
}

}  // namespace sheaf::scenes
