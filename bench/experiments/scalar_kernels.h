// bench/experiments/scalar_kernels: transforms of whole meshes in plain C++, one vertex at a time, for the setting of
// [PG]: no vectors. scalar_kernels.cpp is compiled without automatic vectorisation, once for x86-64 as it was in 2005
// (SSE2 scalar instructions) and once with AVX's three operands and fused multiply-add.
//   In     matrices column by column, 16 floats; arrays of structures
//   Out    vertices in their order, retained ones first; then by group. Nothing is scattered: meshes are renumbered
#pragma once

#include <cstdint>

namespace sheaf::experiments {

struct Float2 {
  float s, t;
};
struct Float3 {
  float x, y, z;
};
struct Float4 {
  float x, y, z, w;
};

/// Members of a plane: base + s * column axis_s + t * column axis_t.
struct ScalarPlane {
  std::uint32_t origin;  ///< among the retained
  std::uint32_t axis_s;
  std::uint32_t axis_t;
  std::uint32_t count;
};
/// Members of a line: V1 + s (V2 - V1).
struct ScalarLine {
  std::uint32_t origin;
  std::uint32_t end;
  std::uint32_t count;
};

/// A mesh, grouped or not, as the transforms read it. Of `retained` there is one form in use: w = 1 in memory, or not.
struct ScalarMesh {
  const Float4* retained4;
  const Float3* retained3;
  std::uint32_t retained_count;
  const ScalarPlane* planes;
  std::uint32_t plane_count;
  const ScalarLine* lines;
  std::uint32_t line_count;
  const Float2* plane_parameters;
  const float* line_parameters;
};

/// What a transform computes.
enum class ScalarForm : std::uint8_t {
  kHomogeneous,  ///< 16 products for (x, y, z, w); all four components of a member
  kRebuild3,     ///< the same, but of members x, y, z; their w is copied: for affine matrices
  kKnownW,       ///< w = 1 need not be multiplied: 12 products; all four components of a member
  kAffine,       ///< three rows: 9 products; three components
};
inline constexpr int kScalarForms = 4;

/// Transforms the mesh into `out`, which has four floats for each vertex (three in kAffine).
using ScalarTransform = void (*)(const ScalarMesh& mesh, const float* matrix, float* out);

/// By form.
namespace sse2 {
extern const ScalarTransform kTransforms[kScalarForms];
}
namespace fma {
extern const ScalarTransform kTransforms[kScalarForms];
}

}  // namespace sheaf::experiments
