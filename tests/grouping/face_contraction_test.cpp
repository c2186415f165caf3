#include "grouping/face_contraction.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

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

mesh::Mesh turnedOver(mesh::Mesh mesh, const std::vector<bool>& turned) {
  for (std::uint32_t f = 0; f < turned.size(); ++f)
    if (turned[f]) std::swap(mesh.triangles[f][0], mesh.triangles[f][1]);
  return mesh;
}

bool shareAnEdge(const mesh::Mesh& mesh, const Faces& a, const Faces& b) {
  std::set<Edge> edges;
  for (const std::uint32_t f : a) edges.merge(plainEdges(mesh.triangles[f]));
  return std::ranges::any_of(b, [&](std::uint32_t f) {
    return std::ranges::any_of(plainEdges(mesh.triangles[f]), [&](const Edge& e) { return edges.contains(e); });
  });
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
    std::vector<float> worst = clusters.cost;                                         // of each merge and all below it
    for (std::uint32_t i = 0; i < clusters.cost.size(); ++i)
      for (const std::uint32_t child : clusters.children[i])
        if (!clusters.isFace(child)) worst[i] = std::max(worst[i], worst[child - clusters.faceCount()]);
    CHECK(std::ranges::is_sorted(worst));
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
    const ModelFrame frame = modelFrameOf(mesh);
    const auto around = facesOfEdges(mesh);
    const mesh::Mesh turned = turnedOver(mesh, findTurnedFaces(buildDualGraph(mesh, frame)));
    const FaceClusters clusters = contracted(mesh, inPartsOf(23));
    REQUIRE(findBrokenMerge(clusters.faceCount(), clusters.children) == "");
    CHECK(clusters.roots.size() == contracted(mesh, {}).roots.size());
    for (std::uint32_t i = 0; i < clusters.children.size(); ++i) {
      const Faces a = listOf(clusters.facesOf(clusters.children[i][0])),
                  b = listOf(clusters.facesOf(clusters.children[i][1]));
      CHECK(shareAnEdge(mesh, a, b));
      const double plain = plainCost(turned, around, a, b, frame, {});
      if (std::isfinite(plain)) CHECK(clusters.cost[i] == doctest::Approx(plain).epsilon(1e-4));  // not without area
    }
  }
}

TEST_CASE("grouping/face_contraction: hubs at the borders of parts") {
  const mesh::Mesh mesh = plateOf(4 * kHubDegree);
  const FaceClusters whole = contracted(mesh, {});
  for (const std::uint32_t part_size : {32U, 100U, 500U}) {
    CAPTURE(part_size);
    const FaceClusters clusters = contracted(mesh, inPartsOf(part_size));
    REQUIRE(findBrokenMerge(clusters.faceCount(), clusters.children) == "");
    CHECK(clusters.roots == whole.roots);
    for (const auto& children : clusters.children)
      CHECK(shareAnEdge(mesh, listOf(clusters.facesOf(children[0])), listOf(clusters.facesOf(children[1]))));
    CHECK(contracted(mesh, inPartsOf(part_size), 5) == clusters);
  }
}

TEST_CASE("grouping/face_contraction: a mesh that is large enough is clustered in parts, whoever asks") {
  std::mt19937 rng(0x1a26);
  const mesh::Mesh mesh = lumpyBall(rng, 100, 110, 0.001F);
  REQUIRE(mesh.triangleCount() > ContractionPlan{}.most_at_once);
  TaskPool one(1), three(3);
  const FaceClusters clusters = clusterFaces(mesh, {}, one);
  CHECK(findInconsistency(clusters) == "");
  CHECK(clusterFaces(mesh, {}, three) == clusters);
  CHECK(clusters.cost != contracted(mesh, {.most_at_once = mesh.triangleCount()}).cost);
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
