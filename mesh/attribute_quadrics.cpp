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
  errors_.resize(points.size());
  for (std::size_t f = 0; f < corner_wedges_.size(); ++f) addTriangle(corner_wedges_[f], corner_points[f], points);
  std::vector<std::uint8_t> counted(wedges_.size(), 0);
  for (std::size_t f = 0; f < corner_wedges_.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t w = corner_wedges_[f][k];
      if (counted[w] != 0) continue;
      counted[w] = 1;
      wedges_[w].error = errorOf(wedges_[w].square, linearsOf(w), wedges_[w].area);
      errors_[corner_points[f][k]] += wedges_[w].error;
    }
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

std::span<AttributeQuadrics::Linear> AttributeQuadrics::linearsOf(std::uint32_t wedge) {
  return std::span(linears_).subspan(wedge * weight_.size(), weight_.size());
}

std::uint32_t AttributeQuadrics::wedgeAt(const CollapseMesh& topology, std::uint32_t triangle,
                                         std::uint32_t point) const {
  const Triangle& points = topology.triangle(triangle);
  const Triangle& wedges = corner_wedges_[triangle];
  return points[0] == point ? wedges[0] : points[1] == point ? wedges[1] : wedges[2];
}

bool AttributeQuadrics::isSeam(CollapseMesh& topology, std::uint32_t a, std::uint32_t b) const {
  std::uint32_t at_a = 0, at_b = 0;
  bool first = true, seam = false;
  topology.forEachTriangleOnEdge(a, b, [&](std::uint32_t f) {
    const std::uint32_t wedge_a = wedgeAt(topology, f, a), wedge_b = wedgeAt(topology, f, b);
    seam = seam || (!first && (wedge_a != at_a || wedge_b != at_b));
    at_a = wedge_a;
    at_b = wedge_b;
    first = false;
  });
  return seam;
}

std::uint32_t AttributeQuadrics::targetOf(std::uint32_t wedge) const {
  for (const Merged& m : merged_)
    if (m.wedge == wedge) return m.into;
  return wedge;
}

// A triangle on the edge has a wedge at each end: they become one. Wedges on no such triangle stay by themselves.
void AttributeQuadrics::findMerged(CollapseMesh& topology, std::uint32_t a, std::uint32_t b) {
  merged_.clear();
  topology.forEachTriangleOnEdge(a, b, [&](std::uint32_t f) {
    const std::uint32_t wedges[2] = {wedgeAt(topology, f, a), wedgeAt(topology, f, b)};
    const std::uint32_t targets[2] = {targetOf(wedges[0]), targetOf(wedges[1])};
    const std::uint32_t into = std::min(targets[0], targets[1]);
    for (const std::uint32_t w : wedges)
      if (std::none_of(merged_.begin(), merged_.end(), [w](const Merged& m) { return m.wedge == w; }))
        merged_.push_back({w, into});
    for (Merged& m : merged_)
      if (m.into == targets[0] || m.into == targets[1]) m.into = into;
  });
}

// The best value of attribute k at x is (G_k.x + D_k) / area, which leaves a quadric of x alone: [H99] with the
// attribute block, which is area * I, eliminated.
Quadric AttributeQuadrics::errorOf(const Quadric& square, std::span<const Linear> linears, double area) const {
  Quadric error = square;
  if (area > 0.0)
    for (const Linear& l : linears) error += Quadric::ofPlane(l.g, l.d, -1.0 / area);
  return error;
}

// Of the wedges that become one, as one.
Quadric AttributeQuadrics::mergedErrorOf(std::uint32_t into) {
  Quadric square;
  double area = 0.0;
  std::fill(sums_.begin(), sums_.end(), Linear{});
  for (const Merged& m : merged_) {
    if (m.into != into) continue;
    square += wedges_[m.wedge].square;
    area += wedges_[m.wedge].area;
    const std::span<const Linear> linears = linearsOf(m.wedge);
    for (std::size_t k = 0; k < sums_.size(); ++k) {
      sums_[k].g += linears[k].g;
      sums_[k].d += linears[k].d;
    }
  }
  return errorOf(square, sums_, area);
}

Quadric AttributeQuadrics::mergedError(CollapseMesh& topology, std::uint32_t a, std::uint32_t b) {
  findMerged(topology, a, b);
  Quadric total = errors_[a] + errors_[b];
  for (const Merged& m : merged_) {
    total -= wedges_[m.wedge].error;
    if (m.wedge == m.into) total += mergedErrorOf(m.into);
  }
  return total;
}

void AttributeQuadrics::collapse(CollapseMesh& topology, std::uint32_t a, std::uint32_t b) {
  errors_[a] = mergedError(topology, a, b);
  for (const Merged& m : merged_) {
    if (m.wedge == m.into) continue;
    wedges_[m.into].square += wedges_[m.wedge].square;
    wedges_[m.into].area += wedges_[m.wedge].area;
    const std::span<Linear> to = linearsOf(m.into);
    const std::span<const Linear> from = linearsOf(m.wedge);
    for (std::size_t k = 0; k < to.size(); ++k) {
      to[k].g += from[k].g;
      to[k].d += from[k].d;
    }
  }
  for (const Merged& m : merged_)
    if (m.wedge == m.into)
      wedges_[m.into].error = errorOf(wedges_[m.into].square, linearsOf(m.into), wedges_[m.into].area);
  const auto relabel = [&](CollapseMesh::Corner c) {
    std::uint32_t& w = corner_wedges_[c / 3][c % 3];
    w = targetOf(w);
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
