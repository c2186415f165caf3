// mesh/quadric: the quadratic form of squared distances to planes, and where an edge is best collapsed to.
#pragma once

#include <algorithm>

#include "core/math.h"

namespace sheaf::mesh {

/// Q(x) = x'Ax + 2 b'x + c with symmetric A: a weighted sum of squared distances [GH97 §3].
struct Quadric {
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;
  DVec3 b{0.0};
  double c = 0.0;

  /// weight * (n.x + d)^2; n need not be unit.
  static Quadric ofPlane(const DVec3& n, double d, double weight) {
    const DVec3 wn = weight * n;
    return {wn.x * n.x, wn.x * n.y, wn.x * n.z, wn.y * n.y, wn.y * n.z, wn.z * n.z, d * wn, weight * d * d};
  }

  Quadric& operator+=(const Quadric& q) {
    xx += q.xx, xy += q.xy, xz += q.xz, yy += q.yy, yz += q.yz, zz += q.zz;
    b += q.b;
    c += q.c;
    return *this;
  }
  Quadric& operator-=(const Quadric& q) {
    xx -= q.xx, xy -= q.xy, xz -= q.xz, yy -= q.yy, yz -= q.yz, zz -= q.zz;
    b -= q.b;
    c -= q.c;
    return *this;
  }
  friend Quadric operator+(Quadric p, const Quadric& q) { return p += q; }

  DVec3 timesA(const DVec3& v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
  double at(const DVec3& v) const { return glm::dot(v, timesA(v) + 2.0 * b) + c; }
  double trace() const { return xx + yy + zz; }
};

struct Placement {
  DVec3 at{0.0};
  double cost = 0.0;  ///< Q there, not below 0
};

/// The point that minimises q, if that is well defined and near the edge from u to v; else the best point of the edge.
inline Placement bestPlacement(const Quadric& q, const DVec3& u, const DVec3& v) {
  const DVec3 middle = 0.5 * (u + v), edge = v - u;
  const double length2 = glm::dot(edge, edge);
  const DVec3 slope = q.timesA(middle) + q.b;  // half the gradient
  const double at_middle = q.at(middle);
  // Cofactors of A.
  const double cxx = q.yy * q.zz - q.yz * q.yz, cxy = q.xz * q.yz - q.xy * q.zz, cxz = q.xy * q.yz - q.yy * q.xz;
  const double cyy = q.xx * q.zz - q.xz * q.xz, cyz = q.xy * q.xz - q.xx * q.yz, czz = q.xx * q.yy - q.xy * q.xy;
  const double det = q.xx * cxx + q.xy * cxy + q.xz * cxz;
  const double scale = q.trace() / 3.0;
  if (det > 1e-9 * scale * scale * scale) {
    const DVec3 step =
        DVec3(cxx * slope.x + cxy * slope.y + cxz * slope.z, cxy * slope.x + cyy * slope.y + cyz * slope.z,
              cxz * slope.x + cyz * slope.y + czz * slope.z) *
        (-1.0 / det);
    if (glm::dot(step, step) <= 4.0 * length2) return {middle + step, std::max(0.0, at_middle + glm::dot(slope, step))};
  }
  // Along the edge Q is a parabola in t, -0.5 <= t <= 0.5, around the middle.
  const double bend = glm::dot(edge, q.timesA(edge)), tilt = glm::dot(slope, edge);
  const double t = bend > 1e-12 * q.trace() * length2 ? std::clamp(-tilt / bend, -0.5, 0.5) : 0.0;
  return {middle + t * edge, std::max(0.0, at_middle + t * (2.0 * tilt + t * bend))};
}

}  // namespace sheaf::mesh
