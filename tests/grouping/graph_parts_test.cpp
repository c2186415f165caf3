#include "grouping/graph_parts.h"

#include <doctest/doctest.h>

#include <numeric>
#include <set>

#include "tests/grouping/assorted_meshes.h"
#include "tests/grouping/shapes.h"

namespace sheaf::grouping {
namespace {

DualGraph graphOf(const mesh::Mesh& mesh) {
  return buildDualGraph(mesh, modelFrameOf(mesh));
}

}  // namespace

TEST_CASE("grouping/graph_parts: every cluster stands in one part; all but the last are full") {
  for (const auto& [name, mesh] : assortedMeshes())
    for (const std::size_t size : {std::size_t{1}, std::size_t{7}, std::size_t{1000}}) {
      CAPTURE(name);
      CAPTURE(size);
      const GraphParts parts = cutIntoParts(graphOf(mesh), size);
      std::vector<std::uint32_t> sorted = parts.order, all(mesh.triangleCount());
      std::iota(all.begin(), all.end(), 0U);
      std::ranges::sort(sorted);
      CHECK(sorted == all);
      std::size_t count = 0;
      for (std::size_t p = 0; p < parts.count(); ++p) {
        count += parts.clustersOf(p).size();
        if (p + 1 < parts.count()) CHECK(parts.clustersOf(p).size() == size);
        for (const std::uint32_t c : parts.clustersOf(p)) CHECK(parts.position[c] / size == p);
      }
      CHECK(count == mesh.triangleCount());
    }
}

TEST_CASE("grouping/graph_parts: parts are compact") {
  const mesh::Mesh mesh = mesh::makeGrid(64);
  const DualGraph graph = graphOf(mesh);
  constexpr std::size_t kSize = 512;
  const GraphParts parts = cutIntoParts(graph, kSize);
  const auto is_between = [&](const DualEdge& e) {
    return parts.position[e.face[0]] / kSize != parts.position[e.face[1]] / kSize;
  };
  // If the 16 parts were squares, the lines between them would have 2 * 3 * 64 edges.
  const auto between = std::ranges::count_if(graph.edges, is_between);
  CHECK(between > 0);
  CHECK(between < 2 * (2 * 3 * 64));
}

TEST_CASE("grouping/graph_parts: a part has the edges of its clusters, and their other ends as its halo") {
  std::mt19937 rng(0x9a27);
  const mesh::Mesh mesh = lumpyBall(rng, 12, 16, 0.02F);
  const DualGraph graph = graphOf(mesh);
  const GraphParts parts = cutIntoParts(graph, 50);
  using Link = std::tuple<std::uint32_t, std::uint32_t, double>;
  for (std::size_t p = 0; p < parts.count(); ++p) {
    const PartGraph part = partGraph(graph, parts, p);
    const std::set<std::uint32_t> own(part.clusters.begin(), part.clusters.begin() + part.own);
    CHECK(std::ranges::equal(std::span(part.clusters).first(part.own), parts.clustersOf(p)));
    std::set<Link> expected, found;
    const auto link = [](std::uint32_t a, std::uint32_t b, double length) {
      return Link{std::min(a, b), std::max(a, b), length};
    };
    for (const DualEdge& e : graph.edges)
      if (own.contains(e.face[0]) || own.contains(e.face[1])) expected.insert(link(e.face[0], e.face[1], e.length));
    for (const DualEdge& e : part.graph.edges) {
      CHECK(e.face[0] < part.own);
      found.insert(link(part.clusters[e.face[0]], part.clusters[e.face[1]], e.length));
    }
    CHECK(found == expected);
    CHECK(part.graph.edges.size() == expected.size());
  }
}

}  // namespace sheaf::grouping
