#include "grouping/cluster_cost.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace sheaf::grouping {
namespace {

// Below this share of the area the area vector is round-off: the cluster is as good as closed.
constexpr double kNoDirection = 1e-9;
// Below this share of the area the squared perimeter is round-off.
constexpr double kNoPerimeter = 1e-12;

// cos(2/3 acos(x)) for x in [0, 1]. The function has its only singularity at -1, so that its Chebyshev series about 1/2
// falls by 5.8 with every term; 16 of them leave 7e-15.
double cosineOfTwoThirds(double x) {
  const double y = 2.0 * x - 1.0, y2 = y * y, y4 = y2 * y2, y8 = y4 * y4;
  const double c0 =
      (0.7660444431189841 + 0.24740906632283724 * y) + (-0.015509188437182596 + 0.0024663528158301723 * y) * y2;
  const double c4 = (-0.0005041246772059527 + 0.00011642544296061597 * y) +
                    (-2.8920043607327806e-05 + 7.541138597688679e-06 * y) * y2;
  const double c8 = (-2.0354621861340405e-06 + 5.63960214527981e-07 * y) +
                    (-1.6038114392102898e-07 + 4.6202540460171804e-08 * y) * y2;
  const double c12 = (-1.2407959104621114e-08 + 3.5860452385350072e-09 * y) +
                     (-1.7096937199312379e-09 + 5.309743755788077e-10 * y) * y2;
  return (c0 + c4 * y4) + (c8 + c12 * y4) * y8;
}

DVec3 planeNormal(const Symmetric3& m) {
  Eigen::Matrix3d a;
  a << m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(a);
  const Eigen::Vector3d n = solver.eigenvectors().col(0);
  return {n.x(), n.y(), n.z()};
}

// Of w1 (s - s1)^2 + w2 (s - s2)^2 about the common mean: u u' times this, where u = w2 S1 - w1 S2.
double turnFactor(double w1, double w2) {
  const double product = w1 * w2 * (w1 + w2);
  return product > 1e-300 ? 1.0 / product : 0.0;
}

// turn_at_normal  n' turn n, for the unit normal n whose product with S is `along`
double directionError(double along, double area, double turn_at_normal) {
  if (!(area > 0.0)) return 0.0;
  const double mean = (area - along) / area;  // 1 - n.s; what varies about it is uncorrelated, so the squares add up
  return std::max(0.0, mean * mean + turn_at_normal / area);
}

double shapeCost(const ClusterMoments& a, const ClusterMoments& b, double area, double perimeter) {
  const double square = perimeter * perimeter;
  if (!(area > 0.0) || square < kNoPerimeter * area) return 0.0;
  if (!(a.area > 0.0) || !(b.area > 0.0)) return -1.0;
  const double a2 = a.perimeter * a.perimeter, b2 = b.perimeter * b.perimeter;
  const double before = a2 * b.area >= b2 * a.area ? a2 / a.area : b2 / b.area;
  return std::clamp(1.0 - before * area / square, -1.0, 1.0);
}

// log2(x) at powers of 2, straight lines between them: exact arithmetic on the bits, the same everywhere.
double roughLog2(double x) {
  return static_cast<double>(std::bit_cast<std::int64_t>(x)) * 0x1p-52 - 1023.0;
}

Symmetric3 joinedSpread(const ClusterMoments& a, const ClusterMoments& b) {
  const double corners = a.corners + b.corners;
  const double factor = corners > 0.0 ? a.corners * b.corners / corners : 0.0;
  return (a.spread + b.spread) + Symmetric3::square(a.mean - b.mean, factor);
}

double joinedPerimeter(const ClusterMoments& a, const ClusterMoments& b, double border) {
  return std::max(0.0, (a.perimeter + b.perimeter) - 2.0 * border);
}

}  // namespace

double leastEigenvalue(const Symmetric3& m) {
  // [Smi61]: the eigenvalues of (M - mean) / p are twice the cosines of thirds of one angle.
  const double mean = (m.xx + m.yy + m.zz) / 3.0;
  const double xx = m.xx - mean, yy = m.yy - mean, zz = m.zz - mean;
  const double off = m.xy * m.xy + m.xz * m.xz + m.yz * m.yz;
  const double p2 = (xx * xx + yy * yy + zz * zz + 2.0 * off) / 6.0;
  const double p = std::sqrt(p2), p3 = p2 * p;
  if (!(p3 > 0.0)) return std::max(0.0, mean);
  const double det = xx * (yy * zz - m.yz * m.yz) - m.xy * (m.xy * zz - m.yz * m.xz) + m.xz * (m.xy * m.yz - yy * m.xz);
  const double r = std::clamp(det / (2.0 * p3), -1.0, 1.0);  // cosine of the angle
  return std::max(0.0, mean - 2.0 * p * cosineOfTwoThirds(std::sqrt(0.5 * (1.0 - r))));
}

ClusterMoments momentsOfFace(const DVec3& a, const DVec3& b, const DVec3& c, double perimeter) {
  ClusterMoments m;
  m.corners = 3.0;
  m.mean = (a + b + c) / 3.0;
  m.spread =
      Symmetric3::square(a - m.mean, 1.0) + Symmetric3::square(b - m.mean, 1.0) + Symmetric3::square(c - m.mean, 1.0);
  m.area_vector = 0.5 * glm::cross(b - a, c - a);
  m.area = glm::length(m.area_vector);
  m.perimeter = perimeter;
  return m;
}

ClusterMoments joined(const ClusterMoments& a, const ClusterMoments& b, double border) {
  ClusterMoments m;
  m.corners = a.corners + b.corners;
  m.mean = m.corners > 0.0 ? (a.corners * a.mean + b.corners * b.mean) / m.corners : a.mean;
  m.spread = joinedSpread(a, b);
  m.area = a.area + b.area;
  m.area_vector = a.area_vector + b.area_vector;
  m.turn = (a.turn + b.turn) +
           Symmetric3::square(b.area * a.area_vector - a.area * b.area_vector, turnFactor(a.area, b.area));
  m.perimeter = joinedPerimeter(a, b, border);
  return m;
}

double fitError(const ClusterMoments& m) {
  return m.corners > 0.0 ? leastEigenvalue(m.spread) / m.corners : 0.0;
}

double directionError(const ClusterMoments& m) {
  const double length = glm::length(m.area_vector);
  if (length >= kNoDirection * m.area && length > 0.0)
    return directionError(length, m.area, m.turn.at(m.area_vector / length));
  const DVec3 n = planeNormal(m.spread);
  return directionError(std::abs(glm::dot(n, m.area_vector)), m.area, m.turn.at(n));
}

double irregularity(const ClusterMoments& m) {
  if (!(m.area > 0.0)) return std::numeric_limits<double>::infinity();
  return m.perimeter * m.perimeter / (4.0 * kPi * m.area);
}

double joinCost(const ClusterMoments& a, const ClusterMoments& b, double border, const CostWeights& weights) {
  const Symmetric3 spread = joinedSpread(a, b);
  const double fit = leastEigenvalue(spread) / std::max(1.0, a.corners + b.corners);

  const double area = a.area + b.area;
  const DVec3 s = a.area_vector + b.area_vector;
  double length = glm::length(s);
  DVec3 n(0.0);
  if (length >= kNoDirection * area && length > 0.0) {
    n = s / length;
  } else {
    n = planeNormal(spread);
    length = std::abs(glm::dot(n, s));
  }
  const double across = glm::dot(n, b.area * a.area_vector - a.area * b.area_vector);
  const double turn = (a.turn.at(n) + b.turn.at(n)) + across * across * turnFactor(a.area, b.area);
  const double direction = directionError(length, area, turn);

  const double shape = shapeCost(a, b, area, joinedPerimeter(a, b, border));
  return weights.fit * fit + weights.direction * direction + weights.shape * shape +
         weights.balance * roughLog2(std::max(1.0, a.corners + b.corners));
}

}  // namespace sheaf::grouping
