// Compiled twice, into namespace SHEAF_TEXCOORDS. No headers with inline functions: see scalar_kernels.cpp.
#include "bench/experiments/texcoord_kernels.h"

namespace sheaf::experiments::SHEAF_TEXCOORDS {
namespace {

void transform(const float* __restrict u, const float* __restrict v, std::uint32_t count, const TextureMatrix& matrix,
               TexcoordsOut out) {
  const float a = matrix[0], b = matrix[1], c = matrix[2], d = matrix[3], e = matrix[4], f = matrix[5];
  float* __restrict out_u = out.u, * __restrict out_v = out.v;
  for (std::uint32_t i = 0; i < count; ++i) {
    out_u[i] = a * u[i] + b * v[i] + c;
    out_v[i] = d * u[i] + e * v[i] + f;
  }
}

void transformLines(const ScalarLine* lines, std::uint32_t line_count, const float* parameters,
                    std::uint32_t retained_count, TexcoordsOut out) {
  std::uint32_t first = retained_count;
  for (std::uint32_t g = 0; g < line_count; ++g) {
    const ScalarLine line = lines[g];
    const float u = out.u[line.origin], v = out.v[line.origin];
    const float du = out.u[line.end] - u, dv = out.v[line.end] - v;
    const float* __restrict s = parameters;
    float* __restrict out_u = out.u + first, * __restrict out_v = out.v + first;
    for (std::uint32_t i = 0; i < line.count; ++i) {
      out_u[i] = u + s[i] * du;
      out_v[i] = v + s[i] * dv;
    }
    first += line.count;
    parameters += line.count;
  }
}

void generate(const float* const (&xyz)[3], std::uint32_t count, const TextureRows& rows, TexcoordsOut out) {
  const float* __restrict x = xyz[0], * __restrict y = xyz[1], * __restrict z = xyz[2];
  float* __restrict out_u = out.u, * __restrict out_v = out.v;
  const float a = rows[0], b = rows[1], c = rows[2], d = rows[3], e = rows[4], f = rows[5], g = rows[6], h = rows[7];
  for (std::uint32_t i = 0; i < count; ++i) {
    out_u[i] = a * x[i] + b * y[i] + c * z[i] + d;
    out_v[i] = e * x[i] + f * y[i] + g * z[i] + h;
  }
}

void generatePlanes(const ScalarPlane* planes, std::uint32_t plane_count, const float* s, const float* t,
                    std::uint32_t retained_count, const TextureRows& rows, TexcoordsOut out) {
  std::uint32_t first = retained_count;
  for (std::uint32_t g = 0; g < plane_count; ++g) {
    const ScalarPlane plane = planes[g];
    const float u = out.u[plane.origin], v = out.v[plane.origin];
    const float us = rows[plane.axis_s], ut = rows[plane.axis_t];
    const float vs = rows[4 + plane.axis_s], vt = rows[4 + plane.axis_t];
    const float* __restrict at_s = s, * __restrict at_t = t;
    float* __restrict out_u = out.u + first, * __restrict out_v = out.v + first;
    for (std::uint32_t i = 0; i < plane.count; ++i) {
      out_u[i] = u + at_s[i] * us + at_t[i] * ut;
      out_v[i] = v + at_s[i] * vs + at_t[i] * vt;
    }
    first += plane.count;
    s += plane.count;
    t += plane.count;
  }
}

}  // namespace

extern const TexcoordKernels kTexcoords = {transform, transformLines, generate, generatePlanes};

}  // namespace sheaf::experiments::SHEAF_TEXCOORDS
