// grouping/cluster_cost: what is known of a face cluster in a fixed number of sums, and what joining two costs [HFC].
//   Keeps  sums are about their own means (centred moments): nothing cancels, wherever and however flat the cluster is
#pragma once

#include "core/math.h"

namespace sheaf::grouping {

/// A symmetric 3x3 matrix.
struct Symmetric3 {
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;

  static Symmetric3 square(const DVec3& v, double weight) {
    const DVec3 w = weight * v;
    return {w.x * v.x, w.x * v.y, w.x * v.z, w.y * v.y, w.y * v.z, w.z * v.z};
  }
  Symmetric3& operator+=(const Symmetric3& m) {
    xx += m.xx, xy += m.xy, xz += m.xz, yy += m.yy, yz += m.yz, zz += m.zz;
    return *this;
  }
  friend Symmetric3 operator+(Symmetric3 a, const Symmetric3& b) { return a += b; }
  /// v'Mv
  double at(const DVec3& v) const {
    return xx * v.x * v.x + yy * v.y * v.y + zz * v.z * v.z + 2.0 * (xy * v.x * v.y + xz * v.x * v.z + yz * v.y * v.z);
  }
};

/// Least eigenvalue of a positive semi-definite matrix, in closed form: within 4e-8 of the trace always, within 1e-14
/// of it if the middle eigenvalue is at least a hundredth of the trace above the least. Never negative; 0 for 0. No
/// libm call but sqrt, so the same bits everywhere.
double leastEigenvalue(const Symmetric3& m);

/// The dual quadrics of [HFC], centred. A is sum(v v') over the corners of all faces, so that a vertex counts once per
/// face; the orientation quadric is kept as sum(w n n') about the mean normal.
struct ClusterMoments {
  double corners = 0.0;    ///< three per face
  DVec3 mean{0.0};         ///< of the corners
  Symmetric3 spread;       ///< sum (v - mean)(v - mean)'
  double area = 0.0;       ///< w
  DVec3 area_vector{0.0};  ///< S, sum of area times unit normal
  Symmetric3 turn;         ///< sum w_i (n_i - S/w)(n_i - S/w)'
  double perimeter = 0.0;  ///< rho, length of all edges of the mesh that have a face inside and none or another outside
};

/// a, b, c    corners, counter-clockwise
/// perimeter  of the face, without edges that it has twice
ClusterMoments momentsOfFace(const DVec3& a, const DVec3& b, const DVec3& c, double perimeter);

/// Of both together. border  length of the edges that they share
ClusterMoments joined(const ClusterMoments& a, const ClusterMoments& b, double border);

/// How much each term counts. [HFC] adds up the first three and knows no fourth: that is {1, 1, 1, 0}. But all three
/// are means, so a large cluster takes in one more face almost for nothing, and the hierarchy becomes a chain: 70,000
/// faces of a scan lie 320 levels deep on average, and a cut into clusters of at most 512 leaves 8000. With the default
/// they lie 19 deep, and the cut leaves 230, as flat as before.
struct CostWeights {
  double fit = 1.0;        ///< mean squared distance of the corners to their plane, model frame
  double direction = 1.0;  ///< mean of (1 - cos)^2 of the normals' angles to the mean normal, 0 to 4
  double shape = 1.0;      ///< loss of roundness, -1 to 1
  double balance = 0.1;    ///< log2 of the number of faces, up to a constant, with straight lines between powers of 2
  bool operator==(const CostWeights&) const = default;
};

/// E_fit: mean squared distance of the corners to the plane that fits them best.
double fitError(const ClusterMoments& m);
/// E_dir, for the normal S/|S|; for the plane's normal if S vanishes.
double directionError(const ClusterMoments& m);
/// gamma: squared perimeter / (4 pi area), 1 for a disc; infinity without area.
double irregularity(const ClusterMoments& m);

/// What joining a and b costs, in the terms of joined(a, b, border). Symmetric in a and b to the bit, never NaN.
///   E_shape = 1 - max(gamma_a, gamma_b) / gamma, clamped to [-1, 1]: below a plane's disc gamma has no bound. 0 if the
///             perimeter vanishes (a closed surface) or there is no area. Deviation: [HFC] has no such cases
double joinCost(const ClusterMoments& a, const ClusterMoments& b, double border, const CostWeights& weights);

}  // namespace sheaf::grouping
