// pipeline/cull: instances and patches against the view, before any vertex is touched.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math.h"
#include "grouping/patch_tree.h"
#include "grouping/patches.h"
#include "grouping/vertex_runs.h"
#include "pipeline/counters.h"
#include "pipeline/prepare.h"
#include "pipeline/transform.h"
#include "scenes/scene.h"

namespace sheaf::pipeline {

/// The camera of one frame.
struct View {
  DMat4 clip_from_world;
  DVec4 eye_world;  ///< homogeneous: w = 0 and a direction towards the eye for a parallel camera
  Viewport viewport;
};

/// The tests of outcodeVertex() as linear functions of a space that vertices are in: x, y, z and constant coefficients
/// of w + x, w - x, w + y, w - y, z, w - z, the four of the guard band, and w itself. A bit of Outcode belongs to each
/// but the last, which stands in for kOutNear.
struct alignas(64) RunPlanes {
  static constexpr std::size_t kCount = 11;
  float coefficient[4][16];
};

RunPlanes runPlanes(const Mat4& clip_from_space, const Viewport& viewport);

/// Of the sum of magnitudes: a bound of the rounding in a run's test and in the transform of its vertices.
inline constexpr float kCodeSlack = 16.0F / (1 << 24);

/// What a frame knows of one instance.
struct InstanceView {
  Mat4 clip_from_object;
  /// Inside where dot(plane, (p, 1)) >= 0, object space: the view volume, then the planes that vertices must be clipped
  /// by (near and far again, guard band).
  std::array<Vec4, 6> view_planes;
  std::array<Vec4, 4> guard_planes;
  RunPlanes run_planes;  ///< of object space
  Vec4 eye_object;       ///< as View::eye_world
  bool visible = true;
  bool mirrored = false;   ///< the transform turns the winding round
  bool culls_back = true;  ///< back faces are not drawn; the material decides, viewInstance() leaves it true
};

/// cull = false leaves `visible` true.
InstanceView viewInstance(const scenes::Instance& instance, const Box3& bounds_object, const View& view, bool cull);

enum class PatchVisibility : std::uint8_t {
  kOutside,
  kBackFacing,
  kStraddling,   ///< some vertex may need clipping
  kAcrossSides,  ///< none does, but some may lie beyond the edges of the picture, within the guard band
  kInside,       ///< wholly in view
};

/// By box, and by cone where back faces are culled. Conservative: a visible patch is never kOutside. The plain
/// reference of the two functions below.
PatchVisibility classifyPatch(const grouping::Patch& patch, const InstanceView& view);

/// What the view says of the boxes of a block, a bit for each.
struct BoxBits {
  std::uint32_t outside = 0;
  std::uint32_t clips = 0;    ///< crosses near, far or the guard band
  std::uint32_t crosses = 0;  ///< crosses an edge of the picture

  /// Of a box that is not outside.
  PatchVisibility visibilityOf(std::uint32_t lane) const {
    if ((clips >> lane & 1U) != 0) return PatchVisibility::kStraddling;
    return (crosses >> lane & 1U) != 0 ? PatchVisibility::kAcrossSides : PatchVisibility::kInside;
  }
};

/// A box around others is outside only if all of them are, and crosses a plane if one of them does: not only nearly,
/// because every operation of the test is monotone, rounding included.
BoxBits classifyBoxes(const grouping::BoxBlock& boxes, const InstanceView& view);
/// Bits of the patches that are seen from behind.
std::uint32_t findBackFacing(const grouping::BoxBlock& boxes, const grouping::ConeBlock& cones,
                             const InstanceView& view);

/// Outcodes of all members of a run at once: `must` has the bits that every member has, `may` those that any may have.
struct RunCodes {
  std::int32_t must;
  std::int32_t may;
};

/// Tests whole runs, by their rectangle, box or segment, before any vertex is touched ([PG] 3.2). Every outcode as
/// outcodeVertex() gives it contains `must` and is contained in `may`.
void codeRuns(std::span<const grouping::VertexRun> runs, const RunPlanes& planes, RunCodes* out);
/// The same for one run; the plain reference.
RunCodes codeRun(const grouping::VertexRun& run, const RunPlanes& planes);

}  // namespace sheaf::pipeline
