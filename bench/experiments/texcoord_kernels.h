// bench/experiments/texcoord_kernels: texture coordinates of a whole mesh, by a matrix or from positions, with and
// without groups. Structures of arrays; compiled twice: in plain C++ without vectors, and vectorised for AVX2 by GCC.
//   Out    retained ones first, then by group, as scalar_kernels.h
#pragma once

#include <cstdint>

#include "bench/experiments/scalar_kernels.h"

namespace sheaf::experiments {

/// u' = m[0] u + m[1] v + m[2], v' = m[3] u + m[4] v + m[5].
using TextureMatrix = float[6];
/// u = r[0] x + r[1] y + r[2] z + r[3], v likewise from r[4].
using TextureRows = float[8];

struct TexcoordsOut {
  float* u;
  float* v;
};

struct TexcoordKernels {
  void (*transform)(const float* u, const float* v, std::uint32_t count, const TextureMatrix& m, TexcoordsOut out);
  /// Lines through retained texture coordinates, which `out` has already; parameters by line.
  void (*transformLines)(const ScalarLine* lines, std::uint32_t line_count, const float* parameters,
                         std::uint32_t retained_count, TexcoordsOut out);
  void (*generate)(const float* const (&xyz)[3], std::uint32_t count, const TextureRows& rows, TexcoordsOut out);
  /// Planes of positions; `out` has what was made from the retained ones.
  void (*generatePlanes)(const ScalarPlane* planes, std::uint32_t plane_count, const float* s, const float* t,
                         std::uint32_t retained_count, const TextureRows& rows, TexcoordsOut out);
};

namespace plain {
extern const TexcoordKernels kTexcoords;
}
namespace vectors {
extern const TexcoordKernels kTexcoords;
}

}  // namespace sheaf::experiments
