// pipeline/cull: instances and patches against the view, before any vertex is touched.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/math.h"
#include "grouping/patches.h"
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

/// What a frame knows of one instance.
struct InstanceView {
  Mat4 clip_from_object;
  /// Inside where dot(plane, (p, 1)) >= 0, object space: the view volume, then the planes that vertices must be clipped
  /// by (near and far again, guard band).
  std::array<Vec4, 6> view_planes;
  std::array<Vec4, 4> guard_planes;
  Vec4 eye_object;  ///< as View::eye_world
  bool visible = true;
  bool mirrored = false;  ///< the transform turns the winding round
};

/// cull = false leaves `visible` true.
InstanceView viewInstance(const scenes::Instance& instance, const Box3& bounds_object, const View& view, bool cull);

enum class PatchVisibility : std::uint8_t { kOutside, kBackFacing, kStraddling, kInside };

/// kInside: no vertex of the patch needs clipping (it may reach beyond the edges of the picture, into the guard band).
/// back_faces_culled: false skips the cone test. Conservative: a visible patch is never kOutside.
PatchVisibility classifyPatch(const grouping::Patch& patch, const InstanceView& view, bool back_faces_culled);

}  // namespace sheaf::pipeline
