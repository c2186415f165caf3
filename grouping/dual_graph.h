// grouping/dual_graph: which faces of a mesh are neighbours, and along how much border [HFC].
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/math.h"
#include "grouping/patches.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

/// Where clustering computes: the mesh moved and scaled so that the area centroid is 0 and the farthest vertex in use
/// lies at distance 1/2. Costs then depend on neither place nor size nor, but for round-off, on rotation.
struct ModelFrame {
  DVec3 center{0.0};
  double scale = 1.0;

  DVec3 operator()(const Vec3& p) const { return (DVec3(p) - center) * scale; }
};

/// Triangles with a corner that is not finite do not count.
ModelFrame modelFrameOf(const mesh::Mesh& mesh);

bool hasFiniteCorners(const mesh::Mesh& mesh, const mesh::Triangle& t);

/// Pairs of different corners of a triangle, without repetition: three edges, one if two corners are the same, or none.
struct TriangleEdges {
  std::array<std::array<std::uint32_t, 2>, 3> edges;
  int count = 0;
};
TriangleEdges edgesOf(const mesh::Triangle& t);

/// Two faces that share edges of the mesh. It stands in the lists of both: next[i] follows it in the list of face[i].
struct DualEdge {
  std::array<std::uint32_t, 2> face;
  std::array<std::uint32_t, 2> next;
  double length;    ///< of all the edges that the two share, in the model frame
  float cost;       ///< of joining the two; this and what follows is for contraction
  bool is_waiting;  ///< in the queue, but not yet in its heap

  int sideOf(std::uint32_t f) const { return face[0] == f ? 0 : 1; }
};

static_assert(sizeof(DualEdge) == 32);

/// DualEdge::length of one that is gone but still stands in lists.
inline constexpr double kContracted = -1.0;

/// One dual edge at most between any two faces. A mesh edge of k faces links
///   k = 1      nothing: a border of the mesh
///   k = 2      the two
///   3 to 8     neighbours in the order of their angles around the edge, cyclically; the length does not count
///   more       neighbours in the order of their numbers, not cyclically; the length does not count
/// so that an edge of more than two faces stays in the perimeter of every cluster that has it ([HFC] leaves these
/// open). A face has at most 6 dual edges. Faces with a corner that is not finite have none.
struct DualGraph {
  std::vector<DualEdge> edges;
  std::vector<std::uint32_t> first;    ///< #F, head of the face's list in `edges`, kNoIndex if it is empty
  std::vector<std::uint32_t> opposed;  ///< dual edges whose two faces run along the shared edge in the same direction
};

/// Puts the edges into the lists of clusters [0, cluster_count), the last one first. Writes first and DualEdge::next.
void linkEdges(std::size_t cluster_count, DualGraph& graph);

/// O(F) but for edges of many faces. Asserts fewer than 2^30 faces.
DualGraph buildDualGraph(const mesh::Mesh& mesh, const ModelFrame& frame);

/// Faces to be turned over so that neighbours agree, spread from face to face across edges of two faces; in every piece
/// of the mesh the larger part stays as it is. Empty if all agree already; where that is impossible (a Moebius strip),
/// some neighbours are left to disagree.
std::vector<bool> findTurnedFaces(const DualGraph& graph);

}  // namespace sheaf::grouping
