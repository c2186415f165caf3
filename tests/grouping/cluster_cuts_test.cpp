#include "grouping/cluster_cuts.h"

#include <doctest/doctest.h>

#include "tests/grouping/cluster_checks.h"
#include "tests/grouping/shapes.h"
#include "tests/mesh/meshes.h"

namespace sheaf::grouping {
namespace {

struct Fixture {
  mesh::Mesh mesh;
  FaceClusters clusters;
};

Fixture makeFixture(const CostWeights& weights = {}) {
  std::mt19937 rng(0xc075);
  Fixture f;
  f.mesh = lumpyBall(rng, 30, 40, 0.01F);
  const mesh::Mesh other = hills(rng, 12);
  const auto first = static_cast<std::uint32_t>(f.mesh.positions.size());
  for (const Vec3& p : other.positions) f.mesh.positions.push_back(p + Vec3(3.0F));
  for (const mesh::Triangle& t : other.triangles)
    f.mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  TaskPool pool(1);
  f.clusters = clusterFaces(f.mesh, {weights, 8}, pool);
  return f;
}

// The clusters' runs follow each other without gap.
void checkPartition(const FaceClusters& clusters, const ClusterCut& cut) {
  std::uint32_t next = 0;
  for (const std::uint32_t node : cut) {
    CHECK(clusters.first_face[node] == next);
    next += clusters.faceCountOf(node);
  }
  CHECK(next == clusters.faceCount());
}

// Nothing that could be joined again would satisfy.
template <typename Satisfies>
void checkLargest(const FaceClusters& clusters, const ClusterCut& cut, const Satisfies& satisfies) {
  for (const std::uint32_t node : cut) {
    if (!clusters.isFace(node)) CHECK(satisfies(node));
    if (clusters.parent[node] != kNoIndex) CHECK(!satisfies(clusters.parent[node]));
  }
}

}  // namespace

TEST_CASE("grouping/cluster_cuts: by count gives that many clusters, as far as faces and roots allow") {
  const auto [mesh, clusters] = makeFixture();
  for (const std::uint32_t count : {0U, 1U, 2U, 3U, 17U, 500U, 1000000U}) {
    CAPTURE(count);
    const ClusterCut cut = cutByCount(clusters, count);
    checkPartition(clusters, cut);
    CHECK(cut.size() == std::clamp(count, 2U, clusters.faceCount()));
  }
  // A cut into more clusters divides those of a cut into fewer, the last merges first.
  const ClusterCut coarse = cutByCount(clusters, 50), fine = cutByCount(clusters, 51);
  CHECK(std::ranges::count_if(coarse, [&](std::uint32_t n) { return std::ranges::find(fine, n) == fine.end(); }) == 1);
}

TEST_CASE("grouping/cluster_cuts: by cost takes the largest clusters without a dearer merge") {
  const auto [mesh, clusters] = makeFixture();
  for (const double cost : {-2.0, 0.0, 0.4, 0.8, 100.0}) {
    const ClusterCut cut = cutByCost(clusters, cost);
    checkPartition(clusters, cut);
    const auto worst = [&](std::uint32_t top) {
      double most = -100.0;
      std::vector<std::uint32_t> open{top};
      while (!open.empty()) {
        const std::uint32_t node = open.back();
        open.pop_back();
        if (clusters.isFace(node)) continue;
        most = std::max(most, double{clusters.cost[node - clusters.faceCount()]});
        for (const std::uint32_t child : clusters.childrenOf(node)) open.push_back(child);
      }
      return most;
    };
    checkLargest(clusters, cut, [&](std::uint32_t node) { return worst(node) <= cost; });
  }
  CHECK(cutByCost(clusters, 100.0) == cutByCount(clusters, 1));
  CHECK(cutByCost(clusters, -2.0).size() == clusters.faceCount());
}

TEST_CASE("grouping/cluster_cuts: by planarity takes the largest clusters near their planes") {
  const auto [mesh, clusters] = makeFixture();
  const double extent = mesh::boundsOf(mesh).longestEdge();
  std::size_t before = clusters.faceCount() + 1;
  for (const double tolerance : {0.0, 0.001, 0.005, 0.02, 1.0}) {
    for (const Planarity measure : {Planarity::kMax, Planarity::kRms}) {
      const ClusterCut cut = cutByPlanarity(mesh, clusters, measure, tolerance);
      checkPartition(clusters, cut);
      checkLargest(clusters, cut, [&, &c = clusters, &m = mesh](std::uint32_t node) {
        if (c.faceCountOf(node) > 512 && c.storedShape(node) == nullptr) return false;
        const ClusterShape shape = shapeOf(m, c, node);
        return (measure == Planarity::kMax ? shape.maxDistance() : shape.rms_distance) <= tolerance * extent;
      });
      if (measure == Planarity::kMax) {
        CHECK(cut.size() < before);
        before = cut.size();
      }
    }
  }
  CHECK(before == 2);
}

TEST_CASE("grouping/cluster_cuts: by size keeps to both limits") {
  const auto [mesh, clusters] = makeFixture();
  const auto vertices = [&m = mesh, &c = clusters](std::uint32_t node) {
    std::set<std::uint32_t> used;
    for (const std::uint32_t f : c.facesOf(node)) used.insert(m.triangles[f].begin(), m.triangles[f].end());
    return used.size();
  };
  for (const SizeLimits& limits : {SizeLimits{1, 3}, {2, 3}, {100, 40}, {512, 256}, {20, 1000}, SizeLimits{}}) {
    const ClusterCut cut = cutBySize(mesh, clusters, limits);
    checkPartition(clusters, cut);
    checkLargest(clusters, cut, [&, &c = clusters](std::uint32_t node) {
      return c.faceCountOf(node) <= limits.max_faces && vertices(node) <= limits.max_vertices;
    });
  }
}

TEST_CASE("grouping/cluster_cuts: balanced clusters fill a size limit, chains do not") {
  const std::size_t balanced = cutBySize(makeFixture().mesh, makeFixture().clusters, {128, 256}).size();
  const Fixture chains = makeFixture({1.0, 1.0, 1.0, 0.0});
  CHECK(3 * balanced < cutBySize(chains.mesh, chains.clusters, {128, 256}).size() * 2);
  CHECK(balanced * 128 < 3 * chains.clusters.faceCount());
}

TEST_CASE("grouping/cluster_cuts: figures of a cut are those of its clusters one by one") {
  const auto [mesh, clusters] = makeFixture();
  for (const std::uint32_t count : {2U, 30U, 700U, 100000U}) {
    CAPTURE(count);
    const ClusterCut cut = cutByCount(clusters, count);
    const CutFigures figures = figuresOf(mesh, clusters, cut);
    const std::vector<std::uint32_t> cluster_of_face = clusterOfFace(clusters, cut);
    std::vector<std::uint32_t> sizes(cut.size(), 0);
    for (const std::uint32_t c : cluster_of_face) ++sizes.at(c);
    double max_distance = 0.0, squares = 0.0;
    for (std::uint32_t c = 0; c < cut.size(); ++c) {
      CHECK(sizes[c] == clusters.faceCountOf(cut[c]));
      CHECK(cluster_of_face[clusters.facesOf(cut[c]).front()] == c);
      const ClusterShape shape = shapeOfFaces(mesh, clusters.facesOf(cut[c]));
      max_distance = std::max(max_distance, double{shape.maxDistance()});
      squares += std::pow(shape.rms_distance, 2) * sizes[c];
    }
    std::ranges::sort(sizes);
    CHECK(figures.clusters == cut.size());
    CHECK(figures.least_faces == sizes.front());
    CHECK(figures.median_faces == sizes[sizes.size() / 2]);
    CHECK(figures.most_faces == sizes.back());
    CHECK(figures.max_distance == doctest::Approx(max_distance).epsilon(1e-5));
    CHECK(figures.rms_distance == doctest::Approx(std::sqrt(squares / clusters.faceCount())).epsilon(1e-5));
    // No merge within costs more, and one costs as much.
    if (cut.size() == clusters.faceCount()) {
      CHECK(figures.max_cost == 0.0);
    } else {
      CHECK(cutByCost(clusters, figures.max_cost).size() <= cut.size());
      CHECK(cutByCost(clusters, std::nextafter(figures.max_cost, -10.0)) != cut);
    }
  }
}

TEST_CASE("grouping/cluster_cuts: of nothing there is nothing") {
  const FaceClusters none;
  CHECK(figuresOf({}, none, {}).clusters == 0);
  CHECK(cutByCount(none, 5).empty());
  CHECK(cutByCost(none, 1.0).empty());
  CHECK(cutByPlanarity({}, none, Planarity::kMax, 1.0).empty());
  CHECK(cutBySize({}, none, {}).empty());
}

}  // namespace sheaf::grouping
