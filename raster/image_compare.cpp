#include "raster/image_compare.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace sheaf::raster {
namespace {

std::array<int, 4> channelErrors(Rgba8 a, Rgba8 b) {
  return {std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b), std::abs(a.a - b.a)};
}

bool allOpaque(const Image8& image) {
  return std::all_of(image.pixels().begin(), image.pixels().end(), [](Rgba8 p) { return p.a == 255; });
}

void addPosition(ImageDifference& difference, PixelPosition p) {
  if (!difference.first) {
    difference.first = p;
    difference.box_min = p;
    difference.box_max = {p.x + 1, p.y + 1};
    return;
  }
  difference.box_min.x = std::min(difference.box_min.x, p.x);
  difference.box_max.x = std::max(difference.box_max.x, p.x + 1);
  difference.box_max.y = p.y + 1;  // rows come in order
}

// Ends and three steps between; lightness grows steadily, also for readers who do not see red and green apart.
Rgba8 heatColor(int error) {
  static constexpr std::array<std::array<double, 3>, 5> kStops = {
      {{40, 50, 170}, {126, 3, 168}, {204, 71, 120}, {248, 149, 64}, {240, 249, 33}}};
  const double t = std::log2(static_cast<double>(error)) / std::log2(255.0) * (kStops.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(t), kStops.size() - 2);
  const double f = t - static_cast<double>(k);
  const auto mix = [&](std::size_t c) {
    return static_cast<std::uint8_t>(std::lround(kStops[k][c] + f * (kStops[k + 1][c] - kStops[k][c])));
  };
  return {mix(0), mix(1), mix(2), 255};
}

Rgba8 darkGrey(Rgba8 p) {
  const int luma = (54 * p.r + 183 * p.g + 19 * p.b) / 256;
  const auto grey = static_cast<std::uint8_t>(luma * p.a / 255 / 6);
  return {grey, grey, grey, 255};
}

}  // namespace

double ImageDifference::differingFraction() const {
  const double pixels = static_cast<double>(width) * static_cast<double>(height);
  return pixels > 0.0 ? static_cast<double>(differing_pixels) / pixels : 0.0;
}

ImageDifference compareImages(const Image8& a, const Image8& b) {
  assert(a.width() == b.width() && a.height() == b.height());
  ImageDifference difference;
  difference.width = a.width();
  difference.height = a.height();
  difference.channels = allOpaque(a) && allOpaque(b) ? 3 : 4;
  std::uint64_t squares = 0;  // 2^28 pixels * 4 * 255^2 stay below 2^47
  for (int y = 0; y < a.height(); ++y) {
    const Rgba8* row_a = a.row(y);
    const Rgba8* row_b = b.row(y);
    for (int x = 0; x < a.width(); ++x) {
      if (row_a[x] == row_b[x]) continue;
      ++difference.differing_pixels;
      addPosition(difference, {x, y});
      const std::array<int, 4> errors = channelErrors(row_a[x], row_b[x]);
      for (std::size_t c = 0; c < 4; ++c) {
        squares += static_cast<std::uint64_t>(errors[c] * errors[c]);
        difference.max_error_channel[c] = std::max(difference.max_error_channel[c], errors[c]);
      }
    }
  }
  difference.max_error = *std::max_element(difference.max_error_channel.begin(), difference.max_error_channel.end());
  const double values = static_cast<double>(a.pixels().size()) * difference.channels;
  difference.rms = values > 0.0 ? std::sqrt(static_cast<double>(squares) / values) : 0.0;
  difference.psnr_db =
      difference.rms > 0.0 ? 20.0 * std::log10(255.0 / difference.rms) : std::numeric_limits<double>::infinity();
  return difference;
}

Image8 heatMap(const Image8& a, const Image8& b) {
  assert(a.width() == b.width() && a.height() == b.height());
  Image8 map(a.width(), a.height());
  for (std::size_t i = 0; i < map.pixels().size(); ++i) {
    const std::array<int, 4> errors = channelErrors(a.pixels()[i], b.pixels()[i]);
    const int error = *std::max_element(errors.begin(), errors.end());
    map.pixels()[i] = error > 0 ? heatColor(error) : darkGrey(a.pixels()[i]);
  }
  return map;
}

}  // namespace sheaf::raster
