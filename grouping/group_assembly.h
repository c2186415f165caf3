// grouping/group_assembly: what every search shares before and after it: the set of vertices to group, and turning
// "this vertex belongs to that group" into VertexGroups.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "grouping/quadric.h"
#include "grouping/vertex_groups.h"

namespace sheaf::grouping {

/// Beyond this, differences and dot products could overflow in float.
inline constexpr float kMaxCoordinate = 1e30F;

/// Vertices that some triangle uses, ascending; all of them if there are no triangles.
/// Throws Error(kBadInput) if one of them is not finite or beyond kMaxCoordinate.
std::vector<std::uint32_t> verticesInUse(std::span<const Vec3> positions, std::span<const mesh::Triangle> triangles);

/// Throws Error(kBadInput) if one of these vertices is not finite or beyond kMaxCoordinate.
void checkPositions(std::span<const Vec3> positions, std::span<const std::uint32_t> vertices);

/// Longest edge of the box around these vertices; 0 for none.
double extentOf(std::span<const Vec3> positions, std::span<const std::uint32_t> vertices);

/// Sets metric and limit, and says so in the warnings if the quadric metric has no faces to work from.
void chooseMetric(const mesh::Mesh& mesh, Metric metric, Limit limit, VertexGroups& out);

/// What a search has found. Seeds may be left without members; they are dropped.
struct Findings {
  struct Seed {
    std::uint32_t origin;
    std::uint32_t end;    ///< kNoIndex for a plane
    std::uint32_t plane;  ///< kNoIndex for a line
  };
  std::vector<Seed> seeds;           ///< in the order the groups shall have
  std::vector<std::uint32_t> owner;  ///< #V, seed of a grouped vertex, otherwise kNoIndex
};

/// Where a vertex goes on a line or plane: the nearest point, or the one of least quadric error.
class Placement {
 public:
  /// ellipsoids    #V, or empty for the distance metric; kept by reference
  /// segment_only  round-off must not take t out of [0, 1]
  explicit Placement(std::span<const Sym3> ellipsoids, bool segment_only = false)
      : ellipsoids_(ellipsoids), segment_only_(segment_only) {}

  struct Parameters {
    float s, t;
  };
  Parameters parametersOf(const VertexGroup& group, const PlaneFrame* frame, std::uint32_t vertex,
                          const Vec3& position) const;

 private:
  float lineParameter(const VertexGroup& group, std::uint32_t vertex, const DVec3& from_base) const;

  std::span<const Sym3> ellipsoids_;
  bool segment_only_;
};

/// Fills groups, members, parameters, states, owners and positions of `out`, whose `planes` and `kind` are set.
/// in_use  as from verticesInUse()
void assembleGroups(std::span<const Vec3> positions, std::span<const std::uint32_t> in_use, Findings findings,
                    const Placement& placement, VertexGroups& out);

/// Fills members and first_member from owners and member counts.
void listMembers(VertexGroups& groups);

/// Drops members whose owner is kNoIndex, then groups without members; renews ranges and the states free and defining.
void dropUngrouped(VertexGroups& groups);

}  // namespace sheaf::grouping
