#include "mesh/triangle_queries.h"

#include <algorithm>

namespace sheaf::mesh {
namespace {

struct Range {
  double lo, hi;
};

Range along(const Corners& t, const DVec3& axis) {
  const double a = glm::dot(t[0], axis), b = glm::dot(t[1], axis), c = glm::dot(t[2], axis);
  return {std::min({a, b, c}), std::max({a, b, c})};
}

// Strictly: the zero vector separates nothing.
bool separates(const DVec3& axis, const Corners& a, const Corners& b) {
  const Range ra = along(a, axis), rb = along(b, axis);
  return ra.hi < rb.lo || rb.hi < ra.lo;
}

Corners edgesOf(const Corners& t) {
  return {t[1] - t[0], t[2] - t[1], t[0] - t[2]};
}

}  // namespace

// [E05] §5.1.5, by Voronoi regions.
DVec3 closestPoint(const Corners& t, const DVec3& p) {
  const DVec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return t[0];
  const DVec3 bp = p - t[1];
  const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return t[1];
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return t[0] + ab * (d1 > d3 ? d1 / (d1 - d3) : 0.0);
  const DVec3 cp = p - t[2];
  const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return t[2];
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return t[0] + ac * (d2 > d6 ? d2 / (d2 - d6) : 0.0);
  const double va = d3 * d6 - d5 * d4, along = d4 - d3, back = d5 - d6;
  if (va <= 0.0 && along >= 0.0 && back >= 0.0)
    return t[1] + (t[2] - t[1]) * (along + back > 0.0 ? along / (along + back) : 0.0);
  const double sum = va + vb + vc;
  return sum > 0.0 ? t[0] + ab * (vb / sum) + ac * (vc / sum) : t[0];
}

std::optional<double> meetLine(const Corners& triangle, const DVec3& origin, const DVec3& direction) {
  const DVec3 a = triangle[0] - origin, b = triangle[1] - origin, c = triangle[2] - origin;
  // Volumes of direction and edge. That of an edge the other way round has the other sign and the same bits otherwise.
  const double wa = glm::dot(direction, glm::cross(b, c));
  const double wb = glm::dot(direction, glm::cross(c, a));
  const double wc = glm::dot(direction, glm::cross(a, b));
  const bool is_inside = (wa >= 0.0 && wb >= 0.0 && wc >= 0.0) || (wa <= 0.0 && wb <= 0.0 && wc <= 0.0);
  const double sum = wa + wb + wc;
  if (!is_inside || sum == 0.0) return std::nullopt;
  const DVec3 met = (wa / sum) * a + (wb / sum) * b + (wc / sum) * c;
  return glm::dot(met, direction) / glm::dot(direction, direction);
}

// Of two convex sets that have no point in common, a face of one, or an edge of each, separates them; of two in one
// plane, a direction in it, across an edge.
bool overlap(const Corners& a, const Corners& b) {
  // Differences to a corner: what is far from the origin does not lose its low bits in products.
  const DVec3 o = a[0];
  const Corners p = {DVec3(0.0), a[1] - o, a[2] - o}, q = {b[0] - o, b[1] - o, b[2] - o};
  const Corners edges_p = edgesOf(p), edges_q = edgesOf(q);
  const DVec3 normal_p = glm::cross(edges_p[0], edges_p[1]), normal_q = glm::cross(edges_q[0], edges_q[1]);
  if (normal_p == DVec3(0.0) || normal_q == DVec3(0.0)) return false;
  if (separates(normal_p, p, q) || separates(normal_q, p, q)) return false;
  for (const DVec3& e : edges_p) {
    if (separates(glm::cross(normal_p, e), p, q)) return false;
    for (const DVec3& f : edges_q)
      if (separates(glm::cross(e, f), p, q)) return false;
  }
  return std::ranges::none_of(edges_q, [&](const DVec3& f) { return separates(glm::cross(normal_q, f), p, q); });
}

}  // namespace sheaf::mesh
