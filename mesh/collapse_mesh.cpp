#include "mesh/collapse_mesh.h"

#include <algorithm>
#include <utility>

namespace sheaf::mesh {

CollapseMesh::CollapseMesh(std::span<const Triangle> triangles, std::size_t point_count)
    : triangles_(triangles.size()),
      first_(point_count, kEnd),
      corner_count_(point_count, 0),
      live_triangles_(triangles.size()),
      marks_(point_count) {
  // Backwards, so that each list ascends.
  for (std::size_t f = triangles.size(); f-- > 0;) {
    triangles_[f].points = triangles[f];
    for (std::size_t k = 3; k-- > 0;) {
      const std::uint32_t p = triangles[f][k];
      if (corner_count_[p]++ == 0) ++live_points_;
      triangles_[f].next[k] = std::exchange(first_[p], static_cast<Corner>(3 * f + k));
    }
  }
}

void CollapseMesh::startRound() {
  ring_.clear();
  if (++round_ == 0) {
    std::fill(marks_.begin(), marks_.end(), Mark{});
    round_ = 1;
  }
}

CollapseMesh::Mark& CollapseMesh::markOf(std::uint32_t point) {
  Mark& mark = marks_[point];
  if (mark.round != round_) {
    mark = {round_, {}, 0};
    ring_.push_back(point);
  }
  return mark;
}

void CollapseMesh::countAround(std::uint32_t point, std::size_t side) {
  forEachCorner(point, [&](Corner c) {
    ++markOf(nextPoint(c)).count[side];
    ++markOf(lastPoint(c)).count[side];
  });
}

std::span<const std::uint32_t> CollapseMesh::neighbours(std::uint32_t point) {
  startRound();
  countAround(point, 0);
  return ring_;
}

bool CollapseMesh::mayCollapse(std::uint32_t a, std::uint32_t b) {
  startRound();
  countAround(a, 0);
  countAround(b, 1);
  const std::uint32_t on_edge = markOf(a).count[1];
  if (on_edge == 0) return false;
  forEachCorner(b, [&](Corner c) {
    if (nextPoint(c) == a) ++markOf(lastPoint(c)).apexes;
    if (lastPoint(c) == a) ++markOf(nextPoint(c)).apexes;
  });
  bool a_on_curve = false, b_on_curve = false;
  std::uint32_t shared = 0;
  for (const std::uint32_t p : ring_) {
    if (p == a || p == b) continue;
    const Mark& m = marks_[p];
    a_on_curve = a_on_curve || (m.count[0] != 0 && m.count[0] != 2);
    b_on_curve = b_on_curve || (m.count[1] != 0 && m.count[1] != 2);
    if (m.count[0] == 0 || m.count[1] == 0) continue;
    ++shared;
    if (m.apexes == 0) return false;  // link condition: a neighbour of both that is on no triangle of the edge
    if (m.count[0] + m.count[1] == 2 * m.apexes) return false;  // nothing would be left on its edge
  }
  // An edge inside the surface that joins two border points: merging them would pinch the surface.
  if (on_edge == 2 && a_on_curve && b_on_curve) return false;
  return !(shared > 1 && wouldRepeatTriangle(a, b));
}

bool CollapseMesh::wouldRepeatTriangle(std::uint32_t a, std::uint32_t b) {
  bool repeats = false;
  forEachCorner(b, [&](Corner c) {
    const std::uint32_t p = nextPoint(c), q = lastPoint(c);
    if (p == a || q == a || marks_[p].count[0] == 0 || marks_[q].count[0] == 0) return;
    forEachCorner(a, [&](Corner d) {
      const std::uint32_t r = nextPoint(d), s = lastPoint(d);
      repeats = repeats || (r == p && s == q) || (r == q && s == p);
    });
  });
  return repeats;
}

void CollapseMesh::collapse(std::uint32_t a, std::uint32_t b) {
  Corner last = kEnd;
  forEachCorner(b, [&](Corner c) {
    Triangle& t = triangles_[c / 3].points;
    if (nextPoint(c) == a || lastPoint(c) == a) {
      t[0] = kGone;
      --live_triangles_;
    } else {
      t[c % 3] = a;
      last = c;
    }
  });
  // Join the lists: b's corners, then a's. What stands behind b's last live corner is gone.
  if (last != kEnd) {
    triangles_[last / 3].next[last % 3] = first_[a];
    first_[a] = first_[b];
  }
  corner_count_[a] += corner_count_[b];
  first_[b] = kEnd;
  --live_points_;
}

void CollapseMesh::remove(std::uint32_t triangle) {
  const Triangle t = triangles_[triangle].points;
  triangles_[triangle].points[0] = kGone;
  --live_triangles_;
  for (const std::uint32_t p : t) pruneIfUnused(p);
}

void CollapseMesh::pruneIfUnused(std::uint32_t point) {
  forEachCorner(point, [](Corner) {});
  if (first_[point] == kEnd) --live_points_;
}

}  // namespace sheaf::mesh
