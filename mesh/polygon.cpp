// Ear clipping after Meisters, Polygons have ears, American Mathematical Monthly 82, 1975. Two deviations for what
// files contain: corners at the place of an ear's corner do not block it (bridges to holes), and when no strict ear is
// left, corners on the ear's outline stop blocking, too.
#include "mesh/polygon.h"

namespace sheaf::mesh {
namespace {

using Point = glm::dvec2;

// Point tests before giving up, about a second's worth.
constexpr std::size_t kMaxTests = 200'000'000;

double orientation(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Twice the area vector. Relative to corner 0, so that a polygon far from the origin keeps its digits.
DVec3 newellNormal(std::span<const Vec3> corners) {
  DVec3 sum(0.0);
  const DVec3 origin(corners[0]);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    sum += glm::cross(DVec3(corners[i]) - origin, DVec3(corners[i + 1]) - origin);
  return sum;
}

// Drops the coordinate along which the normal is longest: an affine image of the polygon in its plane, in exact
// coordinates, counter-clockwise as seen along +z.
std::vector<Point> projectAlong(const DVec3& normal, std::span<const Vec3> corners) {
  const DVec3 size = glm::abs(normal);
  const int k = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const bool flip = normal[k] < 0.0;
  std::vector<Point> points;
  points.reserve(corners.size());
  for (const Vec3& c : corners) points.emplace_back(flip ? c[j] : c[i], flip ? c[i] : c[j]);
  return points;
}

class EarClipper {
 public:
  EarClipper(std::vector<Point> points, std::vector<Triangle>& out)
      : points_(std::move(points)), next_(points_.size()), previous_(points_.size()), left_(points_.size()), out_(out) {
    const auto n = static_cast<std::uint32_t>(points_.size());
    for (std::uint32_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[i] = (i + n - 1) % n;
    }
    std::uint32_t at = 0;
    for (std::uint32_t steps = 0; steps < 2 * n && left_ > 3; ++steps) at = next_[dropSpikes(at)];
    first_ = at;
    do {
      if (turn(at) <= 0.0) reflex_.push_back(at);
      at = next_[at];
    } while (at != first_);
  }

  // False if some of it had to be cut as a fan.
  bool clip() {
    std::uint32_t at = next_[first_];
    do {
      clipEars(at, true);
      clipEars(at, false);
    } while (left_ > 3 && dropFlatCorner(at));
    const bool whole = left_ == 3 && turn(at) >= 0.0;
    // A fan around the corner before `at`; of a triangle that is the triangle.
    for (const std::uint32_t apex = previous_[at]; left_ >= 3;) cut(next_[apex]);
    return whole;
  }

 private:
  // Positive at a convex corner.
  double turn(std::uint32_t i) const { return orientation(points_[previous_[i]], points_[i], points_[next_[i]]); }

  void clipEars(std::uint32_t& at, bool strict) {
    for (std::size_t misses = 0; left_ > 3 && misses < left_ && tests_ < kMaxTests;) {
      const bool ear = isEar(at, strict);
      misses = ear ? 0 : misses + 1;
      at = ear ? cut(at) : next_[at];
    }
  }

  bool isEar(std::uint32_t i, bool strict) {
    const Point a = points_[previous_[i]], b = points_[i], c = points_[next_[i]];
    if (!(orientation(a, b, c) > 0.0)) return false;
    // Corners never become reflex by cutting, so the list only shrinks.
    std::erase_if(reflex_, [&](std::uint32_t r) { return next_[r] == r; });
    tests_ += reflex_.size();
    for (const std::uint32_t r : reflex_) {
      const Point& p = points_[r];
      if (p == a || p == b || p == c) continue;
      const double ab = orientation(a, b, p), bc = orientation(b, c, p), ca = orientation(c, a, p);
      if (strict ? ab >= 0.0 && bc >= 0.0 && ca >= 0.0 : ab > 0.0 && bc > 0.0 && ca > 0.0) return false;
    }
    return true;
  }

  // A corner at its neighbour's place, or one where the outline goes back the way it came. Such a corner would make a
  // reflex corner beside it look convex.
  bool isSpike(std::uint32_t i) const {
    const Point &a = points_[previous_[i]], &b = points_[i], &c = points_[next_[i]];
    return turn(i) == 0.0 && (a == b || b == c || glm::dot(a - b, c - b) > 0.0);
  }

  // Takes out the spike that may be at i, and those that appear by that; returns a corner near i that is left.
  std::uint32_t dropSpikes(std::uint32_t i) {
    while (left_ > 3 && isSpike(i)) i = previous_[unlink(i)];
    return i;
  }

  // Emits the ear at i and takes the corner out; returns the next one.
  std::uint32_t cut(std::uint32_t i) {
    if (turn(i) != 0.0) out_.push_back({previous_[i], i, next_[i]});
    return next_[dropSpikes(previous_[dropSpikes(unlink(i))])];
  }

  // Returns the next corner.
  std::uint32_t unlink(std::uint32_t i) {
    const std::uint32_t before = previous_[i], after = next_[i];
    next_[before] = after;
    previous_[after] = before;
    next_[i] = i;
    --left_;
    return after;
  }

  // Takes out one corner on a straight line, which is no ear; true if there was one.
  bool dropFlatCorner(std::uint32_t& at) {
    for (std::size_t n = 0; n < left_; ++n, at = next_[at]) {
      if (turn(at) != 0.0) continue;
      at = unlink(at);
      return true;
    }
    return false;
  }

  std::vector<Point> points_;
  std::vector<std::uint32_t> next_, previous_;  // ring of the corners left; a corner taken out points at itself
  std::vector<std::uint32_t> reflex_;           // corners that may block an ear
  std::size_t left_;
  std::uint32_t first_ = 0;
  std::size_t tests_ = 0;
  std::vector<Triangle>& out_;
};

}  // namespace

bool triangulatePolygon(std::span<const Vec3> corners, std::vector<Triangle>& out) {
  if (corners.size() < 3) return true;
  if (corners.size() == 3) {
    out.push_back({0, 1, 2});
    return true;
  }
  const DVec3 normal = newellNormal(corners);
  const double square = glm::dot(normal, normal);
  if (square > 0.0 && square <= std::numeric_limits<double>::max())
    return EarClipper(projectAlong(normal, corners), out).clip();
  for (std::uint32_t i = 1; i + 1 < corners.size(); ++i) out.push_back({0, i, i + 1});
  return false;
}

}  // namespace sheaf::mesh
