#include "pipeline/triangle_colors.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "grouping/dual_graph.h"
#include "raster/srgb.h"
#include "scenes/painted_parts.h"
#include "tests/mesh/meshes.h"
#include "tests/pipeline/scene_fixture.h"

namespace sheaf::pipeline {
namespace {

constexpr int kWidth = 131, kHeight = 97;

scenes::Scene sceneOf(mesh::Mesh mesh) {
  scenes::Scene scene;
  scene.meshes.push_back(std::move(mesh));
  scene.materials.emplace_back();
  scene.instances.emplace_back();
  return scene;
}

// Three flat steps, each of 20 x 20 squares.
mesh::Mesh stair() {
  constexpr std::uint32_t kSide = 20, kSteps = 3;
  mesh::Mesh mesh;
  for (std::uint32_t row = 0; row < kSteps * (kSide + 1); ++row)
    for (std::uint32_t x = 0; x <= kSide; ++x) {
      const std::uint32_t step = row / (kSide + 1);
      mesh.positions.emplace_back(float(x), 7.0F * float(step), -float(row - step));
    }
  for (std::uint32_t row = 0; row + 1 < kSteps * (kSide + 1); ++row)
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const std::uint32_t a = row * (kSide + 1) + x, b = a + 1, c = a + kSide + 1, d = c + 1;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({b, d, c});
    }
  return mesh;
}

// Neighbouring faces of a surface in different parts of the same colour.
std::size_t confusedFaces(const mesh::Mesh& surface, const std::vector<std::uint32_t>& part,
                          const std::vector<std::uint8_t>& colors) {
  std::size_t count = 0;
  for (const grouping::DualEdge& e : grouping::buildDualGraph(surface, grouping::modelFrameOf(surface)).edges)
    count += part[e.face[0]] != part[e.face[1]] && colors[e.face[0]] == colors[e.face[1]];
  return count;
}

}  // namespace

TEST_CASE("pipeline/triangle_colors: each pixel is what it is in white, in the colour of the triangle seen there") {
  TaskPool pool(2);
  for (const char* spec : kSmallScenes) {
    CAPTURE(spec);
    scenes::Scene scene = scenes::buildBuiltin(spec);
    const scenes::Camera camera = usualCamera(scene, double(kWidth) / kHeight);
    if (scene.lights.empty()) scenes::addDefaultLights(scene, camera);
    const SceneSurface surface = surfaceOf(scene);
    whitenSurfaces(scene);
    const PreparedScene prepared = prepareScene(std::move(scene), pool);
    const TriangleColors colors = colorsByPatch(prepared, surface);
    Frame white, colored;
    Renderer(pool).render(prepared, camera, allChannels(kWidth, kHeight), white);
    Renderer(pool).render(prepared, camera, allChannels(kWidth, kHeight), colored);
    colorPixels(colors, colored, pool);
    std::set<std::uint8_t> seen;
    std::size_t wrong = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const std::uint32_t instance = white.instance_id.at(x, y);
        if (instance == raster::kNoTriangle) {
          wrong += colored.linear.at(x, y) != white.linear.at(x, y) || colored.color.at(x, y) != white.color.at(x, y);
          continue;
        }
        const std::uint8_t color = colors[instance][white.triangle_id.at(x, y)];
        REQUIRE(color < scenes::kPartColors);
        seen.insert(color);
        const Vec4 expected = white.linear.at(x, y) * Vec4(scenes::partColor(color), 1.0F);
        const Rgba8 code{raster::encodeSrgb(expected.r), raster::encodeSrgb(expected.g), raster::encodeSrgb(expected.b),
                         255};
        wrong += colored.linear.at(x, y) != expected || colored.color.at(x, y) != code;
      }
    CHECK(wrong == 0);
    CHECK(!seen.empty());
    CHECK(colored.depth == white.depth);
    CHECK(colored.triangle_id == white.triangle_id);
  }
}

TEST_CASE("pipeline/triangle_colors: patches that touch differ, also across creases and seams") {
  TaskPool pool(2);
  for (const char* spec : {"sphere?n=60", "teapot?n=12", "torusknot?u=200&v=24"}) {
    CAPTURE(spec);
    scenes::Scene scene = scenes::buildBuiltin(spec);
    const SceneSurface surface = surfaceOf(scene);
    const PreparedScene prepared = prepareScene(std::move(scene), pool);
    const TriangleColors colors = colorsByPatch(prepared, surface);
    REQUIRE(colors.size() == prepared.instances.size());
    std::vector<std::uint32_t> part;
    std::vector<std::uint8_t> color;
    std::uint32_t patches_before = 0;
    for (std::size_t i = 0; i < colors.size(); ++i) {
      const PreparedMesh& mesh = prepared.meshes[prepared.instances[i].mesh];
      const std::size_t first = part.size();
      part.resize(first + surface.face_count[i], grouping::kNoIndex);
      for (std::uint32_t p = 0; p < mesh.patches.size(); ++p)
        for (std::uint32_t t = 0; t < mesh.patches[p].triangle_count; ++t)
          part[first + mesh.triangle_source[mesh.patches[p].first_triangle + t]] = patches_before + p;
      patches_before += static_cast<std::uint32_t>(mesh.patches.size());
      color.insert(color.end(), colors[i].begin(), colors[i].end());
    }
    CHECK(patches_before > 8);
    CHECK(confusedFaces(surface.joined, part, color) == 0);
  }
}

TEST_CASE("pipeline/triangle_colors: patches and groups of meshes and instances that touch differ at the seam") {
  TaskPool pool(1);
  // Sixteen squares of a floor: eight copies of one mesh, eight of another, by turns. Each is one patch and one group.
  scenes::Scene scene = sceneOf(mesh::makeGrid(4));
  scene.meshes.push_back(mesh::makeGrid(4));
  const Box3 square = mesh::boundsOf(scene.meshes[0]);
  scene.instances.clear();
  for (std::uint32_t i = 0; i < 16; ++i) {
    DMat4 moved(1.0);
    moved[3] = DVec4(DVec3(square.size()) * DVec3(i % 4, i / 4, 0), 1.0);
    scene.instances.push_back({i % 2, 0, moved});
  }
  const SceneSurface surface = surfaceOf(scene);
  GroupingOptions planar;
  planar.method = Grouping::kPlanar;
  planar.prefer = Prefer::kMemory;
  const PreparedScene prepared = prepareScene(std::move(scene), pool, planar);
  std::vector<std::uint32_t> instance_of_face;
  for (std::uint32_t i = 0; i < 16; ++i) instance_of_face.insert(instance_of_face.end(), surface.face_count[i], i);
  for (const bool by_group : {false, true}) {
    CAPTURE(by_group);
    const TriangleColors colors = by_group ? colorsByGroup(prepared, surface) : colorsByPatch(prepared, surface);
    std::vector<std::uint8_t> color;
    for (const auto& list : colors) {
      CHECK(std::set<std::uint8_t>(list.begin(), list.end()).size() == 1);
      color.insert(color.end(), list.begin(), list.end());
    }
    REQUIRE(color.size() == instance_of_face.size());
    CHECK(std::count(color.begin(), color.end(), kUncolored) == 0);
    CHECK(confusedFaces(surface.joined, instance_of_face, color) == 0);
  }
}

TEST_CASE("pipeline/triangle_colors: a flat step is one group, steps differ, and without groups there is no colour") {
  TaskPool pool(1);
  const SceneSurface surface = surfaceOf(sceneOf(stair()));
  GroupingOptions planar;
  planar.method = Grouping::kPlanar;
  planar.prefer = Prefer::kMemory;
  planar.epsilon = 0.0;
  const TriangleColors colors = colorsByGroup(prepareScene(sceneOf(stair()), pool, planar), surface);
  REQUIRE(colors.size() == 1);
  REQUIRE(colors[0].size() == surface.joined.triangleCount());
  std::set<std::uint8_t> of_steps;
  for (std::uint32_t step = 0; step < 3; ++step) {
    const auto first = colors[0].begin() + std::ptrdiff_t(step * 21 * 40);
    std::set<std::uint8_t> seen(first, first + 20 * 40);
    // Where a patch has but few vertices of the step, they are drawn in full.
    CHECK(std::count(first, first + 20 * 40, kUncolored) < 400);
    seen.erase(kUncolored);
    REQUIRE(seen.size() == 1);
    CHECK(*seen.begin() < scenes::kPartColors);
    of_steps.insert(*seen.begin());
  }
  CHECK(of_steps.size() == 3);
  const TriangleColors none = colorsByGroup(prepareScene(sceneOf(stair()), pool), surface);
  for (const std::uint8_t color : none[0]) CHECK(color == kUncolored);
}

TEST_CASE("pipeline/triangle_colors: parts of the joined scene go to the instance that has the triangle") {
  scenes::Scene scene = sceneOf(mesh::makeGrid(2));
  scene.meshes.push_back(mesh::makeCube());
  scene.instances = {{1, 0, DMat4(1.0)}, {0, 0, DMat4(1.0)}, {1, 0, DMat4(1.0)}};
  std::vector<std::uint32_t> part(scene.triangleCount());
  for (std::uint32_t f = 0; f < part.size(); ++f) part[f] = f;
  std::vector<std::uint32_t> color(part.size());
  for (std::uint32_t f = 0; f < color.size(); ++f) color[f] = (5 * f + 1) % scenes::kPartColors;
  const TriangleColors colors = colorsByPart(part, color, faceCountsOf(scene));
  REQUIRE(colors.size() == 3);
  std::size_t at = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::vector<std::uint8_t>& list = colors[i];
    REQUIRE(list.size() == scene.meshes[scene.instances[i].mesh].triangleCount());
    for (const std::uint8_t c : list) CHECK(c == color[at++]);
  }
}

TEST_CASE("pipeline/triangle_colors: white surfaces have light and shade, and nothing of their own colour") {
  scenes::Scene scene = scenes::buildBuiltin("gallery");
  scene.materials[0].shading = scenes::Shading::kUnlit;
  whitenSurfaces(scene);
  CHECK(scene.textures.empty());
  for (const scenes::Material& material : scene.materials) {
    CHECK(material.base_color == Vec4(1.0F));
    CHECK(material.base_color_texture.texture == -1);
    CHECK(material.solid == scenes::Solid::kNone);
    CHECK(material.shading != scenes::Shading::kUnlit);
  }
  for (const mesh::Mesh& mesh : scene.meshes) CHECK((mesh.colors.empty() && mesh.texcoords.empty()));
}

}  // namespace sheaf::pipeline
