// mesh/collapse_mesh: triangles whose edges can be contracted one after another. Knows connections only, no positions.
// Internal to mesh/.
#pragma once

#include <span>
#include <vector>

#include "mesh/mesh.h"

namespace sheaf::mesh {

class CollapseMesh {
 public:
  /// A corner is 3 * triangle + k.
  using Corner = std::uint32_t;

  /// triangles  of point indices in [0, point_count), no point twice in one
  CollapseMesh(std::span<const Triangle> triangles, std::size_t point_count);

  std::size_t livePointCount() const { return live_points_; }  ///< those in a triangle
  std::size_t liveTriangleCount() const { return live_triangles_; }
  std::size_t triangleCount() const { return triangles_.size(); }  ///< those that are gone included
  const Triangle& triangle(std::uint32_t f) const { return triangles_[f].points; }
  bool isLive(std::uint32_t f) const { return triangles_[f].points[0] != kGone; }
  bool isPointLive(std::uint32_t point) const { return first_[point] != kEnd; }

  static constexpr std::uint32_t after(std::uint32_t k) { return k == 2 ? 0 : k + 1; }
  std::uint32_t nextPoint(Corner c) const { return triangles_[c / 3].points[after(c % 3)]; }
  std::uint32_t lastPoint(Corner c) const { return triangles_[c / 3].points[after(after(c % 3))]; }

  /// Calls body(corner) for each corner at a point.
  template <typename Body>
  void forEachCorner(std::uint32_t point, const Body& body) {
    // Corners of triangles that are gone are dropped from the list in passing.
    for (Corner* link = &first_[point]; *link != kEnd;) {
      const Corner c = *link;
      Links& t = triangles_[c / 3];
      if (t.points[0] != kGone) {
        body(c);
        link = &t.next[c % 3];
      } else {
        *link = t.next[c % 3];
      }
    }
  }

  /// Calls body(triangle) for each triangle on the edge between two points.
  template <typename Body>
  void forEachTriangleOnEdge(std::uint32_t a, std::uint32_t b, const Body& body) {
    const bool from_a = corner_count_[a] <= corner_count_[b];  // the centre of a fan may have very many
    forEachCorner(from_a ? a : b, [&, end = from_a ? b : a](Corner c) {
      if (nextPoint(c) == end || lastPoint(c) == end) body(c / 3);
    });
  }

  /// The points that share an edge with this one, each once. Valid until the next call of this or of mayCollapse().
  std::span<const std::uint32_t> neighbours(std::uint32_t point);
  /// May b be merged into a? Not if that would change the topology: the link condition of Dey, Edelsbrunner, Guha and
  /// Nekhayev (1999), with borders and edges of three or more triangles kept as curves; nor if an edge would lose its
  /// last triangle or two triangles would have the same corners.
  bool mayCollapse(std::uint32_t a, std::uint32_t b);

  /// Replaces b by a; the triangles with both go.
  void collapse(std::uint32_t a, std::uint32_t b);

  /// Takes a triangle out.
  void remove(std::uint32_t triangle);

 private:
  static constexpr std::uint32_t kGone = 0xFFFFFFFFU;
  static constexpr Corner kEnd = 0xFFFFFFFFU;

  struct Mark {
    std::uint32_t round = 0;
    std::array<std::uint32_t, 2> count{};  // triangles on the edge from the first, the second point to this one
    std::uint32_t apexes = 0;              // triangles that have this point and both others
  };

  void startRound();
  Mark& markOf(std::uint32_t point);
  void countAround(std::uint32_t point, std::size_t side);
  bool wouldRepeatTriangle(std::uint32_t a, std::uint32_t b);
  void pruneIfUnused(std::uint32_t point);

  // Side by side, because they are needed together and the order of contractions jumps about in memory.
  struct Links {
    Triangle points;
    std::array<Corner, 3> next;  // the next corner at the same point
  };

  std::vector<Links> triangles_;
  std::vector<Corner> first_;                // per point: head of its list of corners
  std::vector<std::uint32_t> corner_count_;  // per point, at least as many as are left
  std::size_t live_points_ = 0, live_triangles_ = 0;
  std::vector<Mark> marks_;
  std::uint32_t round_ = 0;
  std::vector<std::uint32_t> ring_;  // points marked in this round
};

}  // namespace sheaf::mesh
