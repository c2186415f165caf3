#include "raster/setup.h"

#include <algorithm>

#include "raster/edges.h"
#include "raster/setup_one.h"

namespace sheaf::raster {

PixelBox pixelBox(const std::int32_t (&x_fx)[3], const std::int32_t (&y_fx)[3], int width, int height) {
  const auto [x_lo, x_hi] = std::minmax({x_fx[0], x_fx[1], x_fx[2]});
  const auto [y_lo, y_hi] = std::minmax({y_fx[0], y_fx[1], y_fx[2]});
  constexpr int kHalf = kSubpixels / 2;
  return {std::max(0, (x_lo + kHalf - 1) >> kSubpixelBits), std::max(0, (y_lo + kHalf - 1) >> kSubpixelBits),
          std::min(width - 1, (x_hi - kHalf) >> kSubpixelBits), std::min(height - 1, (y_hi - kHalf) >> kSubpixelBits)};
}

std::int64_t doubleArea(const std::int32_t (&x)[3], const std::int32_t (&y)[3]) {
  return std::int64_t{x[1] - x[0]} * (y[2] - y[0]) - std::int64_t{x[2] - x[0]} * (y[1] - y[0]);
}

namespace {

// E and its steps at the centre of the reference pixel, unbiased: what the planes are made of.
struct EdgeAtReference {
  float a, b, e;
};

EdgeAtReference edgeAtReference(const std::int32_t (&x)[3], const std::int32_t (&y)[3], int i, const PixelBox& box) {
  const int j = i == 2 ? 0 : i + 1;
  const int k = i == 0 ? 2 : i - 1;
  const std::int32_t a = y[j] - y[k];
  const std::int32_t b = x[k] - x[j];
  const std::int32_t cx = box.x_min * kSubpixels + kSubpixels / 2;
  const std::int32_t cy = box.y_min * kSubpixels + kSubpixels / 2;
  const std::int64_t e = std::int64_t{a} * (cx - x[j]) + std::int64_t{b} * (cy - y[j]);
  return {static_cast<float>(a), static_cast<float>(b), static_cast<float>(e)};
}

DepthPlane depthPlane(const EdgeAtReference& e1, const EdgeAtReference& e2, float inv_area, const float (&z)[3]) {
  const float d1 = z[1] - z[0];
  const float d2 = z[2] - z[0];
  const float inv_area_px = inv_area * kSubpixels;
  return {z[0] + (e1.e * d1 + e2.e * d2) * inv_area, (e1.a * d1 + e2.a * d2) * inv_area_px,
          (e1.b * d1 + e2.b * d2) * inv_area_px, std::min(std::min(z[0], z[1]), z[2]),
          std::max(std::max(z[0], z[1]), z[2])};
}

// Bit 4 * row + column: which of the 4x4 pixels at the box's corner are covered, within the box.
std::uint16_t smallMask(const PixelEdge (&edges)[3], const PixelBox& box) {
  unsigned mask = 0;
  for (int y = 0; y <= box.y_max - box.y_min; ++y)
    for (int x = 0; x <= box.x_max - box.x_min; ++x)
      if (edges[0].at(x, y) >= 0 && edges[1].at(x, y) >= 0 && edges[2].at(x, y) >= 0) mask |= 1U << (4 * y + x);
  return static_cast<std::uint16_t>(mask);
}

// Bins a triangle of positive area. Returns false if it covers no sample. `shade` is asked for only if it does.
template <typename ShadeIndex>
bool binTriangle(const std::int32_t (&x)[3], const std::int32_t (&y)[3], const float (&z)[3], std::int64_t area,
                 const PixelBox& box, Binner& binner, const ShadeIndex& shade) {
  const PixelEdge edges[3] = {pixelEdge(x, y, 0, box.x_min, box.y_min), pixelEdge(x, y, 1, box.x_min, box.y_min),
                              pixelEdge(x, y, 2, box.x_min, box.y_min)};
  const bool small = isSmall(box);
  const std::uint16_t mask = small ? smallMask(edges, box) : std::uint16_t{0};
  if (small && mask == 0) return false;
  const DepthPlane plane =
      depthPlane(edgeAtReference(x, y, 1, box), edgeAtReference(x, y, 2, box), 1.0F / static_cast<float>(area), z);
  const auto ref_x = static_cast<std::int16_t>(box.x_min);
  const auto ref_y = static_cast<std::int16_t>(box.y_min);
  if (small) {
    binner.addSmall({ref_x, ref_y, mask, 0, plane, shade()});
  } else {
    binner.addLarge({{edges[0], edges[1], edges[2]},
                     ref_x,
                     ref_y,
                     static_cast<std::int16_t>(box.x_max),
                     static_cast<std::int16_t>(box.y_max),
                     plane,
                     shade()});
  }
  return true;
}

}  // namespace

void setupOne(const ScreenVertex* vertices, const PatchTriangles& triangles, std::uint32_t t, Binner& binner,
              SetupCounts& counts) {
  std::uint32_t v[3] = {triangles.corner[0][t], triangles.corner[1][t], triangles.corner[2][t]};
  std::int32_t x[3] = {vertices[v[0]].x_fx, vertices[v[1]].x_fx, vertices[v[2]].x_fx};
  std::int32_t y[3] = {vertices[v[0]].y_fx, vertices[v[1]].y_fx, vertices[v[2]].y_fx};
  std::int64_t area = doubleArea(x, y);
  const bool back = (area > 0) != (triangles.facing.front_sign > 0);
  if (area == 0 || (back && triangles.facing.cull_back)) {
    ++counts.back_facing;
    return;
  }
  const PixelBox box = pixelBox(x, y, binner.width(), binner.height());
  if (box.x_min > box.x_max || box.y_min > box.y_max) {
    ++counts.no_sample;
    return;
  }
  const bool turned = area < 0;
  if (turned) {
    std::swap(v[1], v[2]);
    std::swap(x[1], x[2]);
    std::swap(y[1], y[2]);
    area = -area;
  }
  const float z[3] = {vertices[v[0]].depth, vertices[v[1]].depth, vertices[v[2]].depth};
  const bool binned = binTriangle(x, y, z, area, box, binner, [&] {
    const std::uint32_t index = binner.newShadeTriangle();
    ShadeTriangle& shade = binner.shadeTriangle(index);
    const float inv_area = 1.0F / static_cast<float>(area);
    for (int i = 0; i < 3; ++i) {
      const EdgeAtReference edge = edgeAtReference(x, y, i, box);
      const float scale = inv_area * vertices[v[i]].inv_w;
      const int corner = turned && i > 0 ? 3 - i : i;  // shading wants the mesh's own order
      shade.u0[corner] = edge.e * scale;
      shade.ux[corner] = edge.a * (scale * kSubpixels);
      shade.uy[corner] = edge.b * (scale * kSubpixels);
      shade.vertex[corner] = triangles.first_vertex + v[i];
    }
    shade.ref_x = static_cast<std::int16_t>(box.x_min);
    shade.ref_y = static_cast<std::int16_t>(box.y_min);
    shade.surface = triangles.surface;
    shade.triangle = triangles.source[t];
    shade.back_face = back ? 1 : 0;
    return index;
  });
  ++(binned ? counts.binned : counts.no_sample);
}

void setupTrianglesReference(const ScreenVertex* vertices, const PatchTriangles& triangles, Binner& binner,
                             SetupCounts& counts) {
  for (std::uint32_t t = 0; t < triangles.count; ++t) setupOne(vertices, triangles, t, binner, counts);
}

int setupClippedPiece(const std::array<ScreenCorner, 3>& corners, const Facing& facing, std::uint32_t shade,
                      Binner& binner, SetupCounts& counts) {
  std::int32_t x[3] = {corners[0].x_fx, corners[1].x_fx, corners[2].x_fx};
  std::int32_t y[3] = {corners[0].y_fx, corners[1].y_fx, corners[2].y_fx};
  float z[3] = {corners[0].depth, corners[1].depth, corners[2].depth};
  std::int64_t area = doubleArea(x, y);
  const int sign = area > 0 ? 1 : area < 0 ? -1 : 0;
  if (sign == 0 || (sign != facing.front_sign && facing.cull_back)) {
    ++counts.back_facing;
    return sign;
  }
  const PixelBox box = pixelBox(x, y, binner.width(), binner.height());
  if (box.x_min > box.x_max || box.y_min > box.y_max) {
    ++counts.no_sample;
    return sign;
  }
  if (area < 0) {
    std::swap(x[1], x[2]);
    std::swap(y[1], y[2]);
    std::swap(z[1], z[2]);
    area = -area;
  }
  const bool binned = binTriangle(x, y, z, area, box, binner, [shade] { return shade; });
  ++(binned ? counts.binned : counts.no_sample);
  return sign;
}

}  // namespace sheaf::raster
