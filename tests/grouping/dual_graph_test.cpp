#include "grouping/dual_graph.h"

#include <doctest/doctest.h>

#include <limits>

#include "tests/grouping/cluster_checks.h"
#include "tests/grouping/shapes.h"
#include "tests/mesh/meshes.h"

namespace sheaf::grouping {
namespace {

// The dual edges as pairs of faces with their lengths; checks that each stands in both lists and in no other.
std::map<Edge, double> linksOf(const DualGraph& graph) {
  std::map<Edge, double> links;
  for (const DualEdge& e : graph.edges) {
    const Edge pair = std::minmax(e.face[0], e.face[1]);
    CHECK(pair.first != pair.second);
    CHECK(!links.contains(pair));
    links[pair] = e.length;
  }
  std::size_t listed = 0;
  for (std::uint32_t f = 0; f < graph.first.size(); ++f)
    for (std::uint32_t id = graph.first[f]; id != kNoIndex; id = graph.edges[id].next[graph.edges[id].sideOf(f)]) {
      CHECK((graph.edges[id].face[0] == f || graph.edges[id].face[1] == f));
      ++listed;
    }
  CHECK(listed == 2 * graph.edges.size());
  return links;
}

DualGraph plainGraph(const mesh::Mesh& mesh) {
  return buildDualGraph(mesh, ModelFrame{});
}

// `count` triangles around the edge from the origin to (0, 0, 2), at the given angles.
mesh::Mesh pages(const std::vector<double>& angles) {
  mesh::Mesh mesh;
  mesh.positions = {{0.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 2.0F}};
  for (const double a : angles) {
    mesh.positions.emplace_back(std::cos(a), std::sin(a), 0.5);
    mesh.triangles.push_back({0, 1, static_cast<std::uint32_t>(mesh.positions.size() - 1)});
  }
  return mesh;
}

}  // namespace

TEST_CASE("grouping/dual_graph: faces with common edges are linked once, by the length of all of them") {
  mesh::Mesh mesh;
  mesh.positions = {{0.0F, 0.0F, 0.0F}, {3.0F, 0.0F, 0.0F}, {3.0F, 4.0F, 0.0F}, {0.0F, 4.0F, 0.0F}};
  SUBCASE("one") {
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    CHECK(linksOf(plainGraph(mesh)) == std::map<Edge, double>{{{0, 1}, 5.0}});
  }
  SUBCASE("two: a face folded over the border of another") {
    mesh.triangles = {{0, 1, 2}, {2, 1, 0}};
    CHECK(linksOf(plainGraph(mesh)) == std::map<Edge, double>{{{0, 1}, 12.0}});
  }
  SUBCASE("none") {
    mesh.triangles = {{0, 1, 2}};
    CHECK(linksOf(plainGraph(mesh)).empty());
  }
}

TEST_CASE("grouping/dual_graph: an edge of three to eight faces links them in a circle, by angle, with length 0") {
  for (const std::uint32_t count : {3U, 5U, 8U}) {
    CAPTURE(count);
    std::vector<double> angles;
    for (std::uint32_t i = 0; i < count; ++i)
      angles.push_back(0.3 + 2.0 * kPi * ((3 * i) % (count == 3 ? 4 : count)) / 9.0);
    const auto links = linksOf(plainGraph(pages(angles)));
    CHECK(links.size() == count);
    std::vector<std::uint32_t> order(count);
    for (std::uint32_t i = 0; i < count; ++i) order[i] = i;
    std::ranges::sort(order, {}, [&](std::uint32_t i) { return angles[i]; });
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto found = links.find(std::minmax(order[i], order[(i + 1) % count]));
      REQUIRE(found != links.end());
      CHECK(found->second == 0.0);
    }
  }
}

TEST_CASE("grouping/dual_graph: an edge of more than eight faces links them in a row") {
  const auto links = linksOf(plainGraph(pages(std::vector<double>(9, 1.0))));
  CHECK(links.size() == 8);
  for (std::uint32_t f = 0; f < 8; ++f) CHECK(links.contains({f, f + 1}));
}

TEST_CASE("grouping/dual_graph: links of random meshes are those found by looking at every edge") {
  std::mt19937 rng(0xd0a1);
  const std::vector<mesh::Mesh> meshes = {lumpyBall(rng, 9, 12, 0.02F), hills(rng, 9), triangleSoup(rng, 60, 80),
                                          triangleSoup(rng, 12, 100), mesh::makeGrid(6)};
  for (const mesh::Mesh& mesh : meshes) {
    const auto links = linksOf(plainGraph(mesh));
    std::map<Edge, double> expected;
    std::size_t allowed = 0;
    for (const auto& [edge, faces] : facesOfEdges(mesh)) {
      allowed += faces.size() > 2 ? faces.size() : faces.size() - 1;
      if (faces.size() == 2)
        expected[{faces[0], faces[1]}] +=
            glm::distance(DVec3(mesh.positions[edge.first]), DVec3(mesh.positions[edge.second]));
    }
    for (const auto& [pair, length] : expected) {
      const auto found = links.find(pair);
      REQUIRE(found != links.end());
      CHECK(found->second == doctest::Approx(length));
    }
    CHECK(links.size() >= expected.size());
    CHECK(links.size() <= allowed);
  }
}

TEST_CASE("grouping/dual_graph: degenerate and unusable faces") {
  mesh::Mesh mesh;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  mesh.positions = {{0.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}, {nan, 0.0F, 0.0F}};
  SUBCASE("a corner twice: the one edge that is left counts once") {
    for (const mesh::Triangle& t : {mesh::Triangle{0, 0, 1}, {0, 1, 1}, {0, 1, 0}}) {
      CHECK(edgesOf(t).count == 1);
      mesh.triangles = {{0, 1, 2}, t};
      CHECK(linksOf(plainGraph(mesh)) == std::map<Edge, double>{{{0, 1}, 1.0}});
    }
  }
  SUBCASE("all corners the same") {
    CHECK(edgesOf({1, 1, 1}).count == 0);
    mesh.triangles = {{0, 1, 2}, {1, 1, 1}};
    CHECK(plainGraph(mesh).edges.empty());
  }
  SUBCASE("a corner that is not finite") {
    mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
    CHECK(plainGraph(mesh).edges.empty());
  }
  SUBCASE("no faces, no vertices") {
    CHECK(plainGraph({}).edges.empty());
    CHECK(plainGraph(mesh).edges.empty());
  }
}

TEST_CASE(
    "grouping/dual_graph: faces that turn the other way than their neighbours are found, the lesser part of each "
    "piece") {
  std::mt19937 rng(0x70a1);
  mesh::Mesh mesh = lumpyBall(rng, 9, 12);
  CHECK(findTurnedFaces(plainGraph(mesh)).empty());
  const mesh::Mesh second = hills(rng, 5);
  const auto first_vertex = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), second.positions.begin(), second.positions.end());
  for (const mesh::Triangle& t : second.triangles)
    mesh.triangles.push_back({t[0] + first_vertex, t[1] + first_vertex, t[2] + first_vertex});
  std::vector<bool> expected(mesh.triangleCount(), false);
  for (std::uint32_t f = 0; f < mesh.triangleCount(); ++f)
    if (rng() % 4 == 0) {
      std::swap(mesh.triangles[f][0], mesh.triangles[f][1]);
      expected[f] = true;
    }
  CHECK(findTurnedFaces(plainGraph(mesh)) == expected);
}

TEST_CASE("grouping/dual_graph: a Moebius strip cannot agree, and does no harm") {
  mesh::Mesh mesh;
  constexpr std::uint32_t kSteps = 12;
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    const double u = 2.0 * kPi * i / kSteps;
    for (const double v : {-0.3, 0.3})
      mesh.positions.emplace_back((1.0 + v * std::cos(u / 2.0)) * std::cos(u),
                                  (1.0 + v * std::cos(u / 2.0)) * std::sin(u), v * std::sin(u / 2.0));
  }
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    const bool last = i + 1 == kSteps;
    const std::uint32_t a = 2 * i, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({b, c, d});
  }
  const DualGraph graph = plainGraph(mesh);
  CHECK(graph.edges.size() == 2 * kSteps);
  CHECK(findTurnedFaces(graph).size() == mesh.triangleCount());
}

TEST_CASE("grouping/dual_graph: the model frame has the area centroid in 0 and the farthest vertex at 1/2") {
  std::mt19937 rng(0xf4a3);
  mesh::Mesh mesh = lumpyBall(rng, 9, 12, 0.02F);
  mesh.positions.push_back(Vec3(1000.0F));  // unused
  const Vec3 offset(1e6F, -2e6F, 3e6F);
  for (const float scale : {1.0F, 1e-20F, 1e15F}) {
    mesh::Mesh scaled = mesh;
    for (Vec3& p : scaled.positions) p = scale * p + (scale == 1.0F ? offset : Vec3(0.0F));
    const ModelFrame frame = modelFrameOf(scaled);
    DVec3 weighted(0.0);
    double area = 0.0, farthest = 0.0;
    for (const mesh::Triangle& t : scaled.triangles) {
      const DVec3 a = frame(scaled.positions[t[0]]), b = frame(scaled.positions[t[1]]),
                  c = frame(scaled.positions[t[2]]);
      const double w = glm::length(glm::cross(b - a, c - a));
      weighted += w * (a + b + c) / 3.0;
      area += w;
      farthest = std::max({farthest, glm::length(a), glm::length(b), glm::length(c)});
    }
    CHECK(glm::length(weighted / area) < 1e-9);
    CHECK(farthest == doctest::Approx(0.5));
  }
}

}  // namespace sheaf::grouping
