// Compiled twice, into namespace SHEAF_SCALAR. No header with inline functions here: they would be shared with sources
// that have other flags.
#include "bench/experiments/scalar_kernels.h"

#include <cstddef>

namespace sheaf::experiments::SHEAF_SCALAR {
namespace {

// One row of the matrix times one vertex, its w as in memory or known to be 1.
inline float product(const float* m, const Float4& p) {
  return m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12] * p.w;
}
inline float product(const float* m, const Float3& p) {
  return m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12];
}

// Retained vertices, and all of a mesh without groups. The matrix does not fit into the registers; reading each element
// once for two or four vertices was no faster.
template <int kRows, class Vertex>
[[gnu::always_inline]] inline void transformRetained(const Vertex* in, std::uint32_t count, const float* matrix,
                                                     float* out) {
  float m[16];  // a copy, which stores to `out` cannot change
  for (int i = 0; i < 16; ++i) m[i] = matrix[i];
  for (const Vertex* const end = in + count; in != end; ++in, out += kRows) {
    const Vertex v = *in;
    for (int r = 0; r < kRows; ++r) out[r] = product(m + r, v);
  }
}

// [PG] eq. 2. Base and columns stay in registers. kBuilt components are computed, others copied.
template <int kBuilt, int kRows>
[[gnu::always_inline]] inline float* transformPlanes(const ScalarMesh& mesh, const float* m, const float* retained,
                                                     float* __restrict out) {
  const Float2* __restrict parameter = mesh.plane_parameters;
  const ScalarPlane* const end = mesh.planes + mesh.plane_count;
  for (const ScalarPlane* plane = mesh.planes; plane != end; ++plane) {
    const float* const v1 = retained + std::size_t{plane->origin} * kRows;
    const float* const along_s = m + std::size_t{plane->axis_s} * 4;
    const float* const along_t = m + std::size_t{plane->axis_t} * 4;
    float base[kRows], s[kBuilt], t[kBuilt];
    for (int r = 0; r < kRows; ++r) base[r] = v1[r];
    for (int r = 0; r < kBuilt; ++r) s[r] = along_s[r], t[r] = along_t[r];
    for (std::size_t left = plane->count; left != 0; --left, ++parameter, out += kRows) {
      const Float2 at = *parameter;
      for (int r = 0; r < kBuilt; ++r) out[r] = base[r] + at.s * s[r] + at.t * t[r];
      for (int r = kBuilt; r < kRows; ++r) out[r] = base[r];
    }
  }
  return out;
}

// [PG] eq. 1.
template <int kBuilt, int kRows>
[[gnu::always_inline]] inline void transformLines(const ScalarMesh& mesh, const float* retained,
                                                  float* __restrict out) {
  const float* __restrict parameter = mesh.line_parameters;
  const ScalarLine* const end = mesh.lines + mesh.line_count;
  for (const ScalarLine* line = mesh.lines; line != end; ++line) {
    const float* const v1 = retained + std::size_t{line->origin} * kRows;
    const float* const v2 = retained + std::size_t{line->end} * kRows;
    float base[kRows], along[kBuilt];
    for (int r = 0; r < kRows; ++r) base[r] = v1[r];
    for (int r = 0; r < kBuilt; ++r) along[r] = v2[r] - v1[r];
    for (std::size_t left = line->count; left != 0; --left, ++parameter, out += kRows) {
      for (int r = 0; r < kBuilt; ++r) out[r] = base[r] + *parameter * along[r];
      for (int r = kBuilt; r < kRows; ++r) out[r] = base[r];
    }
  }
}

template <ScalarForm kForm>
void transform(const ScalarMesh& mesh, const float* m, float* out) {
  constexpr int kRows = kForm == ScalarForm::kAffine ? 3 : 4;
  constexpr int kBuilt = kForm == ScalarForm::kRebuild3 ? 3 : kRows;
  constexpr bool kStoredW = kForm == ScalarForm::kHomogeneous || kForm == ScalarForm::kRebuild3;
  if constexpr (kStoredW)
    transformRetained<kRows>(mesh.retained4, mesh.retained_count, m, out);
  else
    transformRetained<kRows>(mesh.retained3, mesh.retained_count, m, out);
  float* const lines = transformPlanes<kBuilt, kRows>(mesh, m, out, out + mesh.retained_count * kRows);
  transformLines<kBuilt, kRows>(mesh, out, lines);
}

}  // namespace

extern const ScalarTransform kTransforms[kScalarForms] = {
    transform<ScalarForm::kHomogeneous>, transform<ScalarForm::kRebuild3>, transform<ScalarForm::kKnownW>,
    transform<ScalarForm::kAffine>};

}  // namespace sheaf::experiments::SHEAF_SCALAR
