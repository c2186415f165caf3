// [GH97] Garland and Heckbert, Surface simplification using quadric error metrics, SIGGRAPH 1997.
// [H99]  see attribute_quadrics.cpp.
#include "mesh/simplify.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <memory>
#include <numeric>
#include <optional>

#include "mesh/attribute_quadrics.h"
#include "mesh/collapse_mesh.h"
#include "mesh/quadric.h"
#include "mesh/weld.h"

namespace sheaf::mesh {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFFU;
// Cosine of the largest angle by which one contraction may turn a triangle.
constexpr double kLeastTurnCos = 0.2;
// When the queue is empty, edges refused earlier may have become possible. Another round is made as long as the last
// one took away this share of the triangles.
constexpr double kWorthwhileRound = 1e-3;

// Positions in a box of unit longest edge around the origin, where the tolerances mean something.
struct Frame {
  DVec3 center{0.0};
  double scale = 1.0;

  static Frame around(const Box3& box) {
    Frame f;
    if (box.empty()) return f;
    f.center = 0.5 * (DVec3(box.lo) + DVec3(box.hi));
    const DVec3 size = DVec3(box.hi) - DVec3(box.lo);
    const double longest = std::max({size.x, size.y, size.z});
    if (longest > 0.0) f.scale = longest;
    return f;
  }
  DVec3 toUnit(const Vec3& p) const { return (DVec3(p) - center) / scale; }
  Vec3 fromUnit(const DVec3& p) const { return Vec3(p * scale + center); }
};

// Triangles with the same corners in the same order but for rotation: all but the first.
std::vector<std::uint32_t> findRepetitions(std::span<const Triangle> triangles) {
  const auto rotated = [&](std::uint32_t f) {
    Triangle t = triangles[f];
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
  };
  // Buckets by least corner keep the sort short.
  std::vector<std::uint32_t> order(triangles.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto least = [&](std::uint32_t f) { return *std::min_element(triangles[f].begin(), triangles[f].end()); };
  std::vector<std::uint32_t> key(triangles.size());
  for (std::uint32_t f = 0; f < key.size(); ++f) key[f] = least(f);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key[a] < key[b]; });
  std::vector<std::uint32_t> repeated;
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && key[order[end]] == key[order[begin]]) ++end;
    std::sort(order.begin() + static_cast<std::ptrdiff_t>(begin), order.begin() + static_cast<std::ptrdiff_t>(end),
              [&](std::uint32_t a, std::uint32_t b) {
                const Triangle s = rotated(a), t = rotated(b);
                return s != t ? s < t : a < b;
              });
    for (std::size_t i = begin + 1; i < end; ++i)
      if (rotated(order[i]) == rotated(order[i - 1])) repeated.push_back(order[i]);
  }
  return repeated;
}

struct Point {
  DVec3 at{0.0};
  Quadric quadric;
  std::uint32_t version = 0;  // grows whenever the point moves: older candidates with it are void
  bool moved = false;
};

// An edge and what contracting it costs. `a` < `b`.
struct Candidate {
  std::uint64_t cost_and_a;  // bits of the cost as float, which ascend like it, then a
  std::uint32_t b;
  std::uint32_t versions;  // sum of both points'

  bool operator<(const Candidate& other) const {  // for std heaps: the least is on top
    return cost_and_a != other.cost_and_a ? cost_and_a > other.cost_and_a : b > other.b;
  }
  std::uint32_t a() const { return static_cast<std::uint32_t>(cost_and_a); }
};

class Simplifier {
 public:
  // wedges, positions  the same triangles, over vertices with all attributes and over distinct positions
  Simplifier(const Mesh& wedges, const Mesh& positions, const SimplifyOptions& options)
      : wedges_(wedges),
        source_(positions),
        options_(options),
        frame_(Frame::around(boundsOf(positions))),
        topology_(positions.triangles, positions.vertexCount()),
        points_(positions.vertexCount()) {
    for (const std::uint32_t f : findRepetitions(source_.triangles)) topology_.remove(f);
    for (std::size_t p = 0; p < points_.size(); ++p) points_[p].at = frame_.toUnit(source_.positions[p]);
    if (options.attributes && (!wedges.normals.empty() || !wedges.texcoords.empty() || !wedges.colors.empty())) {
      std::vector<DVec3> at(points_.size());
      for (std::size_t p = 0; p < at.size(); ++p) at[p] = points_[p].at;
      attributes_.emplace(wedges, source_.triangles, at,
                          AttributeWeights{options.normal_weight, options.texcoord_weight, options.color_weight});
    }
    addFaceQuadrics();
    addBorderQuadrics();
  }

  std::size_t triangleCount() const { return topology_.liveTriangleCount(); }
  std::size_t positionCount() const { return topology_.livePointCount(); }

  SimplifyStop run() {
    while (!targetReached()) {
      const std::size_t before = triangleCount();
      proposeAllEdges();
      while (!queue_.empty() && !targetReached()) contractBest();
      if (targetReached()) break;
      if (static_cast<double>(before - triangleCount()) <= kWorthwhileRound * static_cast<double>(before))
        return SimplifyStop::kTopology;
    }
    return SimplifyStop::kTargetReached;
  }

  Mesh result() const { return attributes_ ? withAttributes() : positionsOnly(); }

 private:
  bool targetReached() const {
    return positionCount() <= options_.target_vertices || triangleCount() <= options_.target_triangles;
  }

  DVec3 at(std::uint32_t p) const { return points_[p].at; }

  // [GH97] §5. Deviation: weighted by area, because unweighted slivers outvote the large triangles beside them.
  void addFaceQuadrics() {
    for (std::uint32_t f = 0; f < topology_.triangles().size(); ++f) {
      if (!topology_.isLive(f)) continue;
      const Triangle& t = topology_.triangles()[f];
      const DVec3 cross = glm::cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0]));
      const double length = glm::length(cross);
      if (!(length > 0.0)) continue;
      const DVec3 n = cross / length;
      const Quadric q = Quadric::ofPlane(n, -glm::dot(n, at(t[0])), 0.5 * length);
      for (const std::uint32_t p : t) points_[p].quadric += q;
    }
  }

  // [GH97] §6: planes through border edges, upright on their triangles. Here also at edges of three or more triangles
  // and along seams, so that those curves stay where they are.
  void addBorderQuadrics() {
    std::vector<std::uint32_t> ends;
    for (std::uint32_t p = 0; p < points_.size(); ++p) {
      ends.clear();
      for (const std::uint32_t n : topology_.neighbours(p))
        if (n > p && (topology_.trianglesOnEdge(n) != 2 || (attributes_ && attributes_->isSeam(topology_, p, n))))
          ends.push_back(n);
      for (const std::uint32_t n : ends)
        topology_.forEachCorner(p, [&](CollapseMesh::Corner c) {
          if (topology_.nextPoint(c) == n || topology_.lastPoint(c) == n) holdEdge(p, n, c / 3);
        });
    }
  }

  void holdEdge(std::uint32_t p, std::uint32_t n, std::uint32_t triangle) {
    const Triangle& t = topology_.triangles()[triangle];
    const DVec3 edge = at(n) - at(p);
    const DVec3 upright = glm::cross(edge, glm::cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0])));
    const double length = glm::length(upright);
    if (!(length > 0.0)) return;
    const DVec3 m = upright / length;
    const Quadric q = Quadric::ofPlane(m, -glm::dot(m, at(p)), options_.border_weight * glm::dot(edge, edge));
    points_[p].quadric += q;
    points_[n].quadric += q;
  }

  Placement placementOf(std::uint32_t a, std::uint32_t b) {
    Quadric q = points_[a].quadric + points_[b].quadric;
    if (attributes_) q += attributes_->mergedError(topology_, a, b);
    return bestPlacement(q, at(a), at(b));
  }

  Candidate candidateOf(std::uint32_t p, std::uint32_t q) {
    const std::uint32_t a = std::min(p, q), b = std::max(p, q);
    const auto cost = static_cast<float>(placementOf(a, b).cost);
    return {std::uint64_t{std::bit_cast<std::uint32_t>(cost)} << 32 | a, b, points_[a].version + points_[b].version};
  }

  void proposeAllEdges() {
    queue_.clear();
    for (std::uint32_t p = 0; p < points_.size(); ++p)
      for (const std::uint32_t n : topology_.neighbours(p))
        if (n > p) queue_.push_back(candidateOf(p, n));
    std::make_heap(queue_.begin(), queue_.end());
  }

  void contractBest() {
    std::pop_heap(queue_.begin(), queue_.end());
    const Candidate best = queue_.back();
    queue_.pop_back();
    const std::uint32_t a = best.a(), b = best.b;
    // Versions only grow: an equal sum means that neither point has changed.
    if (!topology_.isPointLive(a) || !topology_.isPointLive(b)) return;
    if (points_[a].version + points_[b].version != best.versions) return;
    const DVec3 place = placementOf(a, b).at;
    if (!topology_.mayCollapse(a, b) || turnsTriangle(a, b, place) || turnsTriangle(b, a, place)) return;
    if (attributes_) attributes_->collapse(topology_, a, b);
    topology_.collapse(a, b);
    points_[a].at = place;
    points_[a].quadric += points_[b].quadric;
    points_[a].version += points_[b].version + 1;
    points_[a].moved = true;
    for (const std::uint32_t n : topology_.neighbours(a)) {
      queue_.push_back(candidateOf(a, n));
      std::push_heap(queue_.begin(), queue_.end());
    }
  }

  // Would moving p to `place` fold over a triangle that does not vanish with the edge to q?
  bool turnsTriangle(std::uint32_t p, std::uint32_t q, const DVec3& place) {
    bool turns = false;
    topology_.forEachCorner(p, [&](CollapseMesh::Corner c) {
      const std::uint32_t r = topology_.nextPoint(c), s = topology_.lastPoint(c);
      if (turns || r == q || s == q) return;
      const DVec3 edge = at(s) - at(r);
      const DVec3 before = glm::cross(edge, at(p) - at(r)), after = glm::cross(edge, place - at(r));
      const double dot = glm::dot(before, after), before2 = glm::dot(before, before), after2 = glm::dot(after, after);
      // A triangle without area has no side to be turned to.
      turns = before2 > 0.0 && !(dot > 0.0 && dot * dot > kLeastTurnCos * kLeastTurnCos * before2 * after2);
    });
    return turns;
  }

  Vec3 positionOf(std::uint32_t p) const {
    return points_[p].moved ? frame_.fromUnit(points_[p].at) : source_.positions[p];
  }

  Mesh positionsOnly() const {
    Mesh out;
    std::vector<std::uint32_t> number(points_.size(), kNone);
    for (std::uint32_t p = 0; p < points_.size(); ++p) {
      if (!topology_.isPointLive(p)) continue;
      number[p] = static_cast<std::uint32_t>(out.positions.size());
      out.positions.push_back(positionOf(p));
    }
    out.triangles.reserve(triangleCount());
    for (std::uint32_t f = 0; f < topology_.triangles().size(); ++f) {
      if (!topology_.isLive(f)) continue;
      const Triangle& t = topology_.triangles()[f];
      out.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
    }
    return out;
  }

  Mesh withAttributes() const {
    std::vector<std::uint32_t> point_of(wedges_.vertexCount(), kNone), number(wedges_.vertexCount(), kNone);
    for (std::uint32_t f = 0; f < topology_.triangles().size(); ++f)
      for (std::size_t k = 0; topology_.isLive(f) && k < 3; ++k)
        point_of[attributes_->wedgesOf(f)[k]] = topology_.triangles()[f][k];
    Mesh out;
    for (std::uint32_t w = 0; w < point_of.size(); ++w)
      if (point_of[w] != kNone) {
        number[w] = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(positionOf(point_of[w]));
      }
    if (!wedges_.normals.empty()) out.normals.resize(out.vertexCount());
    if (!wedges_.texcoords.empty()) out.texcoords.resize(out.vertexCount());
    if (!wedges_.colors.empty()) out.colors.resize(out.vertexCount());
    for (std::uint32_t w = 0; w < point_of.size(); ++w)
      if (number[w] != kNone) storeAttributes(w, point_of[w], out, number[w]);
    out.triangles.reserve(triangleCount());
    for (std::uint32_t f = 0; f < topology_.triangles().size(); ++f) {
      if (!topology_.isLive(f)) continue;
      const Triangle& t = attributes_->wedgesOf(f);
      out.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
    }
    return out;
  }

  void storeAttributes(std::uint32_t wedge, std::uint32_t point, Mesh& out, std::size_t vertex) const {
    if (points_[point].moved) return attributes_->store(wedge, points_[point].at, out, vertex);
    if (!out.normals.empty()) out.normals[vertex] = wedges_.normals[wedge];
    if (!out.texcoords.empty()) out.texcoords[vertex] = wedges_.texcoords[wedge];
    if (!out.colors.empty()) out.colors[vertex] = wedges_.colors[wedge];
  }

  const Mesh& wedges_;
  const Mesh& source_;
  const SimplifyOptions& options_;
  Frame frame_;
  CollapseMesh topology_;
  std::vector<Point> points_;
  std::optional<AttributeQuadrics> attributes_;
  std::vector<Candidate> queue_;
};

std::size_t dropCollapsed(Mesh& mesh, Mesh& positions) {
  std::size_t kept = 0;
  for (std::size_t f = 0; f < positions.triangleCount(); ++f) {
    const Triangle& t = positions.triangles[f];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    mesh.triangles[kept] = mesh.triangles[f];
    positions.triangles[kept++] = t;
  }
  const std::size_t dropped = positions.triangleCount() - kept;
  mesh.triangles.resize(kept);
  positions.triangles.resize(kept);
  return dropped;
}

}  // namespace

SimplifyResult simplify(const Mesh& mesh, const SimplifyOptions& options) {
  assertValid(mesh);
  assert(options.target_vertices > 0 || options.target_triangles > 0);
  Mesh wedges;
  wedges.positions = mesh.positions;
  wedges.triangles = mesh.triangles;
  if (options.attributes) wedges = mesh;
  SimplifyResult result;
  dropUnusableTriangles(wedges);
  weldVertices(wedges);
  Mesh positions;
  positions.positions = wedges.positions;
  positions.triangles = wedges.triangles;
  if (options.attributes) weldVertices(positions);
  dropCollapsed(wedges, positions);

  Simplifier simplifier(wedges, positions, options);
  result.dropped_triangles = mesh.triangleCount() - simplifier.triangleCount();
  result.stop = simplifier.run();
  result.positions = simplifier.positionCount();
  result.mesh = simplifier.result();
  return result;
}

}  // namespace sheaf::mesh
