#include "mesh/collapse_mesh.h"

#include <algorithm>
#include <utility>

namespace sheaf::mesh {

CollapseMesh::CollapseMesh(std::vector<Triangle> triangles, std::size_t point_count)
    : triangles_(std::move(triangles)),
      first_(point_count, kEnd),
      next_(3 * triangles_.size(), kEnd),
      live_triangles_(triangles_.size()),
      marks_(point_count) {
  // Backwards, so that each list ascends.
  for (std::size_t c = next_.size(); c-- > 0;) {
    Corner& head = first_[triangles_[c / 3][c % 3]];
    if (head == kEnd) ++live_points_;
    next_[c] = std::exchange(head, static_cast<Corner>(c));
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
  forEachCorner(b, [&](Corner c) {
    Triangle& t = triangles_[c / 3];
    if (nextPoint(c) == a || lastPoint(c) == a) {
      t[0] = kGone;
      --live_triangles_;
    } else {
      t[c % 3] = a;
    }
  });
  // Join the lists: b's live corners, then a's.
  Corner last = kEnd;
  forEachCorner(b, [&](Corner c) { last = c; });
  if (last != kEnd) {
    next_[last] = first_[a];
    first_[a] = first_[b];
  }
  first_[b] = kEnd;
  --live_points_;
}

void CollapseMesh::remove(std::uint32_t triangle) {
  const Triangle t = triangles_[triangle];
  triangles_[triangle][0] = kGone;
  --live_triangles_;
  for (const std::uint32_t p : t) pruneIfUnused(p);
}

void CollapseMesh::pruneIfUnused(std::uint32_t point) {
  forEachCorner(point, [](Corner) {});
  if (first_[point] == kEnd) --live_points_;
}

}  // namespace sheaf::mesh
