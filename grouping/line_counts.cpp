#include "grouping/line_counts.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sheaf::grouping {
namespace {

// Directions up to sign, sorted into the cells of three faces of a cube. Face k holds those whose k-th component is the
// largest, with the other two divided by it as coordinates in [-1, 1].
class DirectionGrid {
 public:
  // A flat set has no directions along z, so that the second coordinate is 0 on both of its faces.
  DirectionGrid(std::size_t direction_count, bool flat) {
    const double n = static_cast<double>(direction_count);
    columns_ = std::clamp(static_cast<int>(flat ? 0.5 * n : 0.9 * std::sqrt(n)), 1, flat ? 4096 : 160);
    rows_ = flat ? 1 : columns_;
  }

  // Replaces the content. ends[i] is the vertex at the far end of lines[i].
  void fill(std::span<const LineTest::Along> lines, std::span<const std::uint32_t> ends) {
    first_.assign(cellCount() + 1, 0);
    cell_of_.clear();
    for (const LineTest::Along& line : lines) {
      const std::uint32_t cell = cellOf(line.direction);
      cell_of_.push_back(cell);
      ++first_[cell + 1];
    }
    for (std::size_t c = 0; c < cellCount(); ++c) first_[c + 1] += first_[c];
    next_.assign(first_.begin(), first_.end() - 1);
    lines_.resize(lines.size());
    ends_.resize(lines.size());
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::uint32_t place = next_[cell_of_[i]]++;
      lines_[place] = lines[i];
      ends_[place] = ends[i];
    }
  }

  // By cell.
  std::span<const LineTest::Along> lines() const { return lines_; }
  std::span<const std::uint32_t> ends() const { return ends_; }

  // Calls body(begin, end) for runs of lines() that hold all directions of lines through the origin that come within
  // `reach` of the point `to`, and some others.
  template <class Body>
  void forEachNear(const DVec3& to, double reach, const Body& body) const {
    const DVec3 size = glm::abs(to);
    const double largest = std::max({size.x, size.y, size.z});
    for (int face = 0; face < 3; ++face) {
      if (largest - size[face] > 2.0 * reach) continue;  // no point of the ball has this as its largest component
      const Range rows = rangeOf(to, face, kSecond[face], reach, rows_);
      const Range columns = rangeOf(to, face, kFirst[face], reach, columns_);
      if (columns.begin >= columns.end) continue;
      for (int row = rows.begin; row < rows.end; ++row) {
        const std::uint32_t line = static_cast<std::uint32_t>((face * rows_ + row) * columns_);
        const std::uint32_t begin = first_[line + static_cast<std::uint32_t>(columns.begin)];
        const std::uint32_t end = first_[line + static_cast<std::uint32_t>(columns.end)];
        if (begin < end) body(begin, end);
      }
    }
  }

 private:
  static constexpr std::array<int, 3> kFirst = {1, 0, 0};
  static constexpr std::array<int, 3> kSecond = {2, 2, 1};
  struct Range {
    int begin, end;
  };

  std::size_t cellCount() const { return static_cast<std::size_t>(3 * rows_ * columns_); }

  static int clampedCell(double coordinate, int cells) {
    const double cell = std::floor((coordinate + 1.0) * (0.5 * cells));
    return static_cast<int>(std::clamp(cell, 0.0, static_cast<double>(cells - 1)));
  }

  std::uint32_t cellOf(const DVec3& d) const {
    const DVec3 size = glm::abs(d);
    int face = 0;
    for (int k = 1; k < 3; ++k)
      if (size[k] > size[face]) face = k;
    const int row = clampedCell(d[kSecond[face]] / d[face], rows_);
    const int column = clampedCell(d[kFirst[face]] / d[face], columns_);
    return static_cast<std::uint32_t>((face * rows_ + row) * columns_ + column);
  }

  // Cells that the quotients of the box around the ball fall into. The slack is far above round-off, far below a cell.
  static Range rangeOf(const DVec3& to, int face, int other, double reach, int cells) {
    constexpr double kSlack = 1e-9;
    const double sign = to[face] < 0.0 ? -1.0 : 1.0;
    const double below = sign * to[face] - reach, above = sign * to[face] + reach;
    if (!(below > 0.0)) return {0, cells};
    const double lo = sign * to[other] - reach, hi = sign * to[other] + reach;
    const double least = lo / (lo >= 0.0 ? above : below) - kSlack;
    const double most = hi / (hi >= 0.0 ? below : above) + kSlack;
    if (least > 1.0 || most < -1.0) return {0, 0};
    return {clampedCell(least, cells), clampedCell(most, cells) + 1};
  }

  int columns_ = 1, rows_ = 1;
  std::vector<std::uint32_t> first_, next_, cell_of_, ends_;
  std::vector<LineTest::Along> lines_;
};

}  // namespace

std::vector<std::uint16_t> countTakenByLines(const LineTest& test, std::span<const std::uint32_t> cell, bool flat,
                                             const std::function<bool(std::uint32_t)>& proceed) {
  const auto m = static_cast<std::uint32_t>(cell.size());
  std::vector<std::uint16_t> counts(std::size_t{m} * (m - (m > 0)) / 2, 0);
  DirectionGrid grid(m, flat);
  std::vector<LineTest::Along> lines;
  std::vector<std::uint32_t> ends, taken;
  std::size_t row = 0;  // of the pairs (first, first + 1) ...
  for (std::uint32_t first = 0; first < m; row += m - 1 - first, ++first) {
    if (!proceed(first)) return {};
    const DVec3 origin = test.position(cell[first]);
    lines.clear();
    ends.clear();
    for (std::uint32_t j = first + 1; j < m; ++j) {
      if (!test.isLine(cell[first], cell[j])) continue;
      const DVec3 along = test.position(cell[j]) - origin;
      lines.push_back({along, glm::dot(along, along)});
      ends.push_back(j);
    }
    grid.fill(lines, ends);
    taken.assign(lines.size(), 0);
    for (std::uint32_t p = 0; p < m; ++p) {
      if (p == first) continue;
      const DVec3 to_p = test.position(cell[p]) - origin;
      grid.forEachNear(to_p, test.reach(cell[p]), [&](std::uint32_t begin, std::uint32_t end) {
        test.addTakers(cell[p], to_p, grid.lines().subspan(begin, end - begin), taken.data() + begin);
      });
    }
    // The far end of each line has been counted with the others: it lies on its line exactly.
    for (std::size_t k = 0; k < taken.size(); ++k)
      counts[row + grid.ends()[k] - first - 1] = static_cast<std::uint16_t>(taken[k] - 1);
  }
  return counts;
}

}  // namespace sheaf::grouping
