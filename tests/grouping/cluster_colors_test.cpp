#include "grouping/cluster_colors.h"

#include <doctest/doctest.h>

#include "tests/grouping/cluster_checks.h"
#include "tests/grouping/shapes.h"
#include "tests/mesh/meshes.h"

namespace sheaf::grouping {
namespace {

// Edges of the mesh whose faces are in different clusters of the same colour.
std::size_t confusedEdges(const mesh::Mesh& mesh, const FaceClusters& clusters, const ClusterCut& cut,
                          const std::vector<std::uint32_t>& colors) {
  const std::vector<std::uint32_t> cluster_of_face = clusterOfFace(clusters, cut);
  std::size_t count = 0;
  for (const auto& [edge, faces] : facesOfEdges(mesh))
    for (const std::uint32_t f : faces) {
      const std::uint32_t a = cluster_of_face[f], b = cluster_of_face[faces.front()];
      count += a != b && colors[a] == colors[b];
    }
  return count;
}

FaceClusters clustersOf(const mesh::Mesh& mesh) {
  TaskPool pool(1);
  return clusterFaces(mesh, {}, pool);
}

}  // namespace

TEST_CASE("grouping/cluster_colors: six colours keep neighbours apart on any surface without handles") {
  std::mt19937 rng(0xc0105);
  for (const mesh::Mesh& mesh : {lumpyBall(rng, 20, 30, 0.02F), hills(rng, 25)}) {
    const FaceClusters clusters = clustersOf(mesh);
    for (const std::uint32_t count : {1U, 2U, 7U, 64U, 400U, 100000U}) {
      CAPTURE(count);
      const ClusterCut cut = cutByCount(clusters, count);
      const std::vector<std::uint32_t> colors = colorClusters(mesh, clusters, cut, 6);
      REQUIRE(colors.size() == cut.size());
      for (const std::uint32_t c : colors) CHECK(c < 6);
      CHECK(confusedEdges(mesh, clusters, cut, colors) == 0);
    }
  }
}

TEST_CASE("grouping/cluster_colors: colours are used evenly, so that a picture shows all of them") {
  std::mt19937 rng(0xc0106);
  const mesh::Mesh mesh = lumpyBall(rng, 30, 40, 0.02F);
  const FaceClusters clusters = clustersOf(mesh);
  std::vector<int> used(8, 0);
  for (const std::uint32_t c : colorClusters(mesh, clusters, cutByCount(clusters, 160), 8)) ++used[c];
  for (const int n : used) CHECK(n >= 10);
}

TEST_CASE("grouping/cluster_colors: faces in no part are nobody's neighbours") {
  const mesh::Mesh grid = mesh::makeGrid(6);
  std::vector<std::uint32_t> part(grid.triangleCount());
  for (std::uint32_t f = 0; f < part.size(); ++f) part[f] = f / 12 % 2 == 0 ? f / 24 : kNoIndex;  // every other row
  CHECK(colorParts(grid, part, 3, 1) == std::vector<std::uint32_t>(3, 0));
  for (std::uint32_t f = 0; f < part.size(); ++f) part[f] = f / 12;
  const std::vector<std::uint32_t> rows = colorParts(grid, part, 6, 2);
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) CHECK(rows[i] != rows[i + 1]);
}

TEST_CASE("grouping/cluster_colors: too few colours, faces without neighbours and no faces are no trouble") {
  std::mt19937 rng(0xc0107);
  const mesh::Mesh ball = lumpyBall(rng, 6, 8);
  const FaceClusters clusters = clustersOf(ball);
  const ClusterCut cut = cutByCount(clusters, 20);
  CHECK(colorClusters(ball, clusters, cut, 1) == std::vector<std::uint32_t>(20, 0));
  const mesh::Mesh soup = triangleSoup(rng, 30, 60);
  const FaceClusters torn = clustersOf(soup);
  CHECK(colorClusters(soup, torn, cutByCount(torn, 60), 8).size() == 60);
  CHECK(colorClusters({}, clustersOf({}), {}, 8).empty());
}

}  // namespace sheaf::grouping
