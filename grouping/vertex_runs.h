// grouping/vertex_runs: how the vertices of patches are stored for drawing: in runs that share a plane or a line, so
// that each vertex needs two or one parameters in place of three coordinates ([PG] eqs. 1, 2).
//   Form   A patch has at most one run of vertices in full, then one per plane or line. In a run on the plane x_k = c
//          the base of [PG] eq. 2 is the plane's point with zeros elsewhere and s, t are the other two coordinates as
//          they are, so that a vertex is transformed by the products and sums of transforming (x, y, z) in full, of
//          which those with c are made once: the results are equal to the bit.
//   Frames A patch may have a frame of its own, in which all its planes are z = c; its vertices in full and its lines
//          stay in object space.
//   16 bit Coordinates on planes are multiples of a power of two, so that n * step is exact and so is scaling the
//          matrix by step. The grid is one for the whole mesh and counted from each patch's corner: patches that share
//          a vertex have it at the same place.
//   Keeps  a vertex gets the same clip coordinates in every patch that uses it; deterministic
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/aligned.h"
#include "core/math.h"
#include "core/task_pool.h"
#include "grouping/patches.h"
#include "grouping/vertex_groups.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

enum class RunKind : std::uint8_t {
  kFull,   ///< three coordinates
  kPlane,  ///< two; the third is the run's
  kLine,   ///< one parameter
};

/// How parameters are stored.
enum class ParameterForm : std::uint8_t { k16Bit, kFloat };

/// The two coordinates beside `axis`, ascending.
constexpr std::pair<std::size_t, std::size_t> axesBeside(std::size_t axis) {
  return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
}

/// Object space from a patch's own: origin + x axis_s + y axis_t + z normal.
struct PatchFrame {
  Vec3 origin{0.0F};
  PlaneFrame axes{{0.0F, 0.0F, 1.0F}, {1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}};
};

/// Consecutive vertices of a patch that are stored alike.
struct VertexRun {
  RunKind kind = RunKind::kFull;
  std::uint8_t axis = 0;             ///< kPlane: which coordinate is common; 2 in a patch's own frame
  std::uint16_t vertex_count = 0;    ///< [1, 256]
  std::uint16_t triangle_count = 0;  ///< triangles with all corners in this run; they stand together, run by run
  float plane = 0.0F;                ///< kPlane: its value
  std::uint32_t line = kNoIndex;     ///< kLine: into VertexRuns::lines
  Vec3 corner_lo{0.0F};              ///< box of the vertices, of a plane in its space; of a line: the end of least s
  Vec3 corner_hi{0.0F};              ///< of a line: the end of greatest s
};

/// Points base + s * direction, s = s0 + q * ds for a stored q.
struct RunLine {
  Vec3 base;
  Vec3 direction;
  float s0 = 0.0F;
  float ds = 0.0F;
};

/// Where the vertices of one patch are in the arrays of VertexRuns. Runs follow each other in all of them.
struct PatchRuns {
  std::uint32_t first_run = 0;
  std::uint32_t run_count = 0;
  std::uint32_t first_full = 0;
  std::uint32_t first_parameter = 0;
  std::array<std::int32_t, 3> corner{};  ///< of 16-bit coordinates: coordinate = (corner + q) * step
  std::uint32_t frame = kNoIndex;        ///< of its planes, into VertexRuns::frames; kNoIndex: object space
};

/// Arrays are readable kRunAlignment elements beyond their last vertex.
struct VertexRuns {
  std::vector<PatchRuns> patches;  ///< #patches
  std::vector<VertexRun> runs;     ///< by patch: full ones, planes, lines
  std::vector<RunLine> lines;
  std::vector<PatchFrame> frames;
  /// Vertices stored in full: all x, then all y, then all z, full_stride apart, so that each is one stream of memory
  /// from patch to patch, and long stretches begin a cache line. Where nothing is grouped they are indexed as
  /// PatchSet::vertex_source, padding included.
  AlignedVector<float> full;
  std::size_t full_stride = 0;
  /// Form k16Bit: s in the lower half, t in the upper one, so that a patch is one stream of memory; lines have t = 0.
  AlignedVector<std::uint32_t> quantised;
  AlignedVector<Vec2> parameters;  ///< form kFloat: (s, t)
  ParameterForm form = ParameterForm::k16Bit;
  float step = 1.0F;  ///< of 16-bit coordinates on planes; a power of two

  bool isFullBySlot() const { return quantised.empty() && parameters.empty(); }
  std::uint64_t bytes() const;
};

/// Where a vertex lies when it is drawn.
struct VertexPlace {
  RunKind kind = RunKind::kFull;
  std::uint8_t axis = 0;
  float plane = 0.0F;
  std::uint32_t line = kNoIndex;
  float s = 0.0F;  ///< kLine: its parameter

  bool sharesRunWith(const VertexPlace& other) const {
    return kind == other.kind && axis == other.axis && plane == other.plane && line == other.line;
  }
};

/// A mesh whose vertices have been given their places.
struct PlacedVertices {
  std::vector<Vec3> positions;      ///< #V
  std::vector<VertexPlace> places;  ///< #V
  std::vector<RunLine> lines;
  std::vector<PatchFrame> frames;  ///< #patches, or empty: planes are in object space
  std::vector<Vec3> in_frame;      ///< #V if there are frames: of vertices on planes, (s, t, plane) in their patch's
  ParameterForm form = ParameterForm::k16Bit;
  float step = 1.0F;

  /// In the space of its plane.
  const Vec3& coordinatesOf(std::uint32_t v) const {
    return frames.empty() || places[v].kind != RunKind::kPlane ? positions[v] : in_frame[v];
  }
};

/// Vertices where a grouping puts them. By distance on axis planes, a vertex goes to that plane within epsilon which
/// takes the most vertices of its patch, for long runs; in all other cases to the plane or line of its group. Defining
/// vertices of planes lie on one of their own planes. k16Bit moves coordinates on planes to the grid.
/// groups  of this mesh; planes must be axisPlanes()
PlacedVertices placeGrouped(const mesh::Mesh& mesh, const VertexGroups& groups, const PatchSet& patches,
                            ParameterForm form);

/// The same, every vertex on the plane or line of its own group: as saved groups have it. Meshes that were grouped as
/// one and are drawn apart then fit together.
PlacedVertices placeOnGroups(const VertexGroups& groups, const PatchSet& patches, ParameterForm form);

/// The same for groups of groupInPatches() or framedByPatch(), made of this mesh and these patches.
PlacedVertices placeInFrames(const mesh::Mesh& mesh, const VertexGroups& groups, const PatchSet& patches,
                             ParameterForm form);

/// One run per patch, of all its vertices in full, in their order.
VertexRuns ungroupedRuns(const mesh::Mesh& mesh, const PatchSet& patches, TaskPool& pool);

/// Reorders the patches' vertices and triangles into runs.
/// min_plane_run  planes with fewer vertices of a patch are stored in full there; any number beyond 256: all of them
VertexRuns buildVertexRuns(const PlacedVertices& placed, std::uint32_t min_plane_run, PatchSet& patches,
                           TaskPool& pool);

}  // namespace sheaf::grouping
