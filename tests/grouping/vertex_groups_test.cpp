#include "grouping/vertex_groups.h"

#include <doctest/doctest.h>

#include <limits>

#include "core/error.h"
#include "grouping/planar_groups.h"
#include "tests/grouping/shapes.h"
#include "tests/temp_folder.h"

namespace sheaf::grouping {

TEST_CASE("grouping/plane_sets: frames are right-handed and orthonormal") {
  const DVec3 odd[] = {{1, 1, 0}, {-1, 0, 0}, {1e-3, -5, 2}, {1, 1, 1}};
  for (const auto& planes : {axisAndDodecahedronPlanes(), planesFromNormals(odd)})
    for (const PlaneFrame& f : planes) {
      CHECK(glm::length(f.normal) == doctest::Approx(1.0));
      CHECK(glm::length(f.axis_s) == doctest::Approx(1.0));
      CHECK(std::abs(glm::dot(f.normal, f.axis_s)) < 1e-6F);
      CHECK(glm::length(glm::cross(f.axis_s, f.axis_t) - f.normal) < 1e-6F);
    }
}

TEST_CASE("grouping/plane_sets: axis planes have the other two axes in turn") {
  const std::vector<PlaneFrame> planes = axisPlanes();
  REQUIRE(planes.size() == 3);
  for (int k = 0; k < 3; ++k) {
    CHECK(planes[k].normal[k] == 1.0F);
    CHECK(planes[k].axis_s[(k + 1) % 3] == 1.0F);
    CHECK(planes[k].axis_t[(k + 2) % 3] == 1.0F);
  }
}

TEST_CASE("grouping/plane_sets: any two faces of the dodecahedron meet at the same angle") {
  const std::vector<PlaneFrame> planes = dodecahedronPlanes();
  REQUIRE(planes.size() == 6);
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < i; ++j)
      CHECK(std::abs(glm::dot(planes[i].normal, planes[j].normal)) == doctest::Approx(1.0 / std::sqrt(5.0)));
}

TEST_CASE("grouping/plane_sets: normals without a direction are refused") {
  CHECK_THROWS_AS(planesFromNormals({}), Error);
  const DVec3 zero[] = {{1, 0, 0}, {0, 0, 0}};
  CHECK_THROWS_WITH_AS(planesFromNormals(zero), doctest::Contains("normal 2"), Error);
  const DVec3 nan[] = {{std::numeric_limits<double>::quiet_NaN(), 0, 0}};
  CHECK_THROWS_AS(planesFromNormals(nan), Error);
}

TEST_CASE("grouping/plane_sets: a file has a normal on each line, comments and empty lines aside") {
  const TempFolder folder;
  folder.write("planes.txt", "# two planes\n\n1 0 0\r\n  0\t-2e0 0  # down\n");
  const std::vector<PlaneFrame> planes = loadPlanes(folder.file("planes.txt"));
  REQUIRE(planes.size() == 2);
  CHECK(planes[0] == axisPlanes()[0]);
  CHECK(planes[1].normal == Vec3(0, -1, 0));
}

TEST_CASE("grouping/plane_sets: a bad file is refused with file, line and reason") {
  const TempFolder folder;
  std::string many;
  for (std::size_t i = 0; i <= kMaxFilePlanes; ++i) many += "1 0 0\n";
  const std::vector<std::array<std::string, 2>> bad = {{"", "planes.txt: has no normals"},
                                                       {"# nothing\n", "planes.txt: has no normals"},
                                                       {"1 0 0\n1 0", "planes.txt:2: "},
                                                       {"1 0 0 0", "planes.txt:1: "},
                                                       {"0 0 0", "no direction"},
                                                       {"nan 0 1", "no direction"},
                                                       {"1e300 0 0", "no direction"},
                                                       {"\n1 x 0", "planes.txt:2: "},
                                                       {many, "planes.txt:256: more than "},
                                                       {std::string("1 0 \0", 5), "planes.txt:1: "}};
  for (const auto& [text, reason] : bad) {
    CAPTURE(reason);
    folder.write("planes.txt", text);
    CHECK_THROWS_WITH_AS(loadPlanes(folder.file("planes.txt")), doctest::Contains(reason.c_str()), Error);
  }
  CHECK_THROWS_AS(loadPlanes(folder.file("none.txt")), Error);
}

TEST_CASE("grouping/vertex_groups: the snapped mesh differs in positions only") {
  std::mt19937 rng(0x60);
  mesh::Mesh mesh = lumpyBall(rng, 8, 10);
  mesh.texcoords.assign(mesh.vertexCount(), Vec2(0.5F));
  PlanarOptions options;
  options.epsilon = 0.05;
  const VertexGroups groups = groupPlanar(mesh, options);
  const mesh::Mesh snapped = snappedMesh(mesh, groups);
  CHECK(snapped.positions == groups.positions);
  CHECK(snapped.positions != mesh.positions);
  CHECK(snapped.triangles == mesh.triangles);
  CHECK(snapped.texcoords == mesh.texcoords);
}

TEST_CASE("grouping/vertex_groups: every broken promise is found") {
  std::mt19937 rng(0x61);
  const VertexGroups good = groupPlanar(lumpyBall(rng, 8, 10), {});
  REQUIRE(findInconsistency(good) == "");
  REQUIRE(good.groups.size() > 1);
  const std::uint32_t member = good.members[0], origin = good.groups[0].origin;
  const auto reasonAfter = [&](const auto& damage) {
    VertexGroups bad = good;
    damage(bad);
    return findInconsistency(bad);
  };
  CHECK(reasonAfter([](VertexGroups& g) { g.s.pop_back(); }) != "");
  CHECK(reasonAfter([](VertexGroups& g) { g.owner.pop_back(); }) != "");
  CHECK(reasonAfter([&](VertexGroups& g) { g.owner[member] = 1; }) != "");
  CHECK(reasonAfter([&](VertexGroups& g) { g.state[member] = VertexState::kFree; }) != "");
  CHECK(reasonAfter([&](VertexGroups& g) { g.state[origin] = VertexState::kFree; }) != "");
  CHECK(reasonAfter([&](VertexGroups& g) { g.positions[member].x += 1.0F; }) != "");
  CHECK(reasonAfter([](VertexGroups& g) { g.s[0] = std::numeric_limits<float>::quiet_NaN(); }) != "");
  CHECK(reasonAfter([](VertexGroups& g) { g.groups[0].s_max = -1.0F; }) != "");
  CHECK(reasonAfter([](VertexGroups& g) { g.groups[0].plane = 9; }) != "");
  CHECK(reasonAfter([](VertexGroups& g) { g.groups[0].member_count = 0xFFFFFFFFU; }) != "");
  CHECK(reasonAfter([](VertexGroups& g) { g.groups.pop_back(); }) != "");
  CHECK(reasonAfter([](VertexGroups& g) { g.members[0] = 1000; }) != "");
  CHECK(reasonAfter([](VertexGroups& g) { g.groups[0].kind = GroupKind::kLine; }) != "");
  CHECK(reasonAfter([](VertexGroups& g) { ++g.stats.free; }) != "");
  CHECK(reasonAfter([](VertexGroups& g) { g.epsilon = -1.0; }) != "");
}

}  // namespace sheaf::grouping
