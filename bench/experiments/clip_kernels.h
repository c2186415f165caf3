// bench/experiments/clip_kernels: outcodes of whole meshes in plain C++, one by one and by group; compiled without
// automatic vectorisation, as scalar_kernels.h.
#pragma once

#include <cstdint>

#include "bench/experiments/scalar_kernels.h"

namespace sheaf::experiments {

/// Ranges of a group's parameters; of lines t is not used.
struct ScalarRange {
  float s_min, s_max, t_min, t_max;
};

/// Each test compares one number with another.
struct ClipCounts {
  std::uint64_t group_tests = 0;
  std::uint64_t vertices_coded = 0;
  std::uint64_t groups_accepted = 0;
  std::uint64_t groups_rejected = 0;
};

/// The six tests of -w <= x, y, z <= w, bit by bit.
/// clip, codes  #count
void codeVertices(const Float4* clip, std::uint32_t count, std::uint8_t* codes);

/// Retained vertices one by one; groups by the ends of their segment or the bounds of their rectangle, and one by one
/// where that does not decide. Members of rejected groups get the bits that all of them have.
/// clip           transformed vertices, in the order of ScalarMesh
/// plane_ranges, line_ranges  beside the groups
void codeByGroup(const ScalarMesh& mesh, const ScalarRange* plane_ranges, const ScalarRange* line_ranges,
                 const float* matrix, const Float4* clip, std::uint8_t* codes, ClipCounts& counts);

}  // namespace sheaf::experiments
