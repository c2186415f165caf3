#include "grouping/compression.h"

#include <doctest/doctest.h>

#include <set>

#include "grouping/groups_file.h"
#include "grouping/linear_groups.h"
#include "grouping/planar_groups.h"
#include "grouping/plane_sets.h"
#include "tests/grouping/shapes.h"

namespace sheaf::grouping {

TEST_CASE("grouping/compression: planar groups need two numbers for a grouped vertex and three for a retained one") {
  std::mt19937 rng(0xc0de);
  const mesh::Mesh mesh = lumpyBall(rng, 60, 80, 0.002F);
  const VertexGroups groups = groupPlanar(mesh, {});
  const CompressionFigures figures = measureCompression(mesh, groups, 14);
  const double n = groups.stats.vertices, grouped = groups.stats.grouped;
  CHECK(figures.plain == 96.0);
  CHECK(figures.plain_quantised == 42.0);
  CHECK(figures.grouped_parameters == doctest::Approx(28.0 * grouped / n));
  CHECK(figures.grouped_retained > 42.0 * (n - grouped) / n);
  CHECK(figures.grouped() < 0.75 * figures.plain_quantised);
  CHECK(figures.coded > 0.0);
  CHECK(figures.coded < 64.0);  // it has a fourth, empty component
  CHECK(figures.grouped_coded > 0.0);
  CHECK(figures.grouped_order >= 8.0 * grouped / n);
}

TEST_CASE("grouping/compression: linear groups need one number for a grouped vertex") {
  std::mt19937 rng(0xc0df);
  const mesh::Mesh mesh = lumpyBall(rng, 16, 20, 0.002F);
  const VertexGroups groups = groupLinear(mesh, {});
  const CompressionFigures figures = measureCompression(mesh, groups, 16);
  CHECK(figures.grouped_parameters == doctest::Approx(16.0 * groups.stats.eliminated));
}

TEST_CASE("grouping/compression: a frame is stored where a group is in it, and only once") {
  std::mt19937 rng(0xc0e1);
  const mesh::Mesh mesh = lumpyBall(rng, 30, 40, 0.002F);
  PlanarOptions options;
  options.planes = dodecahedronPlanes();
  VertexGroups groups = groupPlanar(mesh, options);
  const auto frames = [&] {
    std::set<std::uint32_t> used;
    for (const VertexGroup& g : groups.groups) used.insert(g.plane);
    return used.size();
  };
  REQUIRE(frames() > 1);
  REQUIRE(groups.groups.size() > frames());
  const double before = measureCompression(mesh, groups, 14).grouped_retained;
  groups.planes.resize(groups.planes.size() + 1000, groups.planes.front());
  CHECK(measureCompression(mesh, groups, 14).grouped_retained == before);
  const std::size_t frames_before = frames();
  for (VertexGroup& g : groups.groups) g.plane = groups.groups.front().plane;
  const double saved = 48.0 * static_cast<double>(frames_before - 1) / groups.stats.vertices;
  CHECK(measureCompression(mesh, groups, 14).grouped_retained == doctest::Approx(before - saved));
}

TEST_CASE("grouping/compression: sets without spread, without faces, without vertices") {
  mesh::Mesh mesh;
  CHECK(measureCompression(mesh, groupPlanar(mesh, {}), 12).grouped() == 0.0);
  mesh.positions.assign(40, Vec3(2.0F));
  const CompressionFigures figures = measureCompression(mesh, groupPlanar(mesh, {}), 12);
  CHECK(figures.vertices == 40);
  CHECK(figures.coded > 0.0);
}

TEST_CASE("grouping/compression: the saved form is smaller than the positions that it stands for") {
  std::mt19937 rng(0xc0e0);
  const mesh::Mesh mesh = lumpyBall(rng, 80, 100, 0.002F);
  GroupsFileOptions options;
  options.parameter_bits = 12;
  const std::string bytes = encodeGroups(groupPlanar(mesh, {}), options);
  CHECK(bytes.size() < 12 * mesh.vertexCount() / 2);
}

}  // namespace sheaf::grouping
