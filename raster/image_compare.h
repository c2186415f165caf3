// raster/image_compare: how far two pictures are apart. What is too far is for the caller to judge.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/image.h"

namespace sheaf::raster {

struct PixelPosition {
  int x = 0;
  int y = 0;
  bool operator==(const PixelPosition&) const = default;
};

/// Errors are absolute differences of the coded 8-bit values, [0, 255].
struct ImageDifference {
  int width = 0;
  int height = 0;
  int channels = 3;  ///< that RMS and PSNR are taken over: 4 when a picture has a pixel that is not opaque
  std::uint64_t differing_pixels = 0;      ///< in any channel, alpha included
  int max_error = 0;                       ///< over all channels
  std::array<int, 4> max_error_channel{};  ///< r, g, b, a
  double rms = 0.0;                        ///< over pixels and `channels`
  double psnr_db = 0.0;                    ///< 20 log10(255 / rms), infinite when rms is 0
  std::optional<PixelPosition> first;      ///< first differing pixel, row by row
  PixelPosition box_min;                   ///< box around all differing pixels, [box_min, box_max)
  PixelPosition box_max;

  double differingFraction() const;  ///< of all pixels, [0, 1]
};

/// Both pictures have the same size.
ImageDifference compareImages(const Image8& a, const Image8& b);

/// A picture of the same size: where the two are equal, a darkened grey copy of `a`; where they differ, a colour from
/// blue (1) by purple and orange to yellow (255), whose lightness grows with the logarithm of the largest channel's
/// error.
Image8 heatMap(const Image8& a, const Image8& b);

}  // namespace sheaf::raster
