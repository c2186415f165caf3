// grouping/vertex_groups: the result of grouping, whatever found it: vertices that are reduced to a parameter on a line
// or to two on a plane.
//   In     made by groupLinear() or groupPlanar(), or read from a file
//   Out    everything in indices and the object space of the mesh that was grouped; the mesh is not needed to draw
//   Keeps  positions[v] == pointOn(groups[owner[v]], s, t) to the bit for every grouped vertex
//   Words  free, defining: retained, transformed in full; grouped: eliminated, rebuilt from its group
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/math.h"
#include "grouping/patches.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

enum class GroupKind : std::uint8_t { kLine, kPlane };
enum class VertexState : std::uint8_t { kUnused, kFree, kDefining, kGrouped };
enum class Metric : std::uint8_t { kDistance, kQuadric };
/// What keeps an ellipsoid from reaching too far: kPaper as published ([PG] 5.2), kSafe so that no face can fold over.
enum class Limit : std::uint8_t { kSafe, kPaper };

/// Largest epsilon, as a fraction of the extent; at 1 every vertex is within reach of every other already.
inline constexpr double kMaxEpsilon = 1000.0;

/// One of the directions of a plane set, as a right-handed orthonormal frame: cross(axis_s, axis_t) = normal.
struct PlaneFrame {
  Vec3 normal;
  Vec3 axis_s;
  Vec3 axis_t;
  bool operator==(const PlaneFrame&) const = default;
};

/// Members lie at base + s * axis_s + t * axis_t. A line has axis_s = V2 - V1 and axis_t = 0, t = 0.
struct VertexGroup {
  GroupKind kind = GroupKind::kPlane;
  std::uint32_t plane = kNoIndex;   ///< of a plane: its frame, into VertexGroups::planes
  std::uint32_t origin = kNoIndex;  ///< V1. kNoIndex: that vertex has moved away and only `base` is left of it
  std::uint32_t end = kNoIndex;     ///< of a line: V2, or kNoIndex likewise
  Vec3 base{0.0F};                  ///< where V1 was when the group was made
  Vec3 axis_s{0.0F};
  Vec3 axis_t{0.0F};
  std::uint32_t first_member = 0;  ///< into VertexGroups::members, s and t
  std::uint32_t member_count = 0;  ///< at least 1
  /// Ranges of the parameters. They hold the defining vertices too: 0 is in each, and 1 in a line's s.
  float s_min = 0.0F, s_max = 0.0F, t_min = 0.0F, t_max = 0.0F;

  bool operator==(const VertexGroup&) const = default;
};

/// The one definition of where a parameter pair lies: this order of operations, in float.
inline Vec3 pointOn(const VertexGroup& g, float s, float t) {
  return (g.base + s * g.axis_s) + t * g.axis_t;
}

/// Lengths are fractions of the extent (VertexGroups::extent). Counts and means are over the vertices in use.
struct GroupingStats {
  std::uint32_t vertices = 0;  ///< n: used by some face; all of them if there are no faces
  std::uint32_t free = 0;
  std::uint32_t defining = 0;
  std::uint32_t grouped = 0;
  double eliminated = 0.0;  ///< grouped / n
  double displacement_max = 0.0;
  double displacement_mean = 0.0;
  double displacement_rms = 0.0;
  double normal_deviation_max_rad = 0.0;  ///< over the faces that have area before and after
  double normal_deviation_rms_rad = 0.0;
  std::uint32_t flipped_faces = 0;      ///< normal turned by more than 90 degrees
  std::uint32_t collapsed_faces = 0;    ///< had area and have lost it
  std::uint32_t restored_vertices = 0;  ///< set free again because a face was flipped or collapsed
  double search_ms = 0.0;               ///< finding the groups, without taking these figures

  bool operator==(const GroupingStats&) const = default;
};

/// #V is the vertex count of the mesh.
struct VertexGroups {
  std::vector<VertexGroup> groups;
  std::vector<std::uint32_t> members;  ///< grouped vertices, by group, ascending within one
  std::vector<float> s;                ///< beside members
  std::vector<float> t;                ///< beside members
  std::vector<VertexState> state;      ///< #V
  std::vector<std::uint32_t> owner;    ///< #V, the group of a grouped vertex, otherwise kNoIndex
  std::vector<Vec3> positions;         ///< #V, snapped: a grouped vertex where its group puts it, others untouched
  std::vector<PlaneFrame> planes;      ///< the plane set; empty for lines
  GroupKind kind = GroupKind::kPlane;
  Metric metric = Metric::kDistance;  ///< the one that was used, which may not be the one asked for: see warnings
  Limit limit = Limit::kSafe;         ///< of the quadric metric
  std::uint8_t dimensions = 3;        ///< 2: z is 0 throughout
  bool segment_only = false;          ///< of lines: no member lies beyond V1 and V2
  bool interrupted = false;           ///< stopped by the caller; what is here is valid, but more could be grouped
  double epsilon = 0.0;               ///< as a fraction of the extent
  double extent = 0.0;                ///< longest edge of the box of the vertices in use
  std::uint32_t mesh_checksum = 0;    ///< meshChecksum(), set by who is going to save the groups; 0: not known
  std::vector<std::string> warnings;
  GroupingStats stats;

  bool operator==(const VertexGroups&) const = default;
};

/// Called now and then with the share of the work that is done, in [0, 1]. Returning false stops the work.
using Progress = std::function<bool(double done)>;

/// The mesh with its vertices where their groups put them; everything else is copied.
mesh::Mesh snappedMesh(const mesh::Mesh& mesh, const VertexGroups& groups);

/// Checks every promise above that needs no mesh. Returns the first broken one in words, or an empty string.
std::string findInconsistency(const VertexGroups& groups);

}  // namespace sheaf::grouping
