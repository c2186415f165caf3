#include "grouping/face_contraction.h"

#include <doctest/doctest.h>

#include <numeric>
#include <string_view>

#include "grouping/face_clusters.h"
#include "tests/grouping/assorted_meshes.h"
#include "tests/grouping/cluster_checks.h"
#include "tests/grouping/shapes.h"

namespace sheaf::grouping {
namespace {

// Contracts parts as long as that joins anything.
ContractionPlan inPartsOf(std::uint32_t faces) {
  return {0, faces};
}

FaceClusters contracted(const mesh::Mesh& mesh, const ContractionPlan& plan, int threads = 2) {
  TaskPool pool(threads);
  const ModelFrame frame = modelFrameOf(mesh);
  DualGraph graph = buildDualGraph(mesh, frame);
  const std::vector<bool> turned = findTurnedFaces(graph);
  MergeTree tree = contractFaces(mesh, frame, std::move(graph), turned, {}, pool, plan);
  return hierarchyOf(static_cast<std::uint32_t>(mesh.triangleCount()), std::move(tree.children), std::move(tree.cost));
}

}  // namespace

TEST_CASE("grouping/face_contraction: in parts, a mesh has a hierarchy as good and in the order of costs") {
  std::mt19937 rng(0x4e61);
  const mesh::Mesh mesh = lumpyBall(rng, 60, 80, 0.003F);
  const auto sum = [](const FaceClusters& c) { return std::accumulate(c.cost.begin(), c.cost.end(), 0.0); };
  const FaceClusters exact = contracted(mesh, {});
  for (const std::uint32_t part_size : {500U, 1000U, 3000U}) {
    CAPTURE(part_size);
    const FaceClusters clusters = contracted(mesh, inPartsOf(part_size));
    CHECK(findBrokenMerge(clusters.faceCount(), clusters.children) == "");
    CHECK(clusters.roots == exact.roots);
    CHECK(clusters != exact);
    CHECK(std::abs(sum(clusters) - sum(exact)) < 0.002 * double(exact.cost.size()));  // costs reach from -1 to 3
    // A merge that costs less than the one before it is one that the latter has made possible, or one of its parts has.
    std::size_t out_of_order = 0;
    for (std::uint32_t i = 1; i < clusters.cost.size(); ++i) {
      const auto& made_of = clusters.children[i];
      if (clusters.cost[i] < clusters.cost[i - 1] && std::max(made_of[0], made_of[1]) + 1 < clusters.faceCount())
        ++out_of_order;
    }
    CHECK(out_of_order == 0);
  }
}

TEST_CASE("grouping/face_contraction: the number of threads changes nothing") {
  std::mt19937 rng(0x7472);
  const mesh::Mesh mesh = lumpyBall(rng, 40, 50, 0.003F);
  const FaceClusters one = contracted(mesh, inPartsOf(250), 1);
  for (const int threads : {2, 7}) CHECK(contracted(mesh, inPartsOf(250), threads) == one);
}

TEST_CASE("grouping/face_contraction: in parts, every merge joins neighbours and costs what their faces say") {
  for (const auto& [name, mesh] : assortedMeshes()) {
    CAPTURE(name);
    if (std::string_view(name) == "bad faces") continue;  // faces without corners have no plain costs
    const ModelFrame frame = modelFrameOf(mesh);
    const auto around = facesOfEdges(mesh);
    mesh::Mesh turned = mesh;
    const std::vector<bool> turns = findTurnedFaces(buildDualGraph(mesh, frame));
    for (std::uint32_t f = 0; f < turns.size(); ++f)
      if (turns[f]) std::swap(turned.triangles[f][0], turned.triangles[f][1]);
    const FaceClusters clusters = contracted(mesh, inPartsOf(23));
    REQUIRE(findBrokenMerge(clusters.faceCount(), clusters.children) == "");
    CHECK(clusters.roots.size() == contracted(mesh, {}).roots.size());
    for (std::uint32_t i = 0; i < clusters.children.size(); ++i) {
      const Faces a = listOf(clusters.facesOf(clusters.children[i][0])),
                  b = listOf(clusters.facesOf(clusters.children[i][1]));
      std::set<Edge> edges;
      for (const std::uint32_t f : a) edges.merge(plainEdges(mesh.triangles[f]));
      CHECK(std::ranges::any_of(b, [&](std::uint32_t f) {
        return std::ranges::any_of(plainEdges(mesh.triangles[f]), [&](const Edge& e) { return edges.contains(e); });
      }));
      CHECK(clusters.cost[i] == doctest::Approx(plainCost(turned, around, a, b, frame, {})).epsilon(1e-4));
    }
  }
}

TEST_CASE("grouping/face_contraction: pieces of the mesh that lie within parts come out as without parts") {
  std::mt19937 rng(0x9cE5);
  mesh::Mesh mesh;
  constexpr std::uint32_t kBalls = 12;
  for (std::uint32_t i = 0; i < kBalls; ++i)
    append(mesh, lumpyBall(rng, 6, 8, 0.05F), Vec3(3.0F * static_cast<float>(i), 0.0F, 0.0F));
  const auto faces = static_cast<std::uint32_t>(mesh.triangleCount());
  CHECK(clusterSets(contracted(mesh, inPartsOf(faces / kBalls * 2))) == clusterSets(contracted(mesh, {})));
}

TEST_CASE("grouping/face_contraction: parts in which nothing can be joined leave it all to the end") {
  std::mt19937 rng(0x1e57);
  const mesh::Mesh mesh = lumpyBall(rng, 8, 10, 0.05F);
  CHECK(clusterSets(contracted(mesh, inPartsOf(1))) == clusterSets(contracted(mesh, {})));
  CHECK(contracted(mesh::Mesh{}, inPartsOf(1)).faceCount() == 0);
}

}  // namespace sheaf::grouping
