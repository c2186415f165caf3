#include "raster/silhouette.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "raster/screen.h"

namespace sheaf::raster {
namespace {

using Mask = Image<std::uint8_t>;

// "None in this column" is width + height, more than any distance in the picture; its square and that of a row's length
// are added below.
static_assert(5 * std::uint64_t{kMaxTargetSize} * kMaxTargetSize <= std::numeric_limits<std::uint32_t>::max());

Mask edgesOf(const ImageU32& ids) {
  Mask edges(ids.width(), ids.height(), 0);
  for (int y = 0; y < ids.height(); ++y)
    for (int x = 0; x < ids.width(); ++x) {
      const std::uint32_t id = ids.at(x, y);
      const bool edge = (x > 0 && ids.at(x - 1, y) > id) || (x + 1 < ids.width() && ids.at(x + 1, y) > id) ||
                        (y > 0 && ids.at(x, y - 1) > id) || (y + 1 < ids.height() && ids.at(x, y + 1) > id);
      edges.at(x, y) = edge ? 1 : 0;
    }
  return edges;
}

/// Distance to the nearest pixel of the mask in the same column.
ImageU32 columnDistances(const Mask& mask) {
  const std::uint32_t farthest = static_cast<std::uint32_t>(mask.width() + mask.height());
  ImageU32 distance(mask.width(), mask.height(), farthest);
  for (int y = 0; y < mask.height(); ++y)
    for (int x = 0; x < mask.width(); ++x) {
      if (mask.at(x, y) != 0)
        distance.at(x, y) = 0;
      else if (y > 0)
        distance.at(x, y) = std::min(farthest, distance.at(x, y - 1) + 1);
    }
  for (int y = mask.height() - 2; y >= 0; --y)
    for (int x = 0; x < mask.width(); ++x) distance.at(x, y) = std::min(distance.at(x, y), distance.at(x, y + 1) + 1);
  return distance;
}

std::int64_t floorDivide(std::int64_t a, std::int64_t positive_b) {
  return a >= 0 ? a / positive_b : -((positive_b - 1 - a) / positive_b);
}

/// The lower envelope of the parabolas (x - i)^2 + column[i]^2, one for each pixel i of a row.
class Envelope {
 public:
  explicit Envelope(int width) : owner_(static_cast<std::size_t>(width)), start_(static_cast<std::size_t>(width)) {}

  /// Replaces column distances by squared distances in the plane.
  void apply(std::uint32_t* row) {
    const auto width = static_cast<std::int64_t>(owner_.size());
    column_.assign(row, row + width);
    std::size_t used = 1;  // parabola owner_[k] is the lowest from start_[k] on
    owner_[0] = 0;
    start_[0] = 0;
    for (std::int64_t u = 1; u < width; ++u) {
      while (used > 0 && height(owner_[used - 1], start_[used - 1]) > height(u, start_[used - 1])) --used;
      const std::int64_t from = used == 0 ? 0 : 1 + lastBefore(owner_[used - 1], u);
      if (from >= width) continue;
      owner_[used] = u;
      start_[used++] = from;
    }
    for (std::int64_t x = width - 1; x >= 0; --x) {
      row[x] = static_cast<std::uint32_t>(height(owner_[used - 1], x));
      if (x == start_[used - 1]) --used;
    }
  }

 private:
  std::int64_t square(std::int64_t i) const {
    const std::int64_t c = column_[static_cast<std::size_t>(i)];
    return c * c;
  }
  std::int64_t height(std::int64_t i, std::int64_t x) const { return (x - i) * (x - i) + square(i); }
  /// The last x at which the parabola of i is not above that of u, i < u.
  std::int64_t lastBefore(std::int64_t i, std::int64_t u) const {
    return floorDivide(u * u - i * i + square(u) - square(i), 2 * (u - i));
  }

  std::vector<std::uint32_t> column_;
  std::vector<std::int64_t> owner_;
  std::vector<std::int64_t> start_;
};

struct Distances {
  std::uint64_t edge_pixels = 0;
  std::uint32_t max_squared = 0;
  double sum = 0.0;
};

/// From every edge pixel to the nearest of the other picture.
Distances distancesFrom(const Mask& edges, const Mask& other) {
  const ImageU32 squared = squaredDistances(other);
  Distances result;
  for (std::size_t i = 0; i < edges.pixels().size(); ++i) {
    if (edges.pixels()[i] == 0) continue;
    ++result.edge_pixels;
    result.max_squared = std::max(result.max_squared, squared.pixels()[i]);
    result.sum += std::sqrt(static_cast<double>(squared.pixels()[i]));
  }
  return result;
}

}  // namespace

ImageU32 squaredDistances(const Image<std::uint8_t>& mask) {
  assert(mask.width() <= kMaxTargetSize && mask.height() <= kMaxTargetSize);
  ImageU32 distance = columnDistances(mask);
  if (distance.empty()) return distance;
  Envelope envelope(mask.width());
  for (int y = 0; y < mask.height(); ++y) envelope.apply(distance.row(y));
  return distance;
}

SilhouetteShift silhouetteShift(const ImageU32& a, const ImageU32& b) {
  assert(a.width() == b.width() && a.height() == b.height());
  const Mask edges_a = edgesOf(a);
  const Mask edges_b = edgesOf(b);
  const Distances from_a = distancesFrom(edges_a, edges_b);
  const Distances from_b = distancesFrom(edges_b, edges_a);
  SilhouetteShift shift;
  shift.edge_pixels_a = from_a.edge_pixels;
  shift.edge_pixels_b = from_b.edge_pixels;
  const std::uint64_t count = from_a.edge_pixels + from_b.edge_pixels;
  if (count == 0) return shift;
  if (from_a.edge_pixels == 0 || from_b.edge_pixels == 0) {
    shift.max_px = shift.mean_px = std::numeric_limits<double>::infinity();
    return shift;
  }
  shift.max_px = std::sqrt(static_cast<double>(std::max(from_a.max_squared, from_b.max_squared)));
  shift.mean_px = (from_a.sum + from_b.sum) / static_cast<double>(count);
  return shift;
}

}  // namespace sheaf::raster
