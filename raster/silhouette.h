// raster/silhouette: how far outlines have moved from one picture to another.
#pragma once

#include <cstdint>

#include "core/image.h"

namespace sheaf::raster {

/// Of every pixel the squared distance to the nearest pixel that is not 0, in pixels between centres; exact.
/// Where all pixels are 0: more than any distance within the picture. Each side at most 16384.
/// [MRH00], two scans; time and memory O(pixels).
ImageU32 squaredDistances(const Image<std::uint8_t>& mask);

struct SilhouetteShift {
  std::uint64_t edge_pixels_a = 0;
  std::uint64_t edge_pixels_b = 0;
  /// Over the edge pixels of either picture, the distance to the nearest edge pixel of the other: what has moved by 3
  /// pixels has 3 here. Infinite when one picture has edges and the other has none.
  double max_px = 0.0;
  double mean_px = 0.0;
};

/// a, b  which instance is seen at every pixel (pipeline::Frame::instance_id), of the same size
/// A pixel is an edge pixel if one of the four pixels beside it has a greater number, kNoTriangle (nothing there) being
/// the greatest: so an outline is one pixel wide and lies on one side, that of the instance with the lower number. The
/// picture's border is no outline, and neither is where an instance hides itself.
SilhouetteShift silhouetteShift(const ImageU32& a, const ImageU32& b);

}  // namespace sheaf::raster
