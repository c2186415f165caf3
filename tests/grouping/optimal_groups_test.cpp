#include "grouping/optimal_groups.h"

#include <doctest/doctest.h>

#include <bit>

#include "core/error.h"
#include "grouping/dominating_set.h"
#include "tests/grouping/shapes.h"

namespace sheaf::grouping {
namespace {

const auto kGoOn = [](std::uint64_t) { return true; };

bool dominates(const BitGraph& graph, const VertexSet& set) {
  for (std::uint32_t v = 0; v < graph.vertexCount(); ++v) {
    bool covered = false;
    for (const std::uint32_t u : set) covered = covered || graph.joins(u, v);
    if (!covered) return false;
  }
  return true;
}

BitGraph randomGraph(std::mt19937& rng, std::uint32_t vertices, std::uint32_t edges) {
  BitGraph graph(vertices);
  std::uniform_int_distribution<std::uint32_t> pick(0, vertices - 1);
  for (std::uint32_t e = 0; e < edges; ++e) {
    const std::uint32_t a = pick(rng), b = pick(rng);
    graph.join(a, b);
  }
  return graph;
}

// Every subset in turn.
std::uint32_t smallestByTrial(const BitGraph& graph) {
  std::uint32_t smallest = graph.vertexCount();
  for (std::uint32_t bits = 0; bits < 1U << graph.vertexCount(); ++bits) {
    const auto size = static_cast<std::uint32_t>(std::popcount(bits));
    if (size >= smallest) continue;
    VertexSet set;
    for (std::uint32_t v = 0; v < graph.vertexCount(); ++v)
      if ((bits >> v & 1U) != 0) set.push_back(v);
    if (dominates(graph, set)) smallest = size;
  }
  return smallest;
}

VertexSet allOf(const BitGraph& graph) {
  VertexSet all;
  for (std::uint32_t v = 0; v < graph.vertexCount(); ++v) all.push_back(v);
  return all;
}

}  // namespace

TEST_CASE("grouping/optimal_groups: branch and bound finds the smallest dominating set") {
  std::mt19937 rng(0xd011);
  for (int i = 0; i < 60; ++i) {
    CAPTURE(i);
    const BitGraph graph = randomGraph(rng, 12, static_cast<std::uint32_t>(i) / 2);
    const ProvenSet proven = proveDominatingSet(graph, allOf(graph), 1000000, kGoOn);
    CHECK(dominates(graph, proven.best));
    CHECK(proven.best.size() == smallestByTrial(graph));
    CHECK(proven.at_least == proven.best.size());
  }
}

TEST_CASE("grouping/optimal_groups: the local search keeps a dominating set and makes it small") {
  std::mt19937 rng(0xd012);
  for (int i = 0; i < 20; ++i) {
    CAPTURE(i);
    const BitGraph graph = randomGraph(rng, 14, 20);
    const VertexSet small = shrinkDominatingSet(graph, allOf(graph), 2000, kGoOn);
    CHECK(dominates(graph, small));
    CHECK(small.size() == smallestByTrial(graph));
  }
  const BitGraph star = [] {
    BitGraph graph(100);
    for (std::uint32_t v = 1; v < 100; ++v) graph.join(0, v);
    return graph;
  }();
  CHECK(shrinkDominatingSet(star, allOf(star), 1000, kGoOn) == VertexSet{0});
}

TEST_CASE("grouping/optimal_groups: a limit on nodes leaves a true lower bound") {
  std::mt19937 rng(0xd013);
  const BitGraph graph = randomGraph(rng, 15, 22);
  const std::uint32_t smallest = smallestByTrial(graph);
  for (const std::uint64_t nodes : {0U, 1U, 5U, 20U}) {
    const ProvenSet proven = proveDominatingSet(graph, allOf(graph), nodes, kGoOn);
    CHECK(dominates(graph, proven.best));
    CHECK(proven.at_least <= smallest);
  }
}

TEST_CASE("grouping/optimal_groups: the result is a grouping that is at least as good as the greedy ones") {
  std::mt19937 rng(0xd014);
  for (const mesh::Mesh& mesh : {randomPoints(rng, 60), lumpyBall(rng, 7, 10, 0.02F), latticePoints(rng, 50, 4)}) {
    OptimalOptions options;
    options.epsilon = 0.03;
    options.search_steps = 5000;
    const OptimalGroups result = groupOptimally(mesh, options);
    CHECK(findInconsistency(result.groups) == "");
    CHECK(result.groups.stats.free + result.groups.stats.defining == result.best);
    CHECK(result.best <= result.dynamic);
    CHECK(result.best <= result.greedy);
    CHECK(result.at_least <= result.best);
    CHECK(result.isOptimal());
    CHECK(result.groups.stats.displacement_max <= 0.03 + 1e-6);
  }
}

TEST_CASE("grouping/optimal_groups: one vertex, none, and too many") {
  mesh::Mesh mesh;
  CHECK(groupOptimally(mesh, {}).best == 0);
  mesh.positions.push_back({1.0F, 1.0F, 1.0F});
  CHECK(groupOptimally(mesh, {}).best == 1);
  mesh.positions.assign(5, {1.0F, 1.0F, 1.0F});
  CHECK(groupOptimally(mesh, {}).best == 1);
  mesh.positions.assign(kMaxOptimalVertices + 1, {1.0F, 1.0F, 1.0F});
  CHECK_THROWS_AS(groupOptimally(mesh, {}), Error);
}

TEST_CASE("grouping/optimal_groups: stopping leaves a valid grouping") {
  std::mt19937 rng(0xd015);
  OptimalOptions options;
  options.progress = [](double) { return false; };
  const OptimalGroups result = groupOptimally(randomPoints(rng, 150), options);
  CHECK(result.groups.interrupted);
  CHECK(findInconsistency(result.groups) == "");
  CHECK(result.at_least <= result.best);
}

}  // namespace sheaf::grouping
