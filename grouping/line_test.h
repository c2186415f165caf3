// grouping/line_test: can this line take that vertex? The one test of linear grouping, for both metrics, used by the
// fast and by the naive search, so that they agree to the last bit.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "grouping/quadric.h"

namespace sheaf::grouping {

/// Vertices are numbered as in the `in_use` that this was made from.
class LineTest {
 public:
  /// eps          length
  /// ellipsoids   by mesh vertex, or empty for the distance metric
  LineTest(std::span<const Vec3> positions, std::span<const std::uint32_t> in_use, double eps,
           std::span<const Sym3> ellipsoids, bool segment_only);

  const DVec3& position(std::uint32_t v) const { return position_[v]; }
  /// The vertex can be taken only by lines that come this near; rounded up.
  double reach(std::uint32_t v) const { return whiten_.empty() ? eps_ * 1.000001 : reach_[v]; }

  /// Whether two vertices are far enough apart (more than eps) to give a direction.
  bool isLine(std::uint32_t i, std::uint32_t j) const {
    const DVec3 direction = position_[j] - position_[i];
    return glm::dot(direction, direction) > eps_ * eps_;
  }

  /// p is another vertex than i and j.
  bool takes(std::uint32_t i, std::uint32_t j, std::uint32_t p) const {
    return takes(p, position_[p] - position_[i], position_[j] - position_[i]);
  }

  /// The same with to_p = p - V1 and along = V2 - V1 at hand. Squared distance as |w x L|^2 / |L|^2, which does not
  /// cancel; for the quadric metric in the space where the ellipsoid of p is the unit ball.
  bool takes(std::uint32_t p, DVec3 to_p, DVec3 along) const {
    double limit = eps_ * eps_;
    if (!whiten_.empty()) {
      to_p = whiten(p, to_p);
      along = whiten(p, along);
      limit = whiten_[p].limit;
    }
    const DVec3 across = glm::cross(to_p, along);
    const double ll = glm::dot(along, along);
    if (!(glm::dot(across, across) <= limit * ll)) return false;
    if (!segment_only_) return true;
    const double t = glm::dot(to_p, along);
    return t >= 0.0 && t <= ll;
  }

  /// V2 - V1 of a line, and its square.
  struct Along {
    DVec3 direction;
    double length2;
  };

  /// Adds 1 to the counts of the lines from one V1 that take p; to_p = p - V1.
  void addTakers(std::uint32_t p, const DVec3& to_p, std::span<const Along> lines, std::uint32_t* counts) const {
    if (!whiten_.empty() || segment_only_) {
      for (std::size_t k = 0; k < lines.size(); ++k) counts[k] += takes(p, to_p, lines[k].direction) ? 1U : 0U;
      return;
    }
    // The commonest case without branches; the same arithmetic as in takes().
    const double limit = eps_ * eps_;
    for (std::size_t k = 0; k < lines.size(); ++k) {
      const DVec3 across = glm::cross(to_p, lines[k].direction);
      counts[k] += glm::dot(across, across) <= limit * lines[k].length2 ? 1U : 0U;
    }
  }

 private:
  // Lower triangular W with W'W = inverse(R); then the ellipsoid is |W x|^2 <= limit = 1. A vertex that cannot move has
  // W = I and limit 0: it is taken by lines through it.
  struct Whitening {
    double xx = 1.0, yx = 0.0, yy = 1.0, zx = 0.0, zy = 0.0, zz = 1.0;
    double limit = 0.0;
  };
  static Whitening whiteningOf(const Sym3& ellipsoid);
  DVec3 whiten(std::uint32_t p, const DVec3& d) const {
    const Whitening& w = whiten_[p];
    return {w.xx * d.x, w.yx * d.x + w.yy * d.y, w.zx * d.x + w.zy * d.y + w.zz * d.z};
  }

  std::vector<DVec3> position_;
  std::vector<Whitening> whiten_;  // empty for the distance metric
  std::vector<double> reach_;      // the same
  double eps_;
  bool segment_only_;
};

}  // namespace sheaf::grouping
