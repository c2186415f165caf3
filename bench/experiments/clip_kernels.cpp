#include "bench/experiments/clip_kernels.h"

#include <cstring>

namespace sheaf::experiments {
namespace {

constexpr int kPlanes = 6;

inline std::uint8_t codeOf(const Float4& p) {
  const int code = (p.w + p.x < 0.0F) | (p.w - p.x < 0.0F) << 1 | (p.w + p.y < 0.0F) << 2 | (p.w - p.y < 0.0F) << 3 |
                   (p.w + p.z < 0.0F) << 4 | (p.w - p.z < 0.0F) << 5;
  return static_cast<std::uint8_t>(code);
}

inline void heights(const Float4& p, float (&h)[kPlanes]) {
  h[0] = p.w + p.x, h[1] = p.w - p.x, h[2] = p.w + p.y, h[3] = p.w - p.y, h[4] = p.w + p.z, h[5] = p.w - p.z;
}

inline float least(float a, float b) {
  return a < b ? a : b;
}
inline float greatest(float a, float b) {
  return a > b ? a : b;
}

inline Float4 along(const Float4& a, const Float4& b, float s) {
  return {a.x + s * (b.x - a.x), a.y + s * (b.y - a.y), a.z + s * (b.z - a.z), a.w + s * (b.w - a.w)};
}

// Members [first, first + count): all alike, or one by one.
inline void finish(std::uint8_t all, std::uint8_t any, std::uint32_t first, std::uint32_t count, const Float4* clip,
                   std::uint8_t* codes, ClipCounts& counts) {
  if (any == 0 || all != 0) {
    std::memset(codes + first, all, count);
    ++(all != 0 ? counts.groups_rejected : counts.groups_accepted);
  } else {
    codeVertices(clip + first, count, codes + first);
    counts.vertices_coded += count;
  }
}

}  // namespace

void codeVertices(const Float4* clip, std::uint32_t count, std::uint8_t* codes) {
  for (std::uint32_t v = 0; v < count; ++v) codes[v] = codeOf(clip[v]);
}

void codeByGroup(const ScalarMesh& mesh, const ScalarRange* plane_ranges, const ScalarRange* line_ranges,
                 const float* matrix, const Float4* clip, std::uint8_t* codes, ClipCounts& counts) {
  codeVertices(clip, mesh.retained_count, codes);
  counts.vertices_coded += mesh.retained_count;
  float column[3][kPlanes];  // of a step along each axis
  for (int a = 0; a < 3; ++a)
    heights({matrix[4 * a], matrix[4 * a + 1], matrix[4 * a + 2], matrix[4 * a + 3]}, column[a]);
  std::uint32_t first = mesh.retained_count;
  for (std::uint32_t g = 0; g < mesh.plane_count; ++g) {
    const ScalarPlane& plane = mesh.planes[g];
    const ScalarRange& range = plane_ranges[g];
    const float *s = column[plane.axis_s], *t = column[plane.axis_t];
    float base[kPlanes];
    heights(clip[plane.origin], base);
    unsigned all = 0, any = 0;
    for (unsigned i = 0; i < kPlanes; ++i) {
      const float s0 = s[i] * range.s_min, s1 = s[i] * range.s_max, t0 = t[i] * range.t_min, t1 = t[i] * range.t_max;
      any |= unsigned{base[i] + least(s0, s1) + least(t0, t1) < 0.0F} << i;
      all |= unsigned{base[i] + greatest(s0, s1) + greatest(t0, t1) < 0.0F} << i;
    }
    counts.group_tests += 2 * kPlanes;
    finish(static_cast<std::uint8_t>(all), static_cast<std::uint8_t>(any), first, plane.count, clip, codes, counts);
    first += plane.count;
  }
  // Ends that are defining vertices have their codes already.
  for (std::uint32_t g = 0; g < mesh.line_count; ++g) {
    const ScalarLine& line = mesh.lines[g];
    const ScalarRange& range = line_ranges[g];
    std::uint8_t lo = codes[line.origin], hi = codes[line.end];
    if (range.s_min < 0.0F) {
      lo = codeOf(along(clip[line.origin], clip[line.end], range.s_min));
      counts.group_tests += kPlanes;
    }
    if (range.s_max > 1.0F) {
      hi = codeOf(along(clip[line.origin], clip[line.end], range.s_max));
      counts.group_tests += kPlanes;
    }
    finish(lo & hi, lo | hi, first, line.count, clip, codes, counts);
    first += line.count;
  }
}

}  // namespace sheaf::experiments
