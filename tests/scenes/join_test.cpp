#include "scenes/join.h"

#include "import_helpers.h"

namespace sheaf::scenes {
namespace {

mesh::Mesh triangle(bool with_normals) {
  mesh::Mesh m;
  m.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  if (with_normals) m.normals.assign(3, Vec3(0, 0, 1));
  m.triangles = {{0, 1, 2}};
  return m;
}

DMat4 scaled(double x, double y, double z) {
  return {DVec4(x, 0, 0, 0), DVec4(0, y, 0, 0), DVec4(0, 0, z, 0), DVec4(5, 0, 0, 1)};
}

DVec3 normalOf(const mesh::Mesh& m, std::size_t f) {
  const mesh::Triangle& t = m.triangles[f];
  return glm::normalize(
      glm::cross(DVec3(m.positions[t[1]] - m.positions[t[0]]), DVec3(m.positions[t[2]] - m.positions[t[0]])));
}

}  // namespace

TEST_CASE("scenes/join: one instance keeps its vertices, equal ones too") {
  Scene scene;
  scene.meshes = {triangle(true)};
  scene.meshes[0].positions[1] = scene.meshes[0].positions[0];
  scene.materials.resize(1);
  scene.instances = {{0, 0, DMat4(1.0)}};
  const mesh::Mesh joined = joinedMesh(scene);
  CHECK(joined.positions == scene.meshes[0].positions);
  CHECK(joined.normals == scene.meshes[0].normals);
  CHECK(joined.triangles == scene.meshes[0].triangles);
}

TEST_CASE("scenes/join: instances stand where they are drawn, and a mirrored one keeps its outside") {
  Scene scene;
  scene.meshes = {triangle(true)};
  scene.meshes[0].normals.assign(3, glm::normalize(Vec3(1, 0, 1)));
  scene.materials.resize(1);
  scene.instances = {{0, 0, DMat4(1.0)}, {0, 0, scaled(2, 1, 1)}, {0, 0, scaled(-1, 1, 1)}};
  const mesh::Mesh joined = joinedMesh(scene);
  REQUIRE(joined.triangleCount() == 3);
  CHECK(joined.positions[joined.triangles[1][1]] == Vec3(7, 0, 0));
  for (std::size_t f = 0; f < 3; ++f) CHECK(normalOf(joined, f).z == doctest::Approx(1.0));
  // A normal turns against a stretched axis, and with a mirrored one.
  const Vec3 stretched = joined.normals[joined.triangles[1][0]], mirrored = joined.normals[joined.triangles[2][0]];
  CHECK(stretched.x / stretched.z == doctest::Approx(0.5));
  CHECK(glm::length(stretched) == doctest::Approx(1.0));
  CHECK(mirrored.x / mirrored.z == doctest::Approx(-1.0));
  CHECK(mirrored.z > 0.0F);
}

TEST_CASE("scenes/join: a surface cut up by material is whole again; attributes that some mesh lacks are left out") {
  Scene scene;
  scene.meshes = {triangle(true), triangle(false)};
  scene.meshes[1].positions[0] = {1, 1, 0};
  std::swap(scene.meshes[1].positions[1], scene.meshes[1].positions[2]);
  scene.materials.resize(2);
  scene.instances = {{0, 0, DMat4(1.0)}, {1, 1, DMat4(1.0)}};
  const mesh::Mesh joined = joinedMesh(scene);
  CHECK(joined.vertexCount() == 4);
  CHECK(joined.triangleCount() == 2);
  CHECK(joined.normals.empty());
}

TEST_CASE("scenes/join: nothing drawn is an empty mesh") {
  CHECK(joinedMesh({}).positions.empty());
}

TEST_CASE("scenes/join: a mesh per instance has the places and triangles of the joined mesh, in a space of its own") {
  Scene scene;
  scene.meshes = {triangle(true), triangle(false)};
  scene.meshes[0].normals.assign(3, glm::normalize(Vec3(1, 0, 1)));
  scene.materials.resize(2);
  scene.instances = {{1, 1, DMat4(1.0)}, {0, 0, scaled(2, 1, 3)}, {0, 1, scaled(-1, 1, 1)}};
  const mesh::Mesh joined = joinedMesh(scene);
  const DMat4 turn(DVec4(1, 0, 0, 0), DVec4(0, 0, -1, 0), DVec4(0, 1, 0, 0), DVec4(0, 0, 0, 1));
  for (const bool turned : {false, true}) {
    Scene asked = scene;
    if (turned)
      for (Instance& instance : asked.instances) instance.world_from_object = turn * instance.world_from_object;
    const Scene apart = withMeshPerInstance(asked, turned ? turn : DMat4(1.0));
    REQUIRE(apart.meshes.size() == 3);
    for (std::uint32_t i = 0; i < 3; ++i) {
      const Instance& instance = apart.instances[i];
      CHECK(instance.mesh == i);
      CHECK(instance.material == scene.instances[i].material);
      CHECK(instance.world_from_object == (turned ? turn : DMat4(1.0)));
      CHECK(apart.meshes[i].normals.empty() == scene.meshes[scene.instances[i].mesh].normals.empty());
      for (std::size_t k = 0; k < 3; ++k)
        CHECK(apart.meshes[i].positions[apart.meshes[i].triangles[0][k]] == joined.positions[joined.triangles[i][k]]);
    }
    CHECK(normalOf(apart.meshes[2], 0).z == doctest::Approx(1.0));
    CHECK(boundsOf(apart).lo == boundsOf(asked).lo);
    CHECK(boundsOf(apart).hi == boundsOf(asked).hi);
  }
}

}  // namespace sheaf::scenes
