// pipeline/transform: the vertices of one patch from object space to clip space to the screen.
#pragma once

#include <array>
#include <cstdint>

#include "core/math.h"

namespace sheaf::pipeline {

inline constexpr std::uint32_t kMaxPatchVertices = 256;

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
  float x[kMaxPatchVertices];
  float y[kMaxPatchVertices];
  float z[kMaxPatchVertices];
  float w[kMaxPatchVertices];
};

/// Screen coordinates of a patch; meaningless where w <= 0.
struct alignas(64) ProjectedVertices {
  std::int32_t x_fx[kMaxPatchVertices];
  std::int32_t y_fx[kMaxPatchVertices];
  float depth[kMaxPatchVertices];
  float inv_w[kMaxPatchVertices];
};

struct OutcodeSummary {
  std::int32_t all;  ///< AND over the vertices
  std::int32_t any;  ///< OR over the vertices
};

/// position  x, y, z: readable up to the next multiple of 16 of `count`; so are all arrays here
void transformVertices(const std::array<const float*, 3>& position, std::uint32_t count, const Mat4& clip_from_object,
                       ClipVertices& out);
void projectVertices(const ClipVertices& vertices, std::uint32_t count, const Viewport& viewport,
                     ProjectedVertices& out);
OutcodeSummary outcodeVertices(const ClipVertices& vertices, std::uint32_t count, const Viewport& viewport,
                               std::int32_t* codes);

/// Plain references: one vertex with the same operations in the same order, so that results are equal to the bit.
Vec4 transformVertex(const Vec3& position, const Mat4& clip_from_object);
struct ProjectedVertex {
  std::int32_t x_fx, y_fx;
  float depth, inv_w;
};
ProjectedVertex projectVertex(const Vec4& clip, const Viewport& viewport);
std::int32_t outcodeVertex(const Vec4& clip, const Viewport& viewport);

}  // namespace sheaf::pipeline
