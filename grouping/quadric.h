// grouping/quadric: quadric error of a vertex ([GH97], unweighted as in [PG] 5.1), kept in centred form: every plane of
// the sum passes through the vertex v, so Q(v + x) = x'Ax with A = sum n n'. The 4x4 quadric is singular for every
// vertex and is never formed.
//   Words  ellipsoid: { x : x'Ax <= eps^2 }; its matrix here is R = eps^2 inverse(A), so that it reaches
//          sqrt(n'Rn) along the unit vector n. A sphere of radius eps, R = eps^2 I, gives the distance metric.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/math.h"
#include "grouping/vertex_groups.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

/// Symmetric 3x3 matrix.
struct Sym3 {
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;

  static Sym3 scaledIdentity(double d) { return {d, 0.0, 0.0, d, 0.0, d}; }
  double trace() const { return xx + yy + zz; }
  double determinant() const;
  DVec3 times(const DVec3& v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
  void add(const Sym3& m) {
    xx += m.xx, xy += m.xy, xz += m.xz;
    yy += m.yy, yz += m.yz, zz += m.zz;
  }
  /// this += weight * n n'
  void addOuter(const DVec3& n, double weight = 1.0);
  bool operator==(const Sym3&) const = default;
};

/// Inverse by cofactors, which is the closed form for axis planes: column k over its k-th entry is the placement on a
/// plane across axis k. `m` is positive definite.
Sym3 inverse(const Sym3& m);

/// Eigenvalues descending, clamped at 0; columns of `vectors` are the unit eigenvectors.
struct Eigen3 {
  DVec3 values;
  DMat3 vectors;
};
Eigen3 eigenDecomposition(const Sym3& m);
/// vectors * diag(values) * vectors'
Sym3 compose(const Eigen3& e);

/// Weight of the planes that hold an open edge in place: [GH98], here without the edge's length.
inline constexpr double kBoundaryWeight = 1000.0;
/// A is taken as degenerate below this ratio of smallest to largest eigenvalue, boundary planes weighing 1.
inline constexpr double kDegenerateRatio = 1e-4;
/// Radius of the sphere that replaces a degenerate ellipsoid, in eps: [PG] 5.1 says "very small".
inline constexpr double kDegenerateRadius = 0.1;
/// Safe limit: reach of an ellipsoid in smallest altitudes of the faces around it. A face can only lose its area if one
/// line meets all three displacement discs, which takes a radius of half its smallest altitude.
inline constexpr double kSafeReach = 0.4999;

/// A of every vertex: unit normals of the faces around it, and `boundary_weight` times the planes through its open
/// edges that stand upright on their face.
/// return  #V; 0 for a vertex without faces that have area
std::vector<Sym3> vertexQuadrics(const mesh::Mesh& mesh, double boundary_weight);

/// R of every vertex's ellipsoid, limited. Always positive definite, unless eps or an altitude is 0.
/// eps     length, >= 0
/// return  #V; vertices that no face with area uses get a sphere: of radius eps (kPaper) or 0 (kSafe, if some face
///         without area uses them, since any movement could turn that face over)
std::vector<Sym3> vertexEllipsoids(const mesh::Mesh& mesh, double eps, Limit limit);

/// The least-error point on the plane n.x = delta, seen from the vertex: [PG] eq. 9, corrected to three dimensions.
/// reach_n  R n; n.reach_n > 0
inline DVec3 placeOnPlane(const DVec3& n, const DVec3& reach_n, double delta) {
  return (delta / glm::dot(n, reach_n)) * reach_n;
}

/// The least-error parameter on the line V + t L: [PG] eq. 8, corrected: y = A L in place of A V. Falls back to the
/// nearest point if L is (nearly) in the null space of A.
/// from_vertex  V - v
double placeOnLine(const Sym3& a, const DVec3& from_vertex, const DVec3& direction);

}  // namespace sheaf::grouping
