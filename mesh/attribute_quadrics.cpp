// [H99] Hoppe, New quadric metric for simplifying meshes with appearance attributes, Visualization 1999.
#include "mesh/attribute_quadrics.h"

#include <algorithm>

namespace sheaf::mesh {
namespace {

constexpr std::size_t kNormalSize = 3, kTexcoordSize = 2, kColorSize = 4;

}  // namespace

AttributeQuadrics::AttributeQuadrics(const Mesh& wedges, std::span<const Triangle> corner_points,
                                     std::span<const DVec3> points, const AttributeWeights& weights)
    : source_(wedges), corner_wedges_(wedges.triangles) {
  if (!wedges.normals.empty()) weight_.insert(weight_.end(), kNormalSize, weights.normal);
  if (!wedges.texcoords.empty()) weight_.insert(weight_.end(), kTexcoordSize, weights.texcoord);
  if (!wedges.colors.empty()) weight_.insert(weight_.end(), kColorSize, weights.color);
  wedges_.resize(wedges.vertexCount());
  linears_.resize(wedges.vertexCount() * weight_.size());
  sums_.resize(weight_.size());
  for (std::size_t f = 0; f < corner_wedges_.size(); ++f) addTriangle(corner_wedges_[f], corner_points[f], points);
  if (!wedges.colors.empty()) {
    color_lo_ = color_hi_ = wedges.colors[0];
    for (const Vec4& c : wedges.colors) {
      color_lo_ = glm::min(color_lo_, c);
      color_hi_ = glm::max(color_hi_, c);
    }
  }
}

double AttributeQuadrics::weightedValue(std::uint32_t wedge, std::size_t attribute) const {
  const double weight = weight_[attribute];
  const auto finite = [weight](float value) { return std::isfinite(value) ? weight * double{value} : 0.0; };
  if (!source_.normals.empty()) {
    if (attribute < kNormalSize) return finite(source_.normals[wedge][static_cast<int>(attribute)]);
    attribute -= kNormalSize;
  }
  if (!source_.texcoords.empty()) {
    if (attribute < kTexcoordSize) return finite(source_.texcoords[wedge][static_cast<int>(attribute)]);
    attribute -= kTexcoordSize;
  }
  return finite(source_.colors[wedge][static_cast<int>(attribute)]);
}

// [H99] §3: gradient g and offset d with g.p + d = s at the three corners and g.n = 0; here by the dual basis of two
// edges.
void AttributeQuadrics::addTriangle(const Triangle& wedges, const Triangle& points, std::span<const DVec3> positions) {
  const DVec3 &p0 = positions[points[0]], e1 = positions[points[1]] - p0, e2 = positions[points[2]] - p0;
  const DVec3 cross = glm::cross(e1, e2);
  const double square = glm::dot(cross, cross), longest2 = std::max(glm::dot(e1, e1), glm::dot(e2, e2));
  // On a sliver the gradient is mostly rounding: it says nothing.
  if (!(square > 1e-10 * longest2 * longest2)) return;
  const double area = 0.5 * std::sqrt(square);
  const DVec3 dual1 = glm::cross(e2, cross) / square, dual2 = glm::cross(cross, e1) / square;
  for (const std::uint32_t w : wedges) wedges_[w].area += area;
  for (std::size_t k = 0; k < weight_.size(); ++k) {
    const double s0 = weightedValue(wedges[0], k);
    const DVec3 g = (weightedValue(wedges[1], k) - s0) * dual1 + (weightedValue(wedges[2], k) - s0) * dual2;
    const double d = s0 - glm::dot(g, p0);
    const Quadric q = Quadric::ofPlane(g, d, area);
    for (const std::uint32_t w : wedges) {
      wedges_[w].square += q;
      Linear& l = linears_[w * weight_.size() + k];
      l.g += area * g;
      l.d += area * d;
    }
  }
}

bool AttributeQuadrics::isSeam(CollapseMesh& topology, std::uint32_t a, std::uint32_t b) {
  std::uint32_t at_a = 0, at_b = 0;
  bool first = true, seam = false;
  topology.forEachCorner(a, [&](CollapseMesh::Corner c) {
    const std::uint32_t k = c % 3;
    std::uint32_t other = CollapseMesh::after(k);
    if (topology.lastPoint(c) == b)
      other = CollapseMesh::after(other);
    else if (topology.nextPoint(c) != b)
      return;
    const Triangle& w = corner_wedges_[c / 3];
    seam = seam || (!first && (w[k] != at_a || w[other] != at_b));
    at_a = w[k];
    at_b = w[other];
    first = false;
  });
  return seam;
}

std::uint32_t& AttributeQuadrics::groupOf(std::uint32_t wedge) {
  for (Group& g : groups_)
    if (g.wedge == wedge) return g.group;
  groups_.push_back({wedge, wedge});
  return groups_.back().group;
}

void AttributeQuadrics::unite(std::uint32_t wedge, std::uint32_t other) {
  const std::uint32_t from = groupOf(other), to = groupOf(wedge);
  for (Group& g : groups_)
    if (g.group == from) g.group = to;
}

// A triangle on the edge has a wedge at each end: they become one. Wedges on no such triangle stay by themselves.
void AttributeQuadrics::groupWedges(CollapseMesh& topology, std::uint32_t a, std::uint32_t b) {
  groups_.clear();
  topology.forEachCorner(a, [&](CollapseMesh::Corner c) {
    const Triangle& w = corner_wedges_[c / 3];
    const std::uint32_t k = c % 3;
    groupOf(w[k]);
    if (topology.nextPoint(c) == b) unite(w[k], w[CollapseMesh::after(k)]);
    if (topology.lastPoint(c) == b) unite(w[k], w[CollapseMesh::after(CollapseMesh::after(k))]);
  });
  topology.forEachCorner(b, [&](CollapseMesh::Corner c) { groupOf(corner_wedges_[c / 3][c % 3]); });
}

// The attributes of a group are free: for a place x the best of attribute k is (G_k.x + D_k) / area, which leaves a
// quadric of x alone ([H99] with the attribute block, which is area * I, eliminated).
Quadric AttributeQuadrics::eliminated(std::uint32_t group) {
  Quadric total;
  double area = 0.0;
  std::fill(sums_.begin(), sums_.end(), Linear{});
  for (const Group& g : groups_) {
    if (g.group != group) continue;
    total += wedges_[g.wedge].square;
    area += wedges_[g.wedge].area;
    for (std::size_t k = 0; k < sums_.size(); ++k) {
      const Linear& l = linears_[g.wedge * sums_.size() + k];
      sums_[k].g += l.g;
      sums_[k].d += l.d;
    }
  }
  if (!(area > 0.0)) return total;
  for (const Linear& l : sums_) total += Quadric::ofPlane(l.g, l.d, -1.0 / area);
  return total;
}

Quadric AttributeQuadrics::mergedError(CollapseMesh& topology, std::uint32_t a, std::uint32_t b) {
  groupWedges(topology, a, b);
  Quadric total;
  for (const Group& g : groups_)
    if (g.wedge == g.group) total += eliminated(g.group);
  return total;
}

void AttributeQuadrics::collapse(CollapseMesh& topology, std::uint32_t a, std::uint32_t b) {
  groupWedges(topology, a, b);
  const std::size_t n = weight_.size();
  for (const Group& g : groups_) {
    if (g.wedge == g.group) continue;
    wedges_[g.group].square += wedges_[g.wedge].square;
    wedges_[g.group].area += wedges_[g.wedge].area;
    for (std::size_t k = 0; k < n; ++k) {
      linears_[g.group * n + k].g += linears_[g.wedge * n + k].g;
      linears_[g.group * n + k].d += linears_[g.wedge * n + k].d;
    }
  }
  const auto relabel = [&](CollapseMesh::Corner c) {
    std::uint32_t& w = corner_wedges_[c / 3][c % 3];
    w = groupOf(w);
  };
  topology.forEachCorner(a, relabel);
  topology.forEachCorner(b, relabel);
}

void AttributeQuadrics::store(std::uint32_t wedge, const DVec3& position, Mesh& mesh, std::size_t out) const {
  const double area = wedges_[wedge].area;
  const Linear* l = &linears_[wedge * weight_.size()];
  std::size_t k = 0;
  // A weight of 0 leaves nothing to read back, a wedge without area nothing to fit: both keep what the source has.
  const auto value = [&](float original) {
    const double weight = weight_[k];
    const double sum = glm::dot(l[k].g, position) + l[k].d;
    ++k;
    return weight > 0.0 && area > 0.0 ? static_cast<float>(sum / (area * weight)) : original;
  };
  if (!mesh.normals.empty()) {
    const Vec3& old = source_.normals[wedge];
    Vec3 normal;
    for (int i = 0; i < 3; ++i) normal[i] = value(old[i]);
    const float length = glm::length(normal);
    mesh.normals[out] = length > 1e-6F ? normal / length : old;
  }
  if (!mesh.texcoords.empty())
    for (int i = 0; i < 2; ++i) mesh.texcoords[out][i] = value(source_.texcoords[wedge][i]);
  if (!mesh.colors.empty()) {
    for (int i = 0; i < 4; ++i) mesh.colors[out][i] = value(source_.colors[wedge][i]);
    mesh.colors[out] = glm::clamp(mesh.colors[out], color_lo_, color_hi_);
  }
}

}  // namespace sheaf::mesh
