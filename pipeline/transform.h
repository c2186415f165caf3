// pipeline/transform: the vertices of one patch from object space to clip space to the screen.
#pragma once

#include <array>
#include <cstdint>

#include "core/math.h"
#include "grouping/vertex_runs.h"
#include "raster/setup.h"

namespace sheaf::pipeline {

inline constexpr std::uint32_t kMaxPatchVertices = 256;
/// Kernels work on whole vectors, so that they may write this many vertices beyond the last.
inline constexpr std::uint32_t kVertexSlots = kMaxPatchVertices + grouping::kRunAlignment;

/// Outcode bits. A triangle whose three corners share one of the first six is outside the view volume; one of whose
/// corners has a bit of kClipBits must be clipped.
enum Outcode : std::int32_t {
  kOutLeft = 1 << 0,    // x < -w
  kOutRight = 1 << 1,   // x > w
  kOutBottom = 1 << 2,  // y < -w
  kOutTop = 1 << 3,     // y > w
  kOutFar = 1 << 4,     // z < 0
  kOutNear = 1 << 5,    // z > w; also wherever w <= 0
  kGuardLeft = 1 << 6,  // x < -guard.x * w, and so on
  kGuardRight = 1 << 7,
  kGuardBottom = 1 << 8,
  kGuardTop = 1 << 9,
  kOutsideBits = (1 << 6) - 1,
  kClipBits = kOutFar | kOutNear | kGuardLeft | kGuardRight | kGuardBottom | kGuardTop,
};

/// From normalised device coordinates to pixels, and how far beyond the view vertices may lie.
struct Viewport {
  float half_width_px;
  float half_height_px;
  float guard_x;  ///< in units of w
  float guard_y;

  Viewport(int width, int height);
};

/// Clip coordinates of a patch, structure of arrays.
struct alignas(64) ClipVertices {
  float x[kVertexSlots];
  float y[kVertexSlots];
  float z[kVertexSlots];
  float w[kVertexSlots];
};

/// Screen coordinates of a patch; meaningless where w <= 0 and beyond the guard band.
using ProjectedVertices = std::array<raster::ScreenVertex, kVertexSlots>;

struct OutcodeSummary {
  std::int32_t all;  ///< AND over the vertices
  std::int32_t any;  ///< OR over the vertices
};

/// Where a run of a patch begins.
struct RunStart {
  std::uint32_t vertex = 0;     ///< local number of its first vertex
  std::uint32_t full = 0;       ///< into VertexRuns::full, where it is stored in full; else
  std::uint32_t parameter = 0;  ///< into VertexRuns::quantised or parameters

  explicit RunStart(const grouping::PatchRuns& patch) : full(patch.first_full), parameter(patch.first_parameter) {}
  void skip(const grouping::VertexRun& run) {
    vertex += run.vertex_count;
    (run.kind == grouping::RunKind::kFull ? full : parameter) += run.vertex_count;
  }
};

/// Vertices [begin, end) of a run, counted from its first.
struct RunPiece {
  const grouping::VertexRun& run;
  RunStart start;
  std::uint32_t begin, end;

  /// Local numbers.
  std::uint32_t firstVertex() const { return start.vertex + begin; }
  std::uint32_t endVertex() const { return start.vertex + end; }
};

/// Clip space from the space of a patch's planes: its frame, or else object space.
Mat4 clipFromPlanes(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch, const Mat4& clip_from_object);

/// All vertices of a patch straight to the screen: those in full by the matrix, others from their plane or line ([PG]
/// eqs. 1, 2). For patches that need no clipping: clip coordinates do not leave the registers.
void transformPatch(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch, const Mat4& clip_from_object,
                    const Viewport& viewport, ProjectedVertices& out);

/// Vertices of one run to clip space; nothing else of `out` is written.
void transformRun(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch, const RunPiece& piece,
                  const Mat4& clip_from_object, ClipVertices& out);

/// Vertices [begin, end) of the patch; writes beyond, to the end of a vector, what it finds there.
void projectVertices(const ClipVertices& vertices, std::uint32_t begin, std::uint32_t end, const Viewport& viewport,
                     ProjectedVertices& out);
/// codes  kVertexSlots
OutcodeSummary outcodeVertices(const ClipVertices& vertices, std::uint32_t begin, std::uint32_t end,
                               const Viewport& viewport, std::int32_t* codes);

/// Plain references: one vertex with the same operations in the same order, so that results are equal to the bit.
Vec4 transformVertex(const Vec3& position, const Mat4& clip_from_object);
/// A vertex of a plane or line from its parameters as they are stored; t is not used for lines.
struct StoredParameters {
  float s, t;  ///< form kFloat; of k16Bit the whole numbers
};
Vec4 transformGrouped(const grouping::VertexRuns& runs, const grouping::PatchRuns& patch,
                      const grouping::VertexRun& run, const StoredParameters& parameters, const Mat4& clip_from_object);
raster::ScreenVertex projectVertex(const Vec4& clip, const Viewport& viewport);
std::int32_t outcodeVertex(const Vec4& clip, const Viewport& viewport);

}  // namespace sheaf::pipeline
