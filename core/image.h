// core/image: a plain owning image. Pixel (0, 0) is top left, rows are contiguous and unpadded.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math.h"

namespace sheaf {

template <typename Pixel>
class Image {
 public:
  Image() = default;
  Image(int width, int height, const Pixel& fill = Pixel{})
      : width_(width),
        height_(height),
        pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill) {
    assert(width >= 0 && height >= 0);
  }

  int width() const { return width_; }
  int height() const { return height_; }
  bool empty() const { return pixels_.empty(); }

  Pixel& at(int x, int y) { return pixels_[index(x, y)]; }
  const Pixel& at(int x, int y) const { return pixels_[index(x, y)]; }
  Pixel* row(int y) { return pixels_.data() + index(0, y); }
  const Pixel* row(int y) const { return pixels_.data() + index(0, y); }
  std::span<Pixel> pixels() { return pixels_; }
  std::span<const Pixel> pixels() const { return pixels_; }

  bool operator==(const Image&) const = default;

 private:
  std::size_t index(int x, int y) const {
    assert(x >= 0 && x <= width_ && y >= 0 && y < height_);
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  int width_ = 0;
  int height_ = 0;
  std::vector<Pixel> pixels_;
};

/// Four bytes in memory order r, g, b, a; straight alpha; sRGB-coded colour unless a name says otherwise.
struct Rgba8 {
  std::uint8_t r = 0, g = 0, b = 0, a = 255;
  bool operator==(const Rgba8&) const = default;
};
static_assert(sizeof(Rgba8) == 4);

using Image8 = Image<Rgba8>;
using ImageF = Image<float>;
using ImageF4 = Image<Vec4>;  ///< linear colour, premultiplied alpha
using ImageU32 = Image<std::uint32_t>;

}  // namespace sheaf
