#include "grouping/face_clusters.h"

#include <doctest/doctest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numeric>

#include "tests/grouping/assorted_meshes.h"
#include "tests/grouping/cluster_checks.h"
#include "tests/grouping/shapes.h"
#include "tests/mesh/meshes.h"

namespace sheaf::grouping {
namespace {

constexpr CostWeights kPublished{1.0, 1.0, 1.0, 0.0};
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

FaceClusters clustersOf(const mesh::Mesh& mesh, const CostWeights& weights = {}, std::uint32_t min_shape_faces = 8) {
  TaskPool pool(1);
  return clusterFaces(mesh, {weights, min_shape_faces}, pool);
}

// Greedy merging as [HFC] describes it, every cost taken from the faces themselves.
class NaiveClustering {
 public:
  NaiveClustering(const mesh::Mesh& mesh, const CostWeights& weights)
      : mesh_(mesh), weights_(weights), frame_(modelFrameOf(mesh)), around_(facesOfEdges(mesh)) {
    for (std::uint32_t f = 0; f < mesh.triangleCount(); ++f) clusters_.push_back({f});
    const DualGraph graph = buildDualGraph(mesh, frame_);
    const std::vector<bool> turned = findTurnedFaces(graph);
    for (std::uint32_t f = 0; f < turned.size(); ++f)
      if (turned[f]) std::swap(mesh_.triangles[f][0], mesh_.triangles[f][1]);
    for (const DualEdge& e : graph.edges) costs_[std::minmax(e.face[0], e.face[1])] = 0.0;
    for (auto& [pair, cost] : costs_) cost = costOf(pair);
  }

  std::set<Faces> run() {
    std::set<Faces> all(clusters_.begin(), clusters_.end());
    while (!costs_.empty()) {
      const auto cheapest = std::ranges::min_element(costs_, {}, [](const auto& entry) { return entry.second; });
      const auto [a, b] = cheapest->first;
      costs_.erase(cheapest);
      clusters_[a].insert(clusters_[a].end(), clusters_[b].begin(), clusters_[b].end());
      std::ranges::sort(clusters_[a]);
      all.insert(clusters_[a]);
      std::set<Edge> changed;
      for (auto entry = costs_.begin(); entry != costs_.end();) {
        const auto [c, d] = entry->first;
        if (c != a && c != b && d != a && d != b) {
          ++entry;
          continue;
        }
        changed.insert(std::minmax(a, c == a || c == b ? d : c));
        entry = costs_.erase(entry);
      }
      for (const Edge& pair : changed) costs_[pair] = costOf(pair);
    }
    return all;
  }

 private:
  double costOf(const Edge& pair) const {
    return plainCost(mesh_, around_, clusters_[pair.first], clusters_[pair.second], frame_, weights_);
  }

  mesh::Mesh mesh_;
  CostWeights weights_;
  ModelFrame frame_;
  std::map<Edge, Faces> around_;
  std::vector<Faces> clusters_;
  std::map<Edge, double> costs_;
};

}  // namespace

TEST_CASE("grouping/face_clusters: greedy contraction makes the clusters of a brute-force search") {
  std::mt19937 rng(0xb4f0);
  std::vector<mesh::Mesh> meshes = {lumpyBall(rng, 7, 9, 0.06F), hills(rng, 8), hills(rng, 7, 1.0F),
                                    triangleSoup(rng, 40, 70)};
  // Faces without area tie: all of them cost as little as possible.
  std::erase_if(meshes.back().triangles, [](const mesh::Triangle& t) { return edgesOf(t).count < 3; });
  for (const CostWeights& weights :
       {kPublished, CostWeights{}, CostWeights{1.0, 0.0, 0.0, 0.0}, CostWeights{0.0, 1.0, 0.3, 0.0}})
    for (const mesh::Mesh& mesh : meshes) {
      CAPTURE(mesh.triangleCount());
      CAPTURE(weights.shape);
      CHECK(clusterSets(clustersOf(mesh, weights)) == NaiveClustering(mesh, weights).run());
    }
}

TEST_CASE("grouping/face_clusters: the tree is consistent; one root per connected piece") {
  for (const auto& [name, mesh] : assortedMeshes()) {
    CAPTURE(name);
    const FaceClusters clusters = clustersOf(mesh);
    CHECK(findInconsistency(clusters) == "");
    CHECK(clusters.faceCount() == mesh.triangleCount());
    std::vector<std::uint32_t> piece(mesh.triangleCount());
    std::iota(piece.begin(), piece.end(), 0U);
    const auto find = [&](std::uint32_t f) {
      while (piece[f] != f) f = piece[f] = piece[piece[f]];
      return f;
    };
    for (const auto& [edge, faces] : facesOfEdges(mesh))
      for (const std::uint32_t f : faces) piece[find(f)] = find(faces[0]);
    std::size_t pieces = 0;
    for (std::uint32_t f = 0; f < piece.size(); ++f) pieces += find(f) == f ? 1 : 0;
    CHECK(clusters.roots.size() == pieces);
    CHECK(clusters.nodeCount() == 2 * mesh.triangleCount() - pieces);
  }
}

TEST_CASE("grouping/face_clusters: both parts of a cluster share an edge, so that clusters are connected") {
  for (const auto& [name, mesh] : assortedMeshes()) {
    CAPTURE(name);
    const FaceClusters clusters = clustersOf(mesh);
    const auto around = facesOfEdges(mesh);
    for (std::uint32_t node = clusters.faceCount(); node < clusters.nodeCount(); ++node) {
      const auto [left, right] = clusters.childrenOf(node);
      const Faces a = listOf(clusters.facesOf(left)), b = listOf(clusters.facesOf(right));
      CHECK(std::ranges::any_of(around, [&](const auto& entry) {
        const auto in = [&](const Faces& set) {
          return std::ranges::any_of(entry.second, [&](std::uint32_t f) { return std::ranges::binary_search(set, f); });
        };
        return in(a) && in(b);
      }));
    }
  }
}

TEST_CASE("grouping/face_clusters: shapes are those of the cluster's faces, and boxes and cones hold them all") {
  for (const auto& [name, mesh] : assortedMeshes())
    for (const std::uint32_t min_faces : {2U, 8U}) {
      CAPTURE(name);
      const FaceClusters clusters = clustersOf(mesh, {}, min_faces);
      for (std::uint32_t node = 0; node < clusters.nodeCount(); ++node) {
        const ClusterShape* stored = clusters.storedShape(node);
        if (clusters.faceCountOf(node) < min_faces) CHECK(stored == nullptr);
        if (clusters.faceCountOf(node) < min_faces || clusters.isFace(node)) continue;
        REQUIRE(stored != nullptr);  // none has more than 512 faces
        const ClusterShape& shape = *stored;
        CHECK(isSound(shape));
        const Faces faces = listOf(clusters.facesOf(node));
        const PlainFigures expected = plainFigures(mesh, faces, {});
        if (expected.corners == 0.0) continue;
        const double size = std::max(1e-30, double(glm::length(shape.hi - shape.lo)));
        CHECK(shape.area == doctest::Approx(expected.area).epsilon(1e-5));
        CHECK(glm::distance(DVec3(shape.area_vector), expected.area_vector) <= 1e-5 * expected.area + 1e-30);
        CHECK(glm::length(expected.area_vector) <= expected.area * (1.0 + 1e-12));
        CHECK(std::abs(double{shape.rms_distance} - std::sqrt(expected.fit)) <= 3e-4 * size);
        CHECK(glm::dot(DVec3(shape.frame.normal), expected.area_vector) >= -1e-6 * expected.area);
        double squares = 0.0;
        for (const std::uint32_t f : faces)
          for (const std::uint32_t v : mesh.triangles[f]) {
            const DVec3 d = DVec3(mesh.positions[v]) - DVec3(shape.center);
            const DVec3 at(glm::dot(d, DVec3(shape.frame.axis_s)), glm::dot(d, DVec3(shape.frame.axis_t)),
                           glm::dot(d, DVec3(shape.frame.normal)));
            for (int k = 0; k < 3; ++k) {
              CHECK(at[k] >= double{shape.lo[k]});
              CHECK(at[k] <= double{shape.hi[k]});
            }
            squares += at.z * at.z;
          }
        // The plane is as good as the best one, but for the rounding of its centre and normal.
        const double slack = 1e-6 * size + 1e-7 * double(glm::length(shape.center));
        CHECK(std::sqrt(squares / expected.corners) <= std::sqrt(expected.fit) + slack);
        if (shape.cone.sin_angle >= 1.0F) continue;
        const double least = std::sqrt(1.0 - double{shape.cone.sin_angle} * double{shape.cone.sin_angle});
        for (const std::uint32_t f : faces) {
          const PlainFigures face = plainFigures(mesh, {f}, {});
          if (face.area > 0.0) CHECK(glm::dot(face.area_vector / face.area, DVec3(shape.cone.axis)) >= least - 1e-9);
        }
      }
    }
}

TEST_CASE("grouping/face_clusters: shapes of large clusters hold all corners, and every face is below some shape") {
  std::mt19937 rng(0x1a46e);
  const mesh::Mesh mesh = lumpyBall(rng, 60, 80, 0.003F);
  for (const CostWeights& weights : {CostWeights{}, kPublished, CostWeights{1.0, 1.0, 0.0, 0.0}}) {
    const FaceClusters clusters = clustersOf(mesh, weights);
    CHECK(findInconsistency(clusters) == "");
    std::size_t missing = 0, large = 0;
    for (std::uint32_t node = clusters.faceCount(); node < clusters.nodeCount(); ++node) {
      const ClusterShape* shape = clusters.storedShape(node);
      large += clusters.faceCountOf(node) > 512 ? 1 : 0;
      missing += clusters.faceCountOf(node) > 512 && shape == nullptr ? 1 : 0;
      if (shape == nullptr) continue;
      const ClusterShape expected = shapeOfFaces(mesh, clusters.facesOf(node));
      CHECK(shape->area == doctest::Approx(expected.area));
      CHECK(shape->rms_distance == doctest::Approx(expected.rms_distance).epsilon(1e-3));
      CHECK(glm::distance(shape->lo, expected.lo) < 1e-3F);
      CHECK(glm::distance(shape->hi, expected.hi) < 1e-3F);
    }
    CHECK(large > 5);
    CHECK(missing < large);
    for (const std::uint32_t root : clusters.roots) CHECK(clusters.storedShape(root) != nullptr);
  }
}

TEST_CASE("grouping/face_clusters: any number of threads gives the same") {
  std::mt19937 rng(0x7ead);
  const mesh::Mesh mesh = lumpyBall(rng, 60, 80, 0.003F);
  const FaceClusters expected = clustersOf(mesh);
  for (const int threads : {2, 7}) {
    TaskPool pool(threads);
    CHECK(clusterFaces(mesh, {}, pool) == expected);
  }
}

TEST_CASE("grouping/face_clusters: moving, turning and scaling the mesh leaves the hierarchy as it is") {
  std::mt19937 rng(0x0b5e);
  mesh::Mesh mesh = lumpyBall(rng, 14, 18, 0.05F);
  // Coordinates of few bits, so that what follows is exact.
  for (Vec3& p : mesh.positions) p = glm::round(p * 1024.0F) / 1024.0F;
  const std::set<Faces> expected = clusterSets(clustersOf(mesh));
  const auto moved = [&](const auto& map) {
    mesh::Mesh copy = mesh;
    for (Vec3& p : copy.positions) p = map(p);
    return clusterSets(clustersOf(copy));
  };
  CHECK(moved([](const Vec3& p) { return p + Vec3(512.0F, -1024.0F, 256.0F); }) == expected);
  CHECK(moved([](const Vec3& p) { return p * 1048576.0F; }) == expected);
  CHECK(moved([](const Vec3& p) { return p * (1.0F / 65536.0F); }) == expected);
  CHECK(moved([](const Vec3& p) { return p * 3.0F; }) == expected);
  CHECK(moved([](const Vec3& p) { return Vec3(p.y, p.z, p.x); }) == expected);
  CHECK(moved([](const Vec3& p) { return Vec3(-p.y, p.x, p.z); }) == expected);
  CHECK(moved([](const Vec3& p) {
          return Vec3(4.0F * p.x - 3.0F * p.y, 3.0F * p.x + 4.0F * p.y,
                      5.0F * p.z);  // by acos(4/5), and 5 times as large
        }) == expected);
}

TEST_CASE("grouping/face_clusters: a million away the hierarchy is the same, and its shapes as exact") {
  std::mt19937 rng(0x0b5f);
  mesh::Mesh near = lumpyBall(rng, 14, 18, 0.05F);
  for (Vec3& p : near.positions) p = glm::round(p * 640.0F) / 16.0F;  // floats beyond 2^20 have steps of 1/8
  for (Vec3& p : near.positions) p = glm::round(p * 8.0F) / 8.0F;
  mesh::Mesh far = near;
  const Vec3 away(1048576.0F, -1048576.0F, 1200000.0F);
  for (Vec3& p : far.positions) p += away;
  const FaceClusters here = clustersOf(near), there = clustersOf(far);
  CHECK(clusterSets(here) == clusterSets(there));
  CHECK(here.children == there.children);
  for (std::size_t i = 0; i < here.cost.size(); ++i)
    CHECK(here.cost[i] == doctest::Approx(there.cost[i]).epsilon(1e-5));
  REQUIRE(here.shapes.size() == there.shapes.size());
  for (std::size_t i = 0; i < here.shapes.size(); ++i) {
    const ClusterShape &a = here.shapes[i], &b = there.shapes[i];
    CHECK(a.area == doctest::Approx(b.area).epsilon(1e-6));
    CHECK(a.rms_distance == doctest::Approx(b.rms_distance).epsilon(0.01));
    // The centre is rounded to 1/8 there, and the box is counted from it.
    CHECK(glm::distance(a.hi - a.lo, b.hi - b.lo) < 1e-3F);
    CHECK(glm::distance(DVec3(a.center), DVec3(b.center) - DVec3(away)) < 0.25);
  }
}

TEST_CASE("grouping/face_clusters: turned about any axis, clusters keep their faces, boxes, areas and cones") {
  std::mt19937 rng(0x0b60);
  const mesh::Mesh mesh = lumpyBall(rng, 10, 14, 0.06F);
  const FaceClusters expected = clustersOf(mesh);
  for (const auto& [angle, axis] : {std::pair(0.7, DVec3(1.0, 2.0, -0.5)), std::pair(2.5, DVec3(-0.3, 0.1, 1.0)),
                                    std::pair(1.1, DVec3(0.0, 1.0, 1.0))}) {
    CAPTURE(angle);
    const DMat4 turn = glm::rotate(DMat4(1.0), angle, axis);
    mesh::Mesh turned = mesh;
    for (Vec3& p : turned.positions) p = Vec3(DVec3(turn * DVec4(DVec3(p) * 3.7, 1.0)) + DVec3(20.0, -4.0, 9.0));
    const FaceClusters clusters = clustersOf(turned);
    CHECK(clusterSets(clusters) == clusterSets(expected));
    REQUIRE(clusters.children == expected.children);
    for (std::size_t i = 0; i < expected.shapes.size(); ++i) {
      const ClusterShape &a = expected.shapes[i], &b = clusters.shapes[i];
      CHECK(b.area == doctest::Approx(3.7 * 3.7 * a.area).epsilon(1e-4));
      CHECK(b.rms_distance == doctest::Approx(3.7 * a.rms_distance).epsilon(1e-3));
      CHECK(glm::distance(DVec3(b.frame.normal), DVec3(turn * DVec4(DVec3(a.frame.normal), 0.0))) < 1e-3);
      CHECK(glm::distance(b.hi - b.lo, 3.7F * (a.hi - a.lo)) < 1e-2F);
      CHECK(b.cone.sin_angle == doctest::Approx(a.cone.sin_angle).epsilon(1e-3));
    }
  }
}

TEST_CASE(
    "grouping/face_clusters: needles of any thinness, and edges of three faces, have finite costs and sound shapes") {
  for (const float thin : {1e-2F, 1e-4F, 1e-6F, 1e-9F, 0.0F}) {
    CAPTURE(thin);
    std::mt19937 rng(0x4eed);
    mesh::Mesh mesh = hills(rng, 12, 0.1F);
    for (Vec3& p : mesh.positions) p.x *= thin;
    // A third sheet on an edge within, and one sheet twice.
    mesh.positions.emplace_back(0.5F, 2.0F, 0.5F);
    const auto top = static_cast<std::uint32_t>(mesh.positions.size() - 1);
    mesh.triangles.push_back({mesh.triangles[60][0], mesh.triangles[60][1], top});
    mesh.triangles.push_back(mesh.triangles[60]);
    const FaceClusters clusters = clustersOf(mesh, {}, 2);
    CHECK(findInconsistency(clusters) == "");
    CHECK(clusters.roots.size() == 1);
    for (const float cost : clusters.cost) CHECK(std::isfinite(cost));
    for (const ClusterShape& shape : clusters.shapes) CHECK(isSound(shape));
  }
}

TEST_CASE("grouping/face_clusters: in a plane only roundness decides") {
  const mesh::Mesh grid = mesh::makeGrid(16);
  for (const bool is_tilted : {false, true}) {
    mesh::Mesh mesh = grid;
    if (is_tilted)
      for (Vec3& p : mesh.positions) p = Vec3(0.25F * p.x - 0.5F * p.y, 0.75F * p.x, 0.5F * p.y + p.x);
    const FaceClusters plain = clustersOf(mesh, {1.0, 1.0, 0.0, 0.0});
    for (const float cost : plain.cost) CHECK(std::abs(cost) < 1e-12F);
    const FaceClusters round = clustersOf(mesh, {0.0, 0.0, 1.0, 0.0}), published = clustersOf(mesh, kPublished);
    REQUIRE(round.cost.size() == published.cost.size());
    for (std::size_t i = 0; i < round.cost.size(); ++i) CHECK(round.cost[i] == doctest::Approx(published.cost[i]));
  }
  // Two halves of a square gain most, so that all squares are made first.
  const FaceClusters clusters = clustersOf(grid, kPublished);
  for (std::uint32_t i = 0; i < 256; ++i) {
    const auto faces = listOf(clusters.facesOf(clusters.faceCount() + i));
    REQUIRE(faces.size() == 2);
    CHECK(faces[0] / 2 == faces[1] / 2);  // makeGrid puts the two halves of a square side by side
  }
}

TEST_CASE("grouping/face_clusters: each side of a cube becomes one cluster before any edge is crossed") {
  mesh::Mesh cube;
  const mesh::Mesh grid = mesh::makeGrid(4);
  for (int side = 0; side < 6; ++side) {
    mesh::Mesh face = grid;
    for (Vec3& p : face.positions) {
      p = Vec3(p.x - 0.5F, p.y - 0.5F, 0.5F);
      if (side >= 4) p = Vec3(p.z * (side == 4 ? 1.0F : -1.0F), p.y, -p.x * (side == 4 ? 1.0F : -1.0F));
      for (int turn = 0; turn < side && side < 4; ++turn) p = Vec3(p.x, -p.z, p.y);
    }
    append(cube, face, Vec3(0.0F));
  }
  // Joined at their borders.
  std::map<std::array<int, 3>, std::uint32_t> at;
  std::vector<std::uint32_t> number(cube.positions.size());
  mesh::Mesh welded;
  for (std::size_t v = 0; v < cube.positions.size(); ++v) {
    const glm::ivec3 key(glm::round(4.0F * cube.positions[v]));
    const auto [entry, is_new] = at.try_emplace({key.x, key.y, key.z}, static_cast<std::uint32_t>(at.size()));
    if (is_new) welded.positions.push_back(cube.positions[v]);
    number[v] = entry->second;
  }
  for (const mesh::Triangle& t : cube.triangles) welded.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  const FaceClusters clusters = clustersOf(welded, {1.0, 10.0, 0.1, 0.0});
  REQUIRE(clusters.roots.size() == 1);
  std::set<Faces> sides;
  for (std::uint32_t side = 0; side < 6; ++side) {
    Faces faces(32);
    std::iota(faces.begin(), faces.end(), 32 * side);
    sides.insert(faces);
  }
  const std::set<Faces> all = clusterSets(clusters);
  CHECK(std::ranges::includes(all, sides));
}

TEST_CASE("grouping/face_clusters: a closed surface ends with one cluster without border") {
  std::mt19937 rng(0xc105);
  const mesh::Mesh mesh = lumpyBall(rng, 12, 16, 0.02F);
  const FaceClusters clusters = clustersOf(mesh, kPublished);
  REQUIRE(clusters.roots.size() == 1);
  const ClusterShape root = shapeOf(mesh, clusters, clusters.roots[0]);
  CHECK(glm::length(root.area_vector) < 1e-5F * root.area);
  CHECK(root.cone.sin_angle >= 1.0F);
  CHECK(std::isfinite(clusters.cost.back()));
}

TEST_CASE("grouping/face_clusters: neighbours that turn opposite ways are clustered as if they did not") {
  std::mt19937 rng(0x3a3a);
  mesh::Mesh mesh = lumpyBall(rng, 10, 12, 0.04F);
  const std::set<Faces> expected = clusterSets(clustersOf(mesh));
  for (mesh::Triangle& t : mesh.triangles)
    if (rng() % 3 == 0) std::swap(t[0], t[1]);
  CHECK(clusterSets(clustersOf(mesh)) == expected);
}

TEST_CASE("grouping/face_clusters: no faces, one face, faces that share nothing") {
  const FaceClusters none = clustersOf({});
  CHECK(none.nodeCount() == 0);
  CHECK(findInconsistency(none) == "");
  mesh::Mesh mesh;
  mesh.positions = {{0.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}};
  mesh.triangles = {{0, 1, 2}};
  const FaceClusters one = clustersOf(mesh);
  CHECK(one.roots == std::vector<std::uint32_t>{0});
  CHECK(one.facesOf(0).size() == 1);
  const ClusterShape shape = shapeOf(mesh, one, 0);
  CHECK(shape.area == 0.5F);
  CHECK(shape.frame.normal == Vec3(0.0F, 0.0F, 1.0F));
  CHECK(shape.cone.axis == Vec3(0.0F, 0.0F, 1.0F));
  CHECK(shape.maxDistance() == 0.0F);
  mesh.positions.insert(mesh.positions.end(), {{5.0F, 0.0F, 0.0F}, {6.0F, 0.0F, 0.0F}, {5.0F, 1.0F, 0.0F}});
  mesh.triangles.push_back({3, 4, 5});
  CHECK(clustersOf(mesh).roots == std::vector<std::uint32_t>{0, 1});
  // All corners in one point, and on one line.
  mesh.positions.assign(6, Vec3(2.0F));
  CHECK(findInconsistency(clustersOf(mesh)) == "");
  CHECK(isSound(shapeOf(mesh, clustersOf(mesh), 0)));
  for (std::size_t i = 0; i < 6; ++i) mesh.positions[i].x = float(i);
  CHECK(isSound(shapeOf(mesh, clustersOf(mesh), 0)));
}

TEST_CASE("grouping/face_clusters: a face with a corner that is not finite is a root of its own, without size") {
  std::mt19937 rng(0xbad0);
  const mesh::Mesh mesh = badFaces(rng);
  const FaceClusters clusters = clustersOf(mesh);
  const std::uint32_t first_bad = 50;
  for (std::uint32_t f = first_bad; f < first_bad + 3; ++f) {
    CHECK(clusters.parent[f] == kNoIndex);
    CHECK(shapeOf(mesh, clusters, f) == ClusterShape{});
  }
  CHECK(clusters.parent[first_bad + 3] != kNoIndex);  // two corners the same, on the border
  for (const float cost : clusters.cost) CHECK(std::isfinite(cost));
}

TEST_CASE("grouping/face_clusters: hubs with thousands of neighbours") {
  constexpr std::uint32_t kSteps = 3000;
  const mesh::Mesh plate = plateOf(kSteps);
  const FaceClusters clusters = clustersOf(plate, {1.0, 1.0, 0.0, 0.0});
  CHECK(findInconsistency(clusters) == "");
  CHECK(clusters.roots.size() == 1);
  // Both flat sides are there as clusters: nothing is cheaper than to complete them.
  const std::set<Faces> all = clusterSets(clusters);
  for (const std::uint32_t side : {0U, 1U}) {
    Faces faces;
    for (std::uint32_t i = 0; i < kSteps; ++i) faces.push_back(4 * i + side);
    CHECK(all.contains(faces));
  }
}

TEST_CASE("grouping/face_clusters: what is inconsistent is found") {
  const mesh::Mesh mesh = mesh::makeGrid(6);
  const FaceClusters good = clustersOf(mesh);
  REQUIRE(findInconsistency(good) == "");
  const auto broken = [&](const auto& change) {
    FaceClusters bad = good;
    change(bad);
    return findInconsistency(bad) != "";
  };
  CHECK(broken([](FaceClusters& c) { std::swap(c.faces[0], c.faces[1]); }));
  CHECK(broken([](FaceClusters& c) { c.children[5] = c.children[4]; }));
  CHECK(broken([](FaceClusters& c) { c.children[0][0] = c.faceCount() + 3; }));
  CHECK(broken([](FaceClusters& c) { c.parent[2] = kNoIndex; }));
  CHECK(broken([](FaceClusters& c) { c.first_face[3] = 0; }));
  CHECK(broken([](FaceClusters& c) { c.face_count.back() = 1; }));
  CHECK(broken([](FaceClusters& c) { c.cost.pop_back(); }));
  CHECK(broken([](FaceClusters& c) { c.roots.clear(); }));
  CHECK(broken([](FaceClusters& c) { c.shape_index.back() = 1; }));
  CHECK(broken([](FaceClusters& c) { c.shapes.push_back(c.shapes[0]); }));
  CHECK(broken([](FaceClusters& c) { c.shapes[0].lo.x = kNaN; }));
  CHECK(broken([](FaceClusters& c) { std::swap(c.shapes[0].lo.x, c.shapes[0].hi.x); }));
  CHECK(broken([](FaceClusters& c) { c.shapes[0].frame.normal *= 2.0F; }));
}

}  // namespace sheaf::grouping
