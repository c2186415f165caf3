#include "grouping/cluster_shapes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "grouping/dual_graph.h"
#include "grouping/normal_cone.h"
#include "grouping/shape_tree.h"

namespace sheaf::grouping {
namespace {

// A gap between eigenvalues below this share of the greatest is round-off, and what lies between them any rotation.
constexpr double kNoGap = 1e-12;

DVec3 perpendicularTo(const DVec3& n) {
  const DVec3 a = glm::abs(n);
  const DVec3 axis = a.x <= a.y && a.x <= a.z ? DVec3(1.0, 0.0, 0.0)
                     : a.y <= a.z             ? DVec3(0.0, 1.0, 0.0)
                                              : DVec3(0.0, 0.0, 1.0);
  return glm::normalize(glm::cross(n, axis));
}

// The one of v and -v whose largest component is positive, so that the sign does not depend on an eigenvector's.
DVec3 signedUp(const DVec3& v) {
  const DVec3 a = glm::abs(v);
  const double largest = a.x >= a.y && a.x >= a.z ? v.x : a.y >= a.z ? v.y : v.z;
  return largest < 0.0 ? -v : v;
}

struct Axes {
  DVec3 normal, s;
};

// Principal axes of the corners. Where they do not determine the normal, the area vector does.
Axes axesOf(const ClusterMoments& m) {
  const Symmetric3& z = m.spread;
  Eigen::Matrix3d a;
  a << z.xx, z.xy, z.xz, z.xy, z.yy, z.yz, z.xz, z.yz, z.zz;
  const double trace = a.trace();
  if (!(trace > 0.0)) return {DVec3(0.0, 0.0, 1.0), DVec3(1.0, 0.0, 0.0)};  // all in one point
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.compute(a / trace);
  const auto column = [&](int i) {
    const Eigen::Vector3d v = solver.eigenvectors().col(i);
    return DVec3(v.x(), v.y(), v.z());
  };
  const Eigen::Vector3d values = solver.eigenvalues();  // ascending
  const double gap = kNoGap * values[2];
  Axes axes{column(0), column(2)};
  const double s_length = glm::length(m.area_vector);
  if (values[1] - values[0] <= gap && s_length > 1e-9 * m.area) {
    const DVec3 towards = m.area_vector / s_length;
    if (values[2] - values[1] <= gap) {  // a ball: any direction will do
      axes = {towards, perpendicularTo(towards)};
    } else if (const DVec3 n = towards - axes.s * glm::dot(axes.s, towards); glm::length(n) > 1e-6) {
      axes.normal = glm::normalize(n);
    }
  }
  const double side = glm::dot(axes.normal, m.area_vector);
  if (std::abs(side) <= 1e-9 * m.area)
    axes.normal = signedUp(axes.normal);
  else if (side < 0.0)
    axes.normal = -axes.normal;
  axes.s = signedUp(axes.s);
  return axes;
}

float roundDown(double x) {
  const auto f = static_cast<float>(x);
  return double{f} > x ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}
float roundUp(double x) {
  return -roundDown(-x);
}

float limited(double x) {
  constexpr double kMost = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(x, -kMost, kMost));
}

void fitBox(ClusterShape& shape, std::span<const Vec3> points) {
  if (points.empty()) return;
  const DVec3 center(shape.center), s(shape.frame.axis_s), t(shape.frame.axis_t), n(shape.frame.normal);
  DVec3 lo(std::numeric_limits<double>::infinity()), hi(-std::numeric_limits<double>::infinity());
  for (const Vec3& p : points) {
    const DVec3 d = DVec3(p) - center;
    const DVec3 at(glm::dot(d, s), glm::dot(d, t), glm::dot(d, n));
    lo = glm::min(lo, at);
    hi = glm::max(hi, at);
  }
  shape.lo = {roundDown(lo.x), roundDown(lo.y), roundDown(lo.z)};
  shape.hi = {roundUp(hi.x), roundUp(hi.y), roundUp(hi.z)};
}

}  // namespace

ClusterShape shapeFrom(const ClusterMoments& moments, std::span<const Vec3> points, const NormalCone& cone) {
  ClusterShape shape;
  const Axes axes = axesOf(moments);
  shape.center = Vec3(moments.mean);
  shape.frame = {Vec3(axes.normal), Vec3(axes.s), Vec3(glm::cross(axes.normal, axes.s))};
  shape.area_vector = {limited(moments.area_vector.x), limited(moments.area_vector.y), limited(moments.area_vector.z)};
  shape.area = limited(moments.area);
  shape.rms_distance = limited(std::sqrt(fitError(moments)));
  shape.cone = cone;
  fitBox(shape, points);
  return shape;
}

ClusterMoments objectMoments(const mesh::Mesh& mesh, std::uint32_t face) {
  const mesh::Triangle& t = mesh.triangles[face];
  if (!hasFiniteCorners(mesh, t)) return {};
  return momentsOfFace(DVec3(mesh.positions[t[0]]), DVec3(mesh.positions[t[1]]), DVec3(mesh.positions[t[2]]), 0.0);
}

bool isSound(const ClusterShape& shape) {
  const PlaneFrame& f = shape.frame;
  const auto near = [](double x, double expected) { return std::abs(x - expected) <= 1e-4; };  // false for NaN
  const auto dot = [](const Vec3& a, const Vec3& b) { return glm::dot(DVec3(a), DVec3(b)); };
  const bool is_frame = near(dot(f.normal, f.normal), 1.0) && near(dot(f.axis_s, f.axis_s), 1.0) &&
                        near(dot(f.normal, f.axis_s), 0.0) &&
                        near(glm::distance(glm::cross(DVec3(f.normal), DVec3(f.axis_s)), DVec3(f.axis_t)), 0.0);
  const Vec3 &lo = shape.lo, &hi = shape.hi, &s = shape.area_vector;
  return is_frame && isFinite(shape.center) && lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z &&
         !std::isnan(s.x + s.y + s.z) && shape.area >= 0.0F && shape.rms_distance >= 0.0F &&
         near(dot(shape.cone.axis, shape.cone.axis), 1.0) && shape.cone.sin_angle >= 0.0F;
}

ClusterShape shapeOfFaces(const mesh::Mesh& mesh, std::span<const std::uint32_t> faces) {
  ClusterMoments moments;
  std::vector<Vec3> points;
  std::vector<DVec3> normals;
  for (const std::uint32_t f : faces) {
    const ClusterMoments m = objectMoments(mesh, f);
    if (m.corners == 0.0) continue;
    moments = joined(moments, m, 0.0);
    for (const std::uint32_t v : mesh.triangles[f]) points.push_back(mesh.positions[v]);
    if (m.area > 0.0) normals.push_back(m.area_vector / m.area);
  }
  return shapeFrom(moments, points, coneOf(normals));
}

}  // namespace sheaf::grouping
