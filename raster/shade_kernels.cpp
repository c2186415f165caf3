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

#include "raster/shade_albedo-inl.h"
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
                                      BlockFragments& fragments);

/// What is the same for all pixels of a surface.
struct SurfaceJob {
  const ShadeScene* scene;
  const Surface* surface;
  const ShadeMaterial* material;
  BlockKernel kernel;
  std::uint32_t surface_id;
  float world_from_object_normal[9];  ///< by columns, the largest entry scaled to 1
  float specular_strength;            ///< of the highlights' peak
  Vec3 ambient_middle;                ///< of a horizontal normal
  Vec3 ambient_rise;                  ///< from there to straight up
};

/// Object to world space, unit length, turned round on back faces. A vanishing normal stays 0.
HWY_INLINE void ToWorldNormal(const SurfaceJob& job, VU flip, VF& nx, VF& ny, VF& nz) {
  const float* m = job.world_from_object_normal;
  const auto component = [&](int row) HWY_ATTR {
    return Dot(Constant(m[row]), Constant(m[3 + row]), Constant(m[6 + row]), nx, ny, nz);
  };
  const VF wx = component(0);
  const VF wy = component(1);
  const VF wz = component(2);
  const VF inverse_length = InverseLength(Dot(wx, wy, wz, wx, wy, wz));
  const VF scale = hn::Xor(inverse_length, hn::BitCast(DF(), flip));
  nx = hn::Mul(wx, scale);
  ny = hn::Mul(wy, scale);
  nz = hn::Mul(wz, scale);
}

/// Unit vector towards the eye at a vector of pixels.
HWY_INLINE void ToEye(const ShadeScene& scene, VF x, VF y, VF& vx, VF& vy, VF& vz) {
  const auto component = [&](int axis) HWY_ATTR {
    return hn::Add(hn::Add(Constant(scene.to_eye[axis]), hn::Mul(Constant(scene.to_eye_dx[axis]), x)),
                   hn::Mul(Constant(scene.to_eye_dy[axis]), y));
  };
  const VF ex = component(0);
  const VF ey = component(1);
  const VF ez = component(2);
  const VF inverse_length = InverseLength(Dot(ex, ey, ez, ex, ey, ez));
  vx = hn::Mul(ex, inverse_length);
  vy = hn::Mul(ey, inverse_length);
  vz = hn::Mul(ez, inverse_length);
}

HWY_INLINE VF CosineToLight(const DirectionalLight& light, VF x, VF y, VF z) {
  const Vec3& l = light.direction_to_light_world;
  return Dot(Constant(l.x), Constant(l.y), Constant(l.z), x, y, z);
}

/// Multiplies the colour by the light that a Lambert surface sends on.
HWY_INLINE void AddDiffuse(const SurfaceJob& job, VF nx, VF ny, VF nz, VF& r, VF& g, VF& b) {
  VF light_r = hn::Add(Constant(job.ambient_middle.x), hn::Mul(Constant(job.ambient_rise.x), ny));
  VF light_g = hn::Add(Constant(job.ambient_middle.y), hn::Mul(Constant(job.ambient_rise.y), ny));
  VF light_b = hn::Add(Constant(job.ambient_middle.z), hn::Mul(Constant(job.ambient_rise.z), ny));
  for (int i = 0; i < job.scene->light_count; ++i) {
    const DirectionalLight& light = job.scene->lights[static_cast<std::size_t>(i)];
    const VF cosine = AtLeastZero(CosineToLight(light, nx, ny, nz));
    light_r = hn::Add(light_r, hn::Mul(Constant(light.radiance.x), cosine));
    light_g = hn::Add(light_g, hn::Mul(Constant(light.radiance.y), cosine));
    light_b = hn::Add(light_b, hn::Mul(Constant(light.radiance.z), cosine));
  }
  r = hn::Mul(r, light_r);
  g = hn::Mul(g, light_g);
  b = hn::Mul(b, light_b);
}

/// Adds Blinn-Phong highlights [Bli77] times (shininess + 8) / 8, which keeps their total about the same for any
/// shininess, and times the cosine to the light, so that they fade out where the light grazes.
/// With h = (l + v) / |l + v| for unit l and v: (n.h)^2 = (n.l + n.v)^2 / (2 + 2 l.v), no square root needed.
HWY_INLINE void AddSpecular(const SurfaceJob& job, VF nx, VF ny, VF nz, VF x, VF y, VF& r, VF& g, VF& b) {
  VF vx, vy, vz;
  ToEye(*job.scene, x, y, vx, vy, vz);
  const VF facing_eye = Dot(nx, ny, nz, vx, vy, vz);
  const VF half_shininess = Constant(0.5F * job.material->shininess);
  const VF strength = Constant(job.specular_strength);
  for (int i = 0; i < job.scene->light_count; ++i) {
    const DirectionalLight& light = job.scene->lights[static_cast<std::size_t>(i)];
    const VF cosine = AtLeastZero(CosineToLight(light, nx, ny, nz));
    const VF along_half = AtLeastZero(hn::Add(cosine, facing_eye));
    const VF two = Constant(2.0F);
    const VF half_squared = hn::Add(two, hn::Mul(two, CosineToLight(light, vx, vy, vz)));
    const VF cosine_squared = Clamped(hn::Div(hn::Mul(along_half, along_half), half_squared), 1e-30F, 1.0F);
    const VF lobe = Exp2(hn::Mul(half_shininess, Log2(cosine_squared)));
    const VF glint = hn::Mul(hn::Mul(strength, lobe), cosine);
    r = hn::Add(r, hn::Mul(Constant(light.radiance.x), glint));
    g = hn::Add(g, hn::Mul(Constant(light.radiance.y), glint));
    b = hn::Add(b, hn::Mul(Constant(light.radiance.z), glint));
  }
}

/// Finite, not negative, whatever came in.
HWY_INLINE VF Presentable(VF color) {
  return Clamped(color, 0.0F, hwy::HighestValue<float>());
}

HWY_INLINE void StoreColors(std::uint64_t lanes, VF r, VF g, VF b, Block& block, std::size_t begin) {
  const DF d;
  float* to_r = block.colors.r + begin;
  float* to_g = block.colors.g + begin;
  float* to_b = block.colors.b + begin;
  // A plain store where it may be: one that is masked cannot be forwarded to the load that encodes.
  if (lanes == (block.covered >> begin & AllLanes())) {
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
template <ShadeModel kModel, bool kPatterned>
std::uint64_t ShadeBlock(const SurfaceJob& job, Block& block, std::uint64_t pending, BlockFragments& fragments) {
  const DF d;
  const DI di;
  const std::uint64_t mine = FetchFragments<kPatterned>(job.scene->triangles.data(), block.triangle, job.surface_id,
                                                        pending, block.x, block.y, fragments);
  if constexpr (kModel == ShadeModel::kSmooth) FetchSmoothNormals(job.surface->normal, fragments);
  if constexpr (kModel == ShadeModel::kFlat) FetchFlatNormals(job.surface->position_object, fragments);
  if constexpr (kPatterned) FetchAlbedo(*job.surface, *job.material, fragments);

  const bool has_specular = job.specular_strength > 0.0F;
  constexpr std::int32_t kRowMask = kBlockSize - 1;
  const VI lane = hn::Iota(di, 0);
  const VI lane_x = hn::Add(hn::And(lane, hn::Set(di, kRowMask)), hn::Set(di, block.x));
  const VI lane_y = hn::Add(hn::ShiftRight<3>(lane), hn::Set(di, block.y));
  for (std::size_t begin = 0; begin < kBlockPixels; begin += hn::Lanes(d)) {
    if (fragments.lanes[begin] == 0) continue;
    VF r = kPatterned ? hn::Load(d, fragments.albedo[0] + begin) : Constant(job.material->base_color.x);
    VF g = kPatterned ? hn::Load(d, fragments.albedo[1] + begin) : Constant(job.material->base_color.y);
    VF b = kPatterned ? hn::Load(d, fragments.albedo[2] + begin) : Constant(job.material->base_color.z);
    if constexpr (kModel != ShadeModel::kUnlit) {
      VF nx = hn::Load(d, fragments.normal[0] + begin);
      VF ny = hn::Load(d, fragments.normal[1] + begin);
      VF nz = hn::Load(d, fragments.normal[2] + begin);
      ToWorldNormal(job, hn::Load(DU(), fragments.flip + begin), nx, ny, nz);
      AddDiffuse(job, nx, ny, nz, r, g, b);
      if (has_specular) {
        const VI x = hn::Add(lane_x, hn::Set(di, static_cast<std::int32_t>(begin) & kRowMask));
        const VI y = hn::Add(lane_y, hn::Set(di, static_cast<std::int32_t>(begin) / kBlockSize));
        AddSpecular(job, nx, ny, nz, hn::ConvertTo(d, x), hn::ConvertTo(d, y), r, g, b);
      }
    }
    StoreColors(fragments.lanes[begin], r, g, b, block, begin);
  }
  return pending & ~mine;
}

template <bool kPatterned>
BlockKernel SelectModel(const Surface& surface, ShadeModel model) {
  if (model == ShadeModel::kUnlit) return &ShadeBlock<ShadeModel::kUnlit, kPatterned>;
  if (model == ShadeModel::kFlat || surface.normal == nullptr) return &ShadeBlock<ShadeModel::kFlat, kPatterned>;
  return &ShadeBlock<ShadeModel::kSmooth, kPatterned>;
}

SurfaceJob MakeSurfaceJob(const ShadeScene& scene, std::uint32_t surface_id) {
  SurfaceJob job{};
  job.scene = &scene;
  job.surface = &scene.surfaces[surface_id];
  job.material = &scene.materials[job.surface->material];
  job.kernel = HasPattern(*job.surface, *job.material) ? SelectModel<true>(*job.surface, job.material->model)
                                                       : SelectModel<false>(*job.surface, job.material->model);
  job.specular_strength = job.material->specular * (job.material->shininess + 8.0F) / 8.0F;
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
  alignas(64) std::uint32_t safe[kMaxLanes];
  for (std::size_t begin = 0; begin < kBlockPixels; begin += hn::Lanes(du)) {
    const VU id = hn::Load(du, ids + begin);
    hn::Store(hn::IfThenElse(hn::Eq(id, hn::Set(du, kNoTriangle)), hn::Zero(du), id), du, safe);
    for (std::size_t i = 0; i < hn::Lanes(du); ++i) hwy::Prefetch(triangles + safe[i]);
  }
}

/// Asks for the lines of an image that a block will be written to. Stores retire in order: without this, all that the
/// kernels write waits for lines of the image to arrive.
template <typename Pixel>
void PrefetchRows(Image<Pixel>* image, int x, int y) {
  if (image == nullptr || x >= image->width()) return;
  for (int row = y; row < std::min(y + kBlockSize, image->height()); ++row)
    for (std::size_t byte = 0; byte < kBlockSize * sizeof(Pixel); byte += 64)
      hwy::Prefetch(reinterpret_cast<const char*>(image->row(row) + x) + byte);
}

void PrefetchBlockRows(const ColorTarget& target, int x, int y) {
  PrefetchRows(target.srgb, x, y);
  PrefetchRows(target.linear, x, y);
}

/// Where a block lies in its tile.
constexpr int blockX(int index) {
  return index % kBlocksPerTileSide * kBlockSize;
}
constexpr int blockY(int index) {
  return index / kBlocksPerTileSide * kBlockSize;
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
    const auto pick = [&](const float* color, float behind)
                          HWY_ATTR { return hn::IfThenElse(mask, hn::Load(d, color + begin), Constant(behind)); };
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
  BlockFragments fragments;
  Block block{};
  constexpr int kRowsAhead = 4;  // blocks
  for (int index = 0; index < kRowsAhead; ++index) PrefetchBlockRows(target, x0 + blockX(index), y0 + blockY(index));
  for (int index = 0; index < kBlocksPerTile; ++index) {
    block.x = x0 + blockX(index);
    block.y = y0 + blockY(index);
    if (index + 1 < kBlocksPerTile)
      PrefetchTriangles(scene.triangles.data(), tile.triangle + (index + 1) * kBlockPixels);
    if (index + kRowsAhead < kBlocksPerTile)
      PrefetchBlockRows(target, x0 + blockX(index + kRowsAhead), y0 + blockY(index + kRowsAhead));
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
    for (std::uint64_t pending = covered; pending != 0; pending = job.kernel(job, block, pending, fragments)) {
      const std::uint32_t first_id = block.triangle[std::countr_zero(pending)];
      const std::uint32_t surface_id = scene.triangles[first_id].surface;
      if (job.scene == nullptr || job.surface_id != surface_id) job = MakeSurfaceJob(scene, surface_id);
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
