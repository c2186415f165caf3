#include "grouping/quadric.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <optional>

#include "grouping/open_edges.h"

namespace sheaf::grouping {
namespace {

constexpr double kNoAltitude = std::numeric_limits<double>::infinity();

// What the faces around each vertex add up to.
struct FaceSums {
  std::vector<Sym3> quadric;      // unit normals, n n'
  std::vector<double> altitude2;  // the smallest, squared; kNoAltitude without faces
};

// Squares, so that no root has to be taken.
struct FacePlane {
  DVec3 normal{0.0};       // twice the area long
  double length2 = 0.0;    // of the normal
  double altitude2 = 0.0;  // of the smallest altitude; 0 for a face without area
};

FacePlane facePlane(const mesh::Mesh& mesh, const mesh::Triangle& t) {
  const DVec3 a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
  const DVec3 ab = b - a, bc = c - b, ca = a - c;
  const DVec3 normal = glm::cross(ab, -ca);
  const double length2 = glm::dot(normal, normal);
  if (!(length2 > 0.0)) return {};
  return {normal, length2, length2 / std::max({glm::dot(ab, ab), glm::dot(bc, bc), glm::dot(ca, ca)})};
}

FaceSums sumFaces(const mesh::Mesh& mesh) {
  FaceSums sums{std::vector<Sym3>(mesh.vertexCount()), std::vector<double>(mesh.vertexCount(), kNoAltitude)};
  for (const mesh::Triangle& t : mesh.triangles) {
    const FacePlane face = facePlane(mesh, t);
    Sym3 plane;
    if (face.length2 > 0.0) plane.addOuter(face.normal, 1.0 / face.length2);
    for (const std::uint32_t v : t) {
      sums.altitude2[v] = std::min(sums.altitude2[v], face.altitude2);
      sums.quadric[v].add(plane);
    }
  }
  return sums;
}

void addBoundaryPlanes(const mesh::Mesh& mesh, double weight, std::vector<Sym3>& quadrics) {
  for (const OpenEdge& edge : findOpenEdges(mesh)) {
    const FacePlane face = facePlane(mesh, mesh.triangles[edge.face]);
    const DVec3 along = DVec3(mesh.positions[edge.b]) - DVec3(mesh.positions[edge.a]);
    const DVec3 upright = glm::cross(along, face.normal);
    const double length = glm::length(upright);
    if (!(length > 0.0)) continue;
    quadrics[edge.a].addOuter(upright / length, weight);
    quadrics[edge.b].addOuter(upright / length, weight);
  }
}

Eigen::Matrix3d matrixOf(const Sym3& m) {
  Eigen::Matrix3d matrix;
  matrix << m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz;
  return matrix;
}

Eigen3 descending(const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>& solver) {
  Eigen3 e;
  for (int k = 0; k < 3; ++k) {  // Eigen's order is ascending
    e.values[k] = std::max(0.0, solver.eigenvalues()[2 - k]);
    for (int row = 0; row < 3; ++row) e.vectors[k][row] = solver.eigenvectors()(row, 2 - k);
  }
  return e;
}

bool isPositiveDefinite(const Sym3& m) {
  return m.xx > 0.0 && m.xx * m.yy - m.xy * m.xy > 0.0 && m.determinant() > 0.0;
}

// m - d I
Sym3 lessOnDiagonal(const Sym3& m, double d) {
  return {m.xx - d, m.xy, m.xz, m.yy - d, m.yz, m.zz - d};
}

Sym3 scaled(const Sym3& m, double f) {
  return {f * m.xx, f * m.xy, f * m.xz, f * m.yy, f * m.yz, f * m.zz};
}

struct Eigenpair {
  double value;
  DVec3 vector;  // unit
};

// The largest eigenvalue of a matrix that has no other positive one. Newton's method comes down upon the largest root
// of the characteristic polynomial from the bound that mean and variance of the eigenvalues give, which is nearly exact
// where a surface is nearly flat; the vector is a column of the adjugate. Where another eigenvalue is near, both are
// near 0, and so is what an inexact vector does to value * vector * vector'. Nothing if the vector is not good enough,
// which takes an eigenvalue that is nearly 0 beside a large one.
std::optional<Eigenpair> lonePositive(const Sym3& m) {
  const double c2 = m.trace(), c0 = m.determinant();
  const double c1 = m.xx * m.yy - m.xy * m.xy + m.xx * m.zz - m.xz * m.xz + m.yy * m.zz - m.yz * m.yz;
  const double norm = std::sqrt(std::max(0.0, c2 * c2 - 2.0 * c1));  // of Frobenius
  double x = (c2 + 2.0 * std::sqrt(std::max(0.0, c2 * c2 - 3.0 * c1))) / 3.0;
  for (int i = 0; i < 40; ++i) {
    const double step = (((x - c2) * x + c1) * x - c0) / ((3.0 * x - 2.0 * c2) * x + c1);
    x -= step;
    // Convergence is quadratic. Three steps nearly always suffice; asking earlier only makes branches hard to predict.
    if (i >= 2 && !(step > 1e-8 * norm)) break;
  }
  const DVec3 r0(m.xx - x, m.xy, m.xz), r1(m.xy, m.yy - x, m.yz), r2(m.xz, m.yz, m.zz - x);
  DVec3 vector(0.0);
  for (const DVec3& v : {glm::cross(r0, r1), glm::cross(r1, r2), glm::cross(r2, r0)})
    if (glm::dot(v, v) > glm::dot(vector, vector)) vector = v;
  vector *= 1.0 / glm::length(vector);
  const DVec3 image = m.times(vector);
  const double value = glm::dot(vector, image);
  const DVec3 residual = image - value * vector;
  if (!(glm::dot(residual, residual) <= 1e-24 * norm * norm)) return std::nullopt;
  return Eigenpair{value, vector};
}

// eps^2 times the inverse of the smallest matrix that is above both `a` and `floor` I, where neither is above the
// other.
Sym3 partlyLimitedReach(const Sym3& a, double eps, double floor, double r_max2) {
  // a - floor I has eigenvalues of both signs. Its determinant tells which sign only one of them has.
  const Sym3 above = lessOnDiagonal(a, floor);
  const bool one_is_positive = above.determinant() > 0.0;
  const std::optional<Eigenpair> lone = lonePositive(one_is_positive ? above : scaled(above, -1.0));
  if (!lone) {
    Eigen3 e = eigenDecomposition(a);
    for (int k = 0; k < 3; ++k) e.values[k] = std::min(eps * eps / e.values[k], r_max2);
    return compose(e);
  }
  if (one_is_positive) {  // a sphere, flattened along the vector
    Sym3 reach = Sym3::scaledIdentity(r_max2);
    reach.addOuter(lone->vector, eps * eps / (floor + lone->value) - r_max2);
    return reach;
  }
  Sym3 bound = a;
  bound.addOuter(lone->vector, lone->value);
  return scaled(inverse(bound), eps * eps);
}

// R with no half-axis above r_max, given as its square. Many vertices need no eigenvectors: either every half-axis is
// limited, which leaves a sphere, or none is.
Sym3 limitedReach(const Sym3& a, double eps, double r_max2) {
  if (!(r_max2 > 0.0) || eps == 0.0) return {};
  const double floor = eps * eps / r_max2;
  const Sym3 above = lessOnDiagonal(a, floor);
  if (a.trace() <= floor || isPositiveDefinite(scaled(above, -1.0))) return Sym3::scaledIdentity(r_max2);
  if (isPositiveDefinite(above)) return scaled(inverse(a), eps * eps);
  return partlyLimitedReach(a, eps, floor, r_max2);
}

std::vector<Sym3> safeEllipsoids(const mesh::Mesh& mesh, double eps) {
  FaceSums sums = sumFaces(mesh);
  addBoundaryPlanes(mesh, kBoundaryWeight, sums.quadric);
  for (std::size_t v = 0; v < sums.quadric.size(); ++v)
    sums.quadric[v] = sums.altitude2[v] == kNoAltitude
                          ? Sym3::scaledIdentity(eps * eps)
                          : limitedReach(sums.quadric[v], eps, kSafeReach * kSafeReach * sums.altitude2[v]);
  return std::move(sums.quadric);
}

// A of every vertex with the degenerate ones replaced by small spheres.
std::vector<Sym3> regularQuadrics(const mesh::Mesh& mesh) {
  const std::vector<Sym3> unweighted = vertexQuadrics(mesh, 1.0);
  std::vector<Sym3> quadrics = vertexQuadrics(mesh, kBoundaryWeight);
  for (std::size_t v = 0; v < quadrics.size(); ++v) {
    const DVec3 lambda = eigenDecomposition(unweighted[v]).values;
    const bool isolated = lambda[0] == 0.0;
    if (isolated)
      quadrics[v] = Sym3::scaledIdentity(1.0);
    else if (lambda[2] <= kDegenerateRatio * lambda[0])
      quadrics[v] = Sym3::scaledIdentity(1.0 / (kDegenerateRadius * kDegenerateRadius));
  }
  return quadrics;
}

// [PG] eq. 7: the factor for A that brings each half-axis within 45 degrees of an edge down to half that edge. "Axis
// length" is read as the half-axis.
double halfEdgeScale(const Eigen3& e, double eps, const DVec3& edge) {
  const double length2 = glm::dot(edge, edge);
  double scale = 1.0;
  for (int k = 0; k < 3; ++k) {
    const double along = glm::dot(e.vectors[k], edge);
    if (along * along < 0.5 * length2 || length2 == 0.0) continue;
    scale = std::max(scale, 4.0 * eps * eps / (e.values[k] * length2));
  }
  return scale;
}

std::vector<Sym3> paperEllipsoids(const mesh::Mesh& mesh, double eps) {
  std::vector<Sym3> quadrics = regularQuadrics(mesh);
  std::vector<Eigen3> eigen(quadrics.size());
  for (std::size_t v = 0; v < quadrics.size(); ++v) eigen[v] = eigenDecomposition(quadrics[v]);
  std::vector<double> scale(quadrics.size(), 1.0);
  for (const mesh::Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      const DVec3 edge = DVec3(mesh.positions[b]) - DVec3(mesh.positions[a]);
      scale[a] = std::max(scale[a], halfEdgeScale(eigen[a], eps, edge));
      scale[b] = std::max(scale[b], halfEdgeScale(eigen[b], eps, edge));
    }
  for (std::size_t v = 0; v < quadrics.size(); ++v) {
    for (int k = 0; k < 3; ++k) eigen[v].values[k] = eps * eps / (scale[v] * eigen[v].values[k]);
    quadrics[v] = compose(eigen[v]);
  }
  return quadrics;
}

}  // namespace

double Sym3::determinant() const {
  return xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
}

void Sym3::addOuter(const DVec3& n, double weight) {
  const DVec3 w = weight * n;
  xx += w.x * n.x, xy += w.x * n.y, xz += w.x * n.z;
  yy += w.y * n.y, yz += w.y * n.z, zz += w.z * n.z;
}

Sym3 inverse(const Sym3& m) {
  const double f = 1.0 / m.determinant();
  return {f * (m.yy * m.zz - m.yz * m.yz), f * (m.xz * m.yz - m.xy * m.zz), f * (m.xy * m.yz - m.xz * m.yy),
          f * (m.xx * m.zz - m.xz * m.xz), f * (m.xy * m.xz - m.xx * m.yz), f * (m.xx * m.yy - m.xy * m.xy)};
}

Eigen3 eigenDecomposition(const Sym3& m) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.compute(matrixOf(m));
  return descending(solver);
}

Sym3 compose(const Eigen3& e) {
  Sym3 m;
  for (int k = 0; k < 3; ++k) m.addOuter(e.vectors[k], e.values[k]);
  return m;
}

std::vector<Sym3> vertexQuadrics(const mesh::Mesh& mesh, double boundary_weight) {
  std::vector<Sym3> quadrics = sumFaces(mesh).quadric;
  addBoundaryPlanes(mesh, boundary_weight, quadrics);
  return quadrics;
}

std::vector<Sym3> vertexEllipsoids(const mesh::Mesh& mesh, double eps, Limit limit) {
  assert(eps >= 0.0 && std::isfinite(eps));
  return limit == Limit::kSafe ? safeEllipsoids(mesh, eps) : paperEllipsoids(mesh, eps);
}

double placeOnLine(const Sym3& a, const DVec3& from_vertex, const DVec3& direction) {
  const DVec3 y = a.times(direction);
  const double ly = glm::dot(direction, y);
  const double ll = glm::dot(direction, direction);
  if (ly <= 1e-12 * a.trace() * ll) return -glm::dot(from_vertex, direction) / ll;
  return -glm::dot(from_vertex, y) / ly;
}

}  // namespace sheaf::grouping
