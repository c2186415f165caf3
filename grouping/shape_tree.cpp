#include "grouping/shape_tree.h"

#include <algorithm>
#include <cassert>

#include "grouping/dual_graph.h"
#include "grouping/normal_cone.h"

namespace sheaf::grouping {
namespace {

using mesh::Mesh;

constexpr double kGrowth = 1.0 + 1.0 / 256.0;
constexpr int kPiecesPerTask = 16;

// A largest cluster of up to kPieceFaces faces, or a part of one larger than that.
struct Piece {
  std::uint32_t node = 0;
  ClusterMoments moments;
  NormalCone cone;
  std::vector<Vec3> points;  // its vertices, each once
};

NormalCone joinedCone(const NormalCone& a, double area_a, const NormalCone& b, double area_b) {
  if (!(area_a > 0.0)) return b;
  if (!(area_b > 0.0)) return a;
  return coneAround(a, b);
}

// Makes the shapes within pieces. One per worker.
class PieceBuilder {
 public:
  PieceBuilder(const Mesh& mesh, FaceClusters& clusters)
      : mesh_(mesh), clusters_(clusters), last_seen_(mesh.vertexCount(), kNoIndex) {}

  // number  of the piece, different from any other
  void build(Piece& piece, std::uint32_t number) {
    collectCorners(piece, number);
    collectNodes(piece.node);
    sums_.clear();
    // Parents stand before their parts, so backwards both parts are done when it is their parent's turn.
    for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {
      if (clusters_.isFace(*node)) {
        sums_.push_back(face_sums_[clusters_.first_face[*node] - first_face_]);
      } else {
        const ClusterMoments first = sums_.back();
        sums_.pop_back();
        sums_.back() = joined(first, sums_.back(), 0.0);
        if (const std::uint32_t index = clusters_.shape_index[*node - clusters_.faceCount()]; index != kNoIndex)
          clusters_.shapes[index] = shapeFrom(sums_.back(), cornersOf(*node), coneOf(normalsOf(*node)));
      }
    }
    piece.moments = sums_.back();
    piece.cone = coneOf(normalsOf(piece.node));
  }

 private:
  void collectCorners(Piece& piece, std::uint32_t number) {
    first_face_ = clusters_.first_face[piece.node];
    face_sums_.clear();
    corners_.clear();
    normals_.clear();
    first_normal_.clear();
    for (const std::uint32_t f : clusters_.facesOf(piece.node)) {
      face_sums_.push_back(objectMoments(mesh_, f));
      const ClusterMoments& m = face_sums_.back();
      first_normal_.push_back(static_cast<std::uint32_t>(normals_.size()));
      if (m.area > 0.0) normals_.push_back(m.area_vector / m.area);
      if (m.corners == 0.0) continue;  // a face with a corner that is not finite is a piece of its own
      for (const std::uint32_t v : mesh_.triangles[f]) {
        corners_.push_back(mesh_.positions[v]);
        if (last_seen_[v] != number) piece.points.push_back(mesh_.positions[v]);
        last_seen_[v] = number;
      }
    }
    first_normal_.push_back(static_cast<std::uint32_t>(normals_.size()));
  }

  void collectNodes(std::uint32_t root) {
    nodes_.clear();
    open_.assign(1, root);
    while (!open_.empty()) {
      const std::uint32_t node = open_.back();
      open_.pop_back();
      nodes_.push_back(node);
      if (clusters_.isFace(node)) continue;
      const auto [left, right] = clusters_.childrenOf(node);
      open_.push_back(right);
      open_.push_back(left);
    }
  }

  std::span<const Vec3> cornersOf(std::uint32_t node) const {
    const std::size_t first = clusters_.first_face[node] - first_face_;
    return std::span(corners_).subspan(3 * first, 3 * std::size_t{clusters_.faceCountOf(node)});
  }
  std::span<const DVec3> normalsOf(std::uint32_t node) const {
    const std::size_t first = clusters_.first_face[node] - first_face_;
    const std::uint32_t begin = first_normal_[first], end = first_normal_[first + clusters_.faceCountOf(node)];
    return std::span(normals_).subspan(begin, end - begin);
  }

  const Mesh& mesh_;
  FaceClusters& clusters_;
  std::uint32_t first_face_ = 0;
  std::vector<std::uint32_t> last_seen_;  // #V, the piece that has had the vertex last
  std::vector<ClusterMoments> face_sums_, sums_;
  std::vector<Vec3> corners_;   // three per face
  std::vector<DVec3> normals_;  // of the faces that have area
  std::vector<std::uint32_t> first_normal_, nodes_, open_;
};

// Everything above the pieces.
struct Crown {
  std::vector<std::uint32_t> nodes;  // ascending
  std::vector<Piece> pieces;         // by first face
};

Crown findCrown(const FaceClusters& clusters) {
  Crown crown;
  walkDown(clusters, [&](std::uint32_t node) {
    const bool is_piece = clusters.faceCountOf(node) <= kPieceFaces;
    if (is_piece)
      crown.pieces.emplace_back().node = node;
    else
      crown.nodes.push_back(node);
    return !is_piece;
  });
  std::sort(crown.nodes.begin(), crown.nodes.end());
  return crown;
}

// Numbers shapes depth first.
void chooseShapes(const Crown& crown, std::uint32_t min_faces, FaceClusters& clusters) {
  const std::uint32_t faces = clusters.faceCount();
  std::vector<bool> is_grown(clusters.children.size(), false);
  std::vector<std::uint32_t> grown_from(crown.nodes.size());  // faces of the largest cluster below that has a shape
  const auto largest_below = [&](std::uint32_t node) {
    if (clusters.faceCountOf(node) <= kPieceFaces) return clusters.faceCountOf(node);
    return grown_from[static_cast<std::size_t>(std::ranges::lower_bound(crown.nodes, node) - crown.nodes.begin())];
  };
  for (std::size_t i = 0; i < crown.nodes.size(); ++i) {
    const std::uint32_t node = crown.nodes[i], count = clusters.faceCountOf(node);
    const auto [left, right] = clusters.childrenOf(node);
    grown_from[i] = std::max(largest_below(left), largest_below(right));
    if (clusters.parent[node] != kNoIndex && count < kGrowth * grown_from[i]) continue;
    is_grown[node - faces] = true;
    grown_from[i] = count;
  }
  clusters.shape_index.assign(clusters.children.size(), kNoIndex);
  std::uint32_t shapes = 0;
  walkDown(clusters, [&](std::uint32_t node) {
    const std::uint32_t count = clusters.faceCountOf(node);
    if (clusters.isFace(node) || count < min_faces) return false;
    if (count <= kPieceFaces || is_grown[node - faces]) clusters.shape_index[node - faces] = shapes++;
    return true;
  });
  clusters.shapes.resize(shapes);
}

void buildPieces(const Mesh& mesh, TaskPool& pool, Crown& crown, FaceClusters& clusters) {
  std::vector<PieceBuilder> builders(static_cast<std::size_t>(pool.threadCount()), PieceBuilder(mesh, clusters));
  const auto count = static_cast<int>(crown.pieces.size());
  pool.parallelFor((count + kPiecesPerTask - 1) / kPiecesPerTask, [&](int task, int worker) {
    for (int i = task * kPiecesPerTask; i < std::min(count, (task + 1) * kPiecesPerTask); ++i)
      builders[static_cast<std::size_t>(worker)].build(crown.pieces[static_cast<std::size_t>(i)],
                                                       static_cast<std::uint32_t>(i));
  });
}

// The shapes of the crown's nodes, from the pieces.
void buildCrown(const Crown& crown, TaskPool& pool, FaceClusters& clusters) {
  std::vector<Vec3> points;
  std::vector<std::size_t> first_point{0};
  for (const Piece& piece : crown.pieces) {
    points.insert(points.end(), piece.points.begin(), piece.points.end());
    first_point.push_back(points.size());
  }
  const auto piece_at = [&](std::uint32_t face) {  // the first that begins there or later
    const auto begins = [&](const Piece& p) { return clusters.first_face[p.node]; };
    return static_cast<std::size_t>(std::ranges::lower_bound(crown.pieces, face, {}, begins) - crown.pieces.begin());
  };
  struct Sum {
    ClusterMoments moments;
    NormalCone cone;
  };
  std::vector<Sum> sums(crown.nodes.size());
  const auto sum_of = [&](std::uint32_t node) -> Sum {
    if (clusters.faceCountOf(node) > kPieceFaces)
      return sums[static_cast<std::size_t>(std::ranges::lower_bound(crown.nodes, node) - crown.nodes.begin())];
    const Piece& piece = crown.pieces[piece_at(clusters.first_face[node])];
    return {piece.moments, piece.cone};
  };
  for (std::size_t i = 0; i < crown.nodes.size(); ++i) {
    const auto [left, right] = clusters.childrenOf(crown.nodes[i]);
    const Sum a = sum_of(left), b = sum_of(right);
    sums[i] = {joined(a.moments, b.moments, 0.0), joinedCone(a.cone, a.moments.area, b.cone, b.moments.area)};
  }
  pool.parallelFor(static_cast<int>(crown.nodes.size()), [&](int i, int) {
    const std::uint32_t node = crown.nodes[static_cast<std::size_t>(i)];
    const std::uint32_t index = clusters.shape_index[node - clusters.faceCount()];
    if (index == kNoIndex) return;
    const std::uint32_t first = clusters.first_face[node];
    const std::size_t begin = first_point[piece_at(first)];
    const std::size_t end = first_point[piece_at(first + clusters.faceCountOf(node))];
    const Sum& sum = sums[static_cast<std::size_t>(i)];
    clusters.shapes[index] = shapeFrom(sum.moments, std::span(points).subspan(begin, end - begin), sum.cone);
  });
}

}  // namespace

void addShapes(const Mesh& mesh, std::uint32_t min_shape_faces, TaskPool& pool, FaceClusters& clusters) {
  assert(min_shape_faces >= 2);
  Crown crown = findCrown(clusters);
  chooseShapes(crown, min_shape_faces, clusters);
  if (clusters.shapes.empty()) return;
  buildPieces(mesh, pool, crown, clusters);
  buildCrown(crown, pool, clusters);
}

}  // namespace sheaf::grouping
