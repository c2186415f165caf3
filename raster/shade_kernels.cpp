#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>

#include <hwy/cache_control.h>

#include "raster/shade.h"
#include "raster/srgb.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/shade_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "raster/shade_fetch-inl.h"
#include "raster/srgb-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sheaf::raster::HWY_NAMESPACE {

/// Linear colours of a block, in the order of tileIndex().
struct BlockColors {
  alignas(64) float r[kBlockPixels];
  alignas(64) float g[kBlockPixels];
  alignas(64) float b[kBlockPixels];
};

/// A block of a tile on its way to the image.
struct Block {
  const std::uint32_t* triangle;  ///< kBlockPixels
  std::int32_t x;                 ///< of the top left pixel in the frame
  std::int32_t y;
  std::uint64_t covered;  ///< pixels to shade, bits in the order of tileIndex()
  BlockColors colors;
};

struct SurfaceJob;
using BlockKernel = std::uint64_t (*)(const SurfaceJob& job, Block& block, std::uint64_t pending,
                                      BlockTriangles& fetched);

/// What is the same for all pixels of a surface.
struct SurfaceJob {
  const ShadeScene* scene;
  const Surface* surface;
  const ShadeMaterial* material;
  BlockKernel kernel;
  std::uint32_t surface_id;
  float world_from_object_normal[9];  ///< by columns, the largest entry scaled to 1
  Vec3 ambient_middle;                ///< of a horizontal normal
  Vec3 ambient_rise;                  ///< from there to straight up
};

/// Barycentric coordinates of each pixel centre, perspective-correct.
HWY_INLINE void Barycentrics(const TriangleLanes& lanes, VI x, VI y, VF& b0, VF& b1, VF& b2) {
  const DF d;
  const VI ref = hn::BitCast(DI(), lanes.words(kRef));
  const VF dx = hn::ConvertTo(d, hn::Sub(x, hn::ShiftRight<16>(hn::ShiftLeft<16>(ref))));
  const VF dy = hn::ConvertTo(d, hn::Sub(y, hn::ShiftRight<16>(ref)));
  const auto plane = [&](int corner) {
    const VF along_x = hn::Mul(lanes.floats(kUx + corner), dx);
    const VF along_y = hn::Mul(lanes.floats(kUy + corner), dy);
    return hn::Add(hn::Add(lanes.floats(kU0 + corner), along_x), along_y);
  };
  const VF u0 = plane(0);
  const VF u1 = plane(1);
  const VF u2 = plane(2);
  const VF inverse_sum = hn::Div(Constant(1.0F), hn::Add(hn::Add(u0, u1), u2));
  b0 = hn::Mul(u0, inverse_sum);
  b1 = hn::Mul(u1, inverse_sum);
  b2 = hn::Mul(u2, inverse_sum);
}

HWY_INLINE VF Blend(VF b0, VF b1, VF b2, VF a0, VF a1, VF a2) {
  return Dot(b0, b1, b2, a0, a1, a2);
}

/// Interpolated object-space normal of any length.
HWY_INLINE void SmoothNormal(const TriangleLanes& lanes, VF b0, VF b1, VF b2, VF& nx, VF& ny, VF& nz) {
  const auto component = [&](int axis) {
    return Blend(b0, b1, b2, lanes.normals(0, axis), lanes.normals(1, axis), lanes.normals(2, axis));
  };
  nx = component(0);
  ny = component(1);
  nz = component(2);
}

/// The triangle's own object-space normal, of any length.
HWY_INLINE void FlatNormal(const Surface& surface, const TriangleLanes& lanes, VF& nx, VF& ny, VF& nz) {
  const DF d;
  const VI v0 = lanes.vertices(0);
  const VI v1 = lanes.vertices(1);
  const VI v2 = lanes.vertices(2);
  const auto edge = [&](int axis, VI to) {
    const float* position = surface.position_object[static_cast<std::size_t>(axis)];
    return hn::Sub(hn::GatherIndex(d, position, to), hn::GatherIndex(d, position, v0));
  };
  const VF ax = edge(0, v1);
  const VF ay = edge(1, v1);
  const VF az = edge(2, v1);
  const VF bx = edge(0, v2);
  const VF by = edge(1, v2);
  const VF bz = edge(2, v2);
  nx = hn::Sub(hn::Mul(ay, bz), hn::Mul(az, by));
  ny = hn::Sub(hn::Mul(az, bx), hn::Mul(ax, bz));
  nz = hn::Sub(hn::Mul(ax, by), hn::Mul(ay, bx));
}

/// Object to world space, unit length, turned round on back faces. A vanishing normal stays 0.
HWY_INLINE void ToWorldNormal(const SurfaceJob& job, const TriangleLanes& lanes, VF& nx, VF& ny, VF& nz) {
  const float* m = job.world_from_object_normal;
  const auto component = [&](int row) {
    return Dot(Constant(m[row]), Constant(m[3 + row]), Constant(m[6 + row]), nx, ny, nz);
  };
  const VF wx = component(0);
  const VF wy = component(1);
  const VF wz = component(2);
  const VF inverse_length = InverseLength(Dot(wx, wy, wz, wx, wy, wz));
  const VF flip = hn::BitCast(DF(), hn::ShiftLeft<31>(lanes.words(kBackFace)));
  const VF scale = hn::Xor(inverse_length, flip);
  nx = hn::Mul(wx, scale);
  ny = hn::Mul(wy, scale);
  nz = hn::Mul(wz, scale);
}

/// Multiplies the colour by the light that a Lambert surface sends on.
HWY_INLINE void Illuminate(const SurfaceJob& job, VF nx, VF ny, VF nz, VF& r, VF& g, VF& b) {
  VF light_r = hn::Add(Constant(job.ambient_middle.x), hn::Mul(Constant(job.ambient_rise.x), ny));
  VF light_g = hn::Add(Constant(job.ambient_middle.y), hn::Mul(Constant(job.ambient_rise.y), ny));
  VF light_b = hn::Add(Constant(job.ambient_middle.z), hn::Mul(Constant(job.ambient_rise.z), ny));
  for (int i = 0; i < job.scene->light_count; ++i) {
    const DirectionalLight& light = job.scene->lights[static_cast<std::size_t>(i)];
    const Vec3& to_light = light.direction_to_light_world;
    const VF cosine = AtLeastZero(Dot(Constant(to_light.x), Constant(to_light.y), Constant(to_light.z), nx, ny, nz));
    light_r = hn::Add(light_r, hn::Mul(Constant(light.radiance.x), cosine));
    light_g = hn::Add(light_g, hn::Mul(Constant(light.radiance.y), cosine));
    light_b = hn::Add(light_b, hn::Mul(Constant(light.radiance.z), cosine));
  }
  r = hn::Mul(r, light_r);
  g = hn::Mul(g, light_g);
  b = hn::Mul(b, light_b);
}

/// Finite, not negative, whatever came in.
HWY_INLINE VF Presentable(VF color) {
  return Clamped(color, 0.0F, hwy::HighestValue<float>());
}

HWY_INLINE void StoreColors(std::uint64_t lanes, VF r, VF g, VF b, Block& block, std::size_t begin) {
  const DF d;
  const std::uint64_t lane_mask = (std::uint64_t{1} << hn::Lanes(d)) - 1;
  float* to_r = block.colors.r + begin;
  float* to_g = block.colors.g + begin;
  float* to_b = block.colors.b + begin;
  // Not for the sake of the other lanes only: what a masked store wrote cannot be forwarded to the load that encodes.
  if (lanes == (block.covered >> begin & lane_mask)) {
    hn::Store(Presentable(r), d, to_r);
    hn::Store(Presentable(g), d, to_g);
    hn::Store(Presentable(b), d, to_b);
    return;
  }
  const MF mask = MaskOfBits(lanes);
  hn::BlendedStore(Presentable(r), mask, d, to_r);
  hn::BlendedStore(Presentable(g), mask, d, to_g);
  hn::BlendedStore(Presentable(b), mask, d, to_b);
}

/// Shades those of the pending pixels (bits in tileIndex() order) that show the job's surface; returns the rest.
template <ShadeModel kModel>
std::uint64_t ShadeBlock(const SurfaceJob& job, Block& block, std::uint64_t pending, BlockTriangles& fetched) {
  const DF d;
  const DI di;
  const std::uint64_t mine =
      FetchTriangles(job.scene->triangles.data(), block.triangle, job.surface_id, pending, fetched);
  if constexpr (kModel == ShadeModel::kSmooth) FetchNormals(job.surface->normal, fetched);

  constexpr std::size_t kRowMask = kBlockSize - 1;
  const VI lane = hn::Iota(di, 0);
  const VI lane_x = hn::Add(hn::And(lane, hn::Set(di, kRowMask)), hn::Set(di, block.x));
  const VI lane_y = hn::Add(hn::ShiftRight<3>(lane), hn::Set(di, block.y));
  for (std::size_t begin = 0; begin < kBlockPixels; begin += hn::Lanes(d)) {
    if (fetched.lanes[begin] == 0) continue;
    const TriangleLanes lanes{fetched, begin};
    const VI x = hn::Add(lane_x, hn::Set(di, static_cast<std::int32_t>(begin & kRowMask)));
    const VI y = hn::Add(lane_y, hn::Set(di, static_cast<std::int32_t>(begin / kBlockSize)));
    VF b0, b1, b2;
    Barycentrics(lanes, x, y, b0, b1, b2);

    VF r = Constant(job.material->base_color.x);
    VF g = Constant(job.material->base_color.y);
    VF b = Constant(job.material->base_color.z);
    if constexpr (kModel != ShadeModel::kUnlit) {
      VF nx, ny, nz;
      if constexpr (kModel == ShadeModel::kSmooth)
        SmoothNormal(lanes, b0, b1, b2, nx, ny, nz);
      else
        FlatNormal(*job.surface, lanes, nx, ny, nz);
      ToWorldNormal(job, lanes, nx, ny, nz);
      Illuminate(job, nx, ny, nz, r, g, b);
    }
    StoreColors(fetched.lanes[begin], r, g, b, block, begin);
  }
  return pending & ~mine;
}

BlockKernel SelectKernel(const Surface& surface, const ShadeMaterial& material) {
  if (material.model == ShadeModel::kUnlit) return &ShadeBlock<ShadeModel::kUnlit>;
  if (material.model == ShadeModel::kFlat || surface.normal == nullptr) return &ShadeBlock<ShadeModel::kFlat>;
  return &ShadeBlock<ShadeModel::kSmooth>;
}

SurfaceJob MakeSurfaceJob(const ShadeScene& scene, std::uint32_t surface_id) {
  SurfaceJob job{};
  job.scene = &scene;
  job.surface = &scene.surfaces[surface_id];
  job.material = &scene.materials[job.surface->material];
  job.kernel = SelectKernel(*job.surface, *job.material);
  job.surface_id = surface_id;
  float largest = 0.0F;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      largest = std::max(largest, std::abs(job.surface->world_from_object_normal[column][row]));
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      job.world_from_object_normal[3 * column + row] =
          largest > 0.0F ? job.surface->world_from_object_normal[column][row] / largest : 0.0F;
  job.ambient_middle = 0.5F * (scene.ambient_sky + scene.ambient_ground);
  job.ambient_rise = 0.5F * (scene.ambient_sky - scene.ambient_ground);
  return job;
}

/// Bits of the block's pixels that lie in a frame of this size.
std::uint64_t PixelsInside(int width_left, int height_left) {
  if (width_left >= kBlockSize && height_left >= kBlockSize) return ~std::uint64_t{0};
  const std::uint64_t row = (std::uint64_t{1} << std::min(width_left, kBlockSize)) - 1;
  std::uint64_t bits = 0;
  for (int y = 0; y < std::min(height_left, kBlockSize); ++y) bits |= row << (y * kBlockSize);
  return bits;
}

std::uint64_t PixelsCovered(const std::uint32_t* triangle) {
  const DU du;
  std::uint64_t bits = 0;
  for (std::size_t begin = 0; begin < kBlockPixels; begin += hn::Lanes(du)) {
    const auto covered = hn::Ne(hn::Load(du, triangle + begin), hn::Set(du, kNoTriangle));
    bits |= BitsOfMask(hn::RebindMask(DF(), covered)) << begin;
  }
  return bits;
}

/// Asks for the records of a block's triangles, which come from memory in no order.
void PrefetchTriangles(const ShadeTriangle* triangles, const std::uint32_t* ids) {
  constexpr int kLast = kBlockPixels - 1;
  if (ids[0] == ids[kBlockSize - 1] && ids[0] == ids[kLast]) return;  // most likely one triangle
  const DU du;
  const VU first = hn::Set(du, 0);
  alignas(64) std::uint32_t safe[kMaxLanes];
  for (std::size_t begin = 0; begin < kBlockPixels; begin += hn::Lanes(du)) {
    const VU id = hn::Load(du, ids + begin);
    hn::Store(hn::IfThenElse(hn::Eq(id, hn::Set(du, kNoTriangle)), first, id), du, safe);
    for (std::size_t i = 0; i < hn::Lanes(du); ++i) hwy::Prefetch(triangles + safe[i]);
  }
}

/// Background as both images hold it.
struct Background {
  std::uint32_t srgb;
  Vec4 linear;
};

Background MakeBackground(const Vec4& straight) {
  const float alpha = straight.w > 0.0F ? std::min(straight.w, 1.0F) : 0.0F;
  const auto alpha_code = static_cast<std::uint8_t>(alpha * 255.0F + 0.5F);
  const Rgba8 code{encodeSrgb(straight.x), encodeSrgb(straight.y), encodeSrgb(straight.z), alpha_code};
  return {std::bit_cast<std::uint32_t>(code), Vec4(Vec3(straight) * alpha, alpha)};
}

void WriteSrgb(const Block& block, const Background& background, Image8& image) {
  const DU du;
  alignas(64) std::uint32_t codes[kBlockPixels];
  const std::uint32_t* table = srgbEncodeTable().data();
  for (std::size_t begin = 0; begin < kBlockPixels; begin += hn::Lanes(du)) {
    const DF d;
    const VU code = EncodeOpaque(table, hn::Load(d, block.colors.r + begin), hn::Load(d, block.colors.g + begin),
                                 hn::Load(d, block.colors.b + begin));
    const auto mask = hn::RebindMask(du, MaskOfBits(block.covered >> begin));
    hn::Store(hn::IfThenElse(mask, code, hn::Set(du, background.srgb)), du, codes + begin);
  }
  const auto width = static_cast<std::size_t>(std::min(kBlockSize, image.width() - block.x));
  const int height = std::min(kBlockSize, image.height() - block.y);
  for (int y = 0; y < height; ++y) {
    auto* to = static_cast<void*>(image.row(block.y + y) + block.x);
    // A full row is a copy of known size: one move.
    if (width == kBlockSize)
      std::memcpy(to, codes + y * kBlockSize, kBlockSize * sizeof(Rgba8));
    else
      std::memcpy(to, codes + y * kBlockSize, width * sizeof(Rgba8));
  }
}

void WriteLinear(const Block& block, const Background& background, ImageF4& image) {
  const DF d;
  alignas(64) float values[kBlockPixels * 4];
  for (std::size_t begin = 0; begin < kBlockPixels; begin += hn::Lanes(d)) {
    const MF mask = MaskOfBits(block.covered >> begin);
    const auto pick = [&](const float* color, float behind) {
      return hn::IfThenElse(mask, hn::Load(d, color + begin), Constant(behind));
    };
    const VF alpha = hn::IfThenElse(mask, Constant(1.0F), Constant(background.linear.w));
    hn::StoreInterleaved4(pick(block.colors.r, background.linear.x), pick(block.colors.g, background.linear.y),
                          pick(block.colors.b, background.linear.z), alpha, d, values + 4 * begin);
  }
  const auto width = static_cast<std::size_t>(std::min(kBlockSize, image.width() - block.x));
  const int height = std::min(kBlockSize, image.height() - block.y);
  for (int y = 0; y < height; ++y)
    std::memcpy(static_cast<void*>(image.row(block.y + y) + block.x), values + 4 * y * kBlockSize,
                width * sizeof(Vec4));
}

void FillBlock(const Block& block, const Background& background, const ColorTarget& target) {
  if (target.srgb != nullptr) {
    const int width = std::min(kBlockSize, target.srgb->width() - block.x);
    const int height = std::min(kBlockSize, target.srgb->height() - block.y);
    for (int y = 0; y < height; ++y)
      std::fill_n(target.srgb->row(block.y + y) + block.x, width, std::bit_cast<Rgba8>(background.srgb));
  }
  if (target.linear != nullptr) {
    const int width = std::min(kBlockSize, target.linear->width() - block.x);
    const int height = std::min(kBlockSize, target.linear->height() - block.y);
    for (int y = 0; y < height; ++y) std::fill_n(target.linear->row(block.y + y) + block.x, width, background.linear);
  }
}

ShadeCounts ShadeTile(const ShadeScene& scene, const TileVisibility& tile, int x0, int y0, const ColorTarget& target) {
  const int width = target.srgb != nullptr ? target.srgb->width() : target.linear->width();
  const int height = target.srgb != nullptr ? target.srgb->height() : target.linear->height();
  const Background background = MakeBackground(scene.background);
  ShadeCounts counts;
  SurfaceJob job{};
  BlockTriangles fetched;
  fetched.forget();
  Block block{};
  for (int index = 0; index < kBlocksPerTile; ++index) {
    block.x = x0 + index % kBlocksPerTileSide * kBlockSize;
    block.y = y0 + index / kBlocksPerTileSide * kBlockSize;
    block.triangle = tile.triangle + index * kBlockPixels;
    if (block.x >= width || block.y >= height) continue;
    const std::uint64_t inside = PixelsInside(width - block.x, height - block.y);
    const std::uint64_t covered = inside & PixelsCovered(block.triangle);
    block.covered = covered;
    counts.pixels_shaded += static_cast<std::uint64_t>(std::popcount(covered));
    counts.pixels_background += static_cast<std::uint64_t>(std::popcount(inside & ~covered));
    if (covered == 0) {
      FillBlock(block, background, target);
      continue;
    }
    if (index + 1 < kBlocksPerTile) PrefetchTriangles(scene.triangles.data(), block.triangle + kBlockPixels);
    for (std::uint64_t pending = covered; pending != 0; pending = job.kernel(job, block, pending, fetched)) {
      const std::uint32_t first_id = block.triangle[std::countr_zero(pending)];
      const std::uint32_t surface_id = scene.triangles[first_id].surface;
      if (job.scene == nullptr || job.surface_id != surface_id) {
        job = MakeSurfaceJob(scene, surface_id);
        fetched.forget();
      }
    }
    if (target.srgb != nullptr) WriteSrgb(block, background, *target.srgb);
    if (target.linear != nullptr) WriteLinear(block, background, *target.linear);
  }
  return counts;
}

ShadeCounts FillTile(const ShadeScene& scene, int x0, int y0, const ColorTarget& target) {
  const int width = target.srgb != nullptr ? target.srgb->width() : target.linear->width();
  const int height = target.srgb != nullptr ? target.srgb->height() : target.linear->height();
  const Background background = MakeBackground(scene.background);
  const int x1 = std::min(x0 + kTileSize, width);
  const int y1 = std::min(y0 + kTileSize, height);
  for (int y = y0; y < y1; ++y) {
    if (target.srgb != nullptr) std::fill_n(target.srgb->row(y) + x0, x1 - x0, std::bit_cast<Rgba8>(background.srgb));
    if (target.linear != nullptr) std::fill_n(target.linear->row(y) + x0, x1 - x0, background.linear);
  }
  ShadeCounts counts;
  if (x0 < x1 && y0 < y1)
    counts.pixels_background = static_cast<std::uint64_t>(x1 - x0) * static_cast<std::uint64_t>(y1 - y0);
  return counts;
}

}  // namespace sheaf::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sheaf::raster {

HWY_EXPORT(ShadeTile);
HWY_EXPORT(FillTile);

ShadeCounts shadeTile(const ShadeScene& scene, const TileVisibility& tile, int x0, int y0, const ColorTarget& target) {
  assert(target.srgb != nullptr || target.linear != nullptr);
  return HWY_DYNAMIC_DISPATCH(ShadeTile)(scene, tile, x0, y0, target);
}

ShadeCounts fillTile(const ShadeScene& scene, int x0, int y0, const ColorTarget& target) {
  assert(target.srgb != nullptr || target.linear != nullptr);
  return HWY_DYNAMIC_DISPATCH(FillTile)(scene, x0, y0, target);
}

}  // namespace sheaf::raster
#endif
