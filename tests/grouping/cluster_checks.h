// tests/grouping/cluster_checks: what a hierarchy of face clusters must be, found the long way round.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "grouping/dual_graph.h"
#include "grouping/face_clusters.h"

namespace sheaf::grouping {

using Faces = std::vector<std::uint32_t>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;

inline std::set<Edge> plainEdges(const mesh::Triangle& t) {
  std::set<Edge> edges;
  for (std::size_t k = 0; k < 3; ++k)
    if (t[k] != t[(k + 1) % 3]) edges.insert(std::minmax(t[k], t[(k + 1) % 3]));
  return edges;
}

// The mesh edges with all their faces.
inline std::map<Edge, Faces> facesOfEdges(const mesh::Mesh& mesh) {
  std::map<Edge, Faces> around;
  for (std::uint32_t f = 0; f < mesh.triangleCount(); ++f)
    if (hasFiniteCorners(mesh, mesh.triangles[f]))
      for (const Edge& e : plainEdges(mesh.triangles[f])) around[e].push_back(f);
  return around;
}

// Length of the edges that a cluster has once; one of more than two faces counts once for each of those inside.
inline double plainPerimeter(const mesh::Mesh& mesh, const std::map<Edge, Faces>& around, const Faces& faces,
                             const ModelFrame& frame) {
  const std::set<std::uint32_t> inside(faces.begin(), faces.end());
  double length = 0.0;
  for (const auto& [edge, users] : around) {
    const auto count = std::ranges::count_if(users, [&](std::uint32_t f) { return inside.contains(f); });
    if (count == 0 || (users.size() == 2 && count == 2)) continue;
    length += double(count) * glm::distance(frame(mesh.positions[edge.first]), frame(mesh.positions[edge.second]));
  }
  return length;
}

struct PlainFigures {
  double fit = 0.0;        // E_fit, by singular values
  double direction = 0.0;  // E_dir, term by term
  double area = 0.0;
  DVec3 area_vector{0.0};
  DVec3 mean{0.0};
  double corners = 0.0;
};

inline PlainFigures plainFigures(const mesh::Mesh& mesh, const Faces& faces, const ModelFrame& frame) {
  PlainFigures figures;
  std::vector<DVec3> corners, vectors;
  for (const std::uint32_t f : faces) {
    const mesh::Triangle& t = mesh.triangles[f];
    if (!hasFiniteCorners(mesh, t)) continue;
    std::array<DVec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) corners.push_back(p[k] = frame(mesh.positions[t[k]]));
    vectors.push_back(0.5 * glm::cross(p[1] - p[0], p[2] - p[0]));
    figures.area_vector += vectors.back();
    figures.area += glm::length(vectors.back());
  }
  if (corners.empty()) return figures;
  figures.corners = double(corners.size());
  for (const DVec3& p : corners) figures.mean += p / figures.corners;
  Eigen::MatrixXd matrix(corners.size(), 3);
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (int k = 0; k < 3; ++k) matrix(Eigen::Index(i), k) = (corners[i] - figures.mean)[k];
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeThinV);
  const double least = svd.singularValues()[2];
  figures.fit = least * least / figures.corners;
  const Eigen::Vector3d column = svd.matrixV().col(2);
  DVec3 n(column.x(), column.y(), column.z());
  if (glm::length(figures.area_vector) >= 1e-9 * figures.area && figures.area > 0.0)
    n = glm::normalize(figures.area_vector);
  if (glm::dot(n, figures.area_vector) < 0.0) n = -n;
  for (const DVec3& v : vectors) {
    const double w = glm::length(v);
    if (w > 0.0) figures.direction += w * std::pow(1.0 - glm::dot(n, v / w), 2.0) / figures.area;
  }
  return figures;
}

// What joining two clusters costs.
// around  facesOfEdges(mesh)
inline double plainCost(const mesh::Mesh& mesh, const std::map<Edge, Faces>& around, const Faces& a, const Faces& b,
                        const ModelFrame& frame, const CostWeights& weights) {
  const auto gamma_of = [&](const Faces& faces) {
    const double rho = plainPerimeter(mesh, around, faces, frame);
    return rho * rho / (4.0 * kPi * plainFigures(mesh, faces, frame).area);
  };
  Faces both = a;
  both.insert(both.end(), b.begin(), b.end());
  const PlainFigures figures = plainFigures(mesh, both, frame);
  const double gamma = gamma_of(both), before = std::max(gamma_of(a), gamma_of(b));
  const double shape = 4.0 * kPi * gamma < 1e-12 ? 0.0 : std::clamp((gamma - before) / gamma, -1.0, 1.0);
  int exponent = 0;
  const double mantissa = 2.0 * std::frexp(figures.corners, &exponent);  // in [1, 2)
  return weights.fit * figures.fit + weights.direction * figures.direction + weights.shape * shape +
         weights.balance * (exponent - 1 + mantissa - 1.0);
}

inline Faces listOf(std::span<const std::uint32_t> faces) {
  Faces sorted(faces.begin(), faces.end());
  std::ranges::sort(sorted);
  return sorted;
}

// The hierarchy as the set of its clusters.
inline std::set<Faces> clusterSets(const FaceClusters& clusters) {
  std::set<Faces> sets;
  for (std::uint32_t node = 0; node < clusters.nodeCount(); ++node) sets.insert(listOf(clusters.facesOf(node)));
  return sets;
}

}  // namespace sheaf::grouping
