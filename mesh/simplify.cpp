// [GH97] Garland and Heckbert, Surface simplification using quadric error metrics, SIGGRAPH 1997.
// [H99]  see attribute_quadrics.cpp.
#include "mesh/simplify.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <functional>
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
// Triangles at a larger angle than 60 degrees form a sharp edge.
constexpr double kSharpCos = 0.5;
// Least weight of a held edge, in means of the squared lengths of edges.
constexpr double kLeastEdge2 = 2.0;
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
std::vector<std::uint32_t> findRepetitions(std::span<const Triangle> triangles, std::size_t point_count) {
  const auto rotated = [&](std::uint32_t f) {
    Triangle t = triangles[f];
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
  };
  // Sorted by least corner by counting, the rest of the order only within those few.
  std::vector<std::uint32_t> first(point_count + 1, 0), order(triangles.size());
  const auto least = [&](const Triangle& t) { return std::min({t[0], t[1], t[2]}); };
  for (const Triangle& t : triangles) ++first[least(t)];
  std::exclusive_scan(first.begin(), first.end(), first.begin(), 0U);
  for (std::uint32_t f = 0; f < triangles.size(); ++f) order[first[least(triangles[f])]++] = f;
  std::vector<std::uint32_t> repeated;
  std::size_t begin = 0;
  for (std::size_t p = 0; p < point_count; ++p) {
    const std::size_t end = first[p];  // filling moved each start to its end
    const auto at = order.begin();
    std::sort(at + static_cast<std::ptrdiff_t>(begin), at + static_cast<std::ptrdiff_t>(end),
              [&](std::uint32_t a, std::uint32_t b) {
                const Triangle s = rotated(a), t = rotated(b);
                return s != t ? s < t : a < b;
              });
    for (std::size_t i = begin + 1; i < end; ++i)
      if (rotated(order[i]) == rotated(order[i - 1])) repeated.push_back(order[i]);
    begin = end;
  }
  return repeated;
}

struct Point {
  DVec3 at{0.0};
  Quadric quadric;
};

// An edge and what contracting it costs. `a` < `b`.
struct Candidate {
  std::uint64_t cost_and_a;  // bits of the cost as float, which ascend like it, then a
  std::uint32_t b;
  std::uint32_t versions;  // sum of both points'

  bool operator<(const Candidate& other) const {
    return cost_and_a != other.cost_and_a ? cost_and_a < other.cost_and_a : b < other.b;
  }
  bool operator>(const Candidate& other) const { return other < *this; }
  std::uint32_t a() const { return static_cast<std::uint32_t>(cost_and_a); }
};

// Cheapest first. Only the cheap ones are kept in a heap, which so stays in the cache; the others wait unsorted until
// their turn comes, and most are void by then.
class CandidateQueue {
 public:
  void push(const Candidate& c) {
    if (limit_ < c) {
      later_.push_back(c);
    } else {
      heap_.push_back(c);
      std::push_heap(heap_.begin(), heap_.end(), std::greater<>{});
    }
  }

  // Takes the cheapest; is_void tells which candidates need not be kept. False if there is none.
  template <typename IsVoid>
  bool pop(Candidate& cheapest, const IsVoid& is_void) {
    if (heap_.empty()) refill(is_void);
    if (heap_.empty()) return false;
    std::pop_heap(heap_.begin(), heap_.end(), std::greater<>{});
    cheapest = heap_.back();
    heap_.pop_back();
    return true;
  }

 private:
  template <typename IsVoid>
  void refill(const IsVoid& is_void) {
    std::erase_if(later_, is_void);
    const auto share = static_cast<std::ptrdiff_t>(std::min(later_.size(), std::max(kLeastShare, later_.size() / 16)));
    const auto middle = later_.end() - share;
    std::nth_element(later_.begin(), middle, later_.end(), std::greater<>{});
    heap_.assign(middle, later_.end());
    later_.erase(middle, later_.end());
    limit_ = heap_.empty() ? Candidate{0, 0, 0} : *std::max_element(heap_.begin(), heap_.end());
    std::make_heap(heap_.begin(), heap_.end(), std::greater<>{});
  }

  static constexpr std::size_t kLeastShare = 4096;
  std::vector<Candidate> heap_;   // none above limit_
  std::vector<Candidate> later_;  // all above limit_
  Candidate limit_{0, 0, 0};
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
        points_(positions.vertexCount()),
        version_(positions.vertexCount(), 0) {
    for (const std::uint32_t f : findRepetitions(source_.triangles, points_.size())) topology_.remove(f);
    for (std::size_t p = 0; p < points_.size(); ++p) points_[p].at = frame_.toUnit(source_.positions[p]);
    if (options.attributes && (!wedges.normals.empty() || !wedges.texcoords.empty() || !wedges.colors.empty())) {
      std::vector<DVec3> at(points_.size());
      for (std::size_t p = 0; p < at.size(); ++p) at[p] = points_[p].at;
      attributes_.emplace(wedges, source_.triangles, at,
                          AttributeWeights{options.normal_weight, options.texcoord_weight, options.color_weight});
    }
    measureTriangles();
    addFaceQuadrics();
    addEdgeQuadrics();
  }

  std::size_t triangleCount() const { return topology_.liveTriangleCount(); }
  std::size_t positionCount() const { return topology_.livePointCount(); }

  SimplifyStop run() {
    while (!targetReached()) {
      const std::size_t before = triangleCount();
      proposeAllEdges();
      while (!targetReached() && contractBest()) {
      }
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

  // Twice the area long.
  DVec3 normalOf(std::uint32_t f) const {
    const Triangle& t = topology_.triangle(f);
    return glm::cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0]));
  }

  // Means over the triangles, for the weights below.
  void measureTriangles() {
    double area = 0.0, edge2 = 0.0;
    for (std::uint32_t f = 0; f < topology_.triangleCount(); ++f) {
      if (!topology_.isLive(f)) continue;
      area += 0.5 * glm::length(normalOf(f));
      const Triangle& t = topology_.triangle(f);
      for (int k = 0; k < 3; ++k) {
        const DVec3 edge = at(t[(k + 1) % 3]) - at(t[k]);
        edge2 += glm::dot(edge, edge) / 3.0;
      }
    }
    const double count = std::max<double>(1.0, static_cast<double>(triangleCount()));
    mean_area_ = area / count;
    mean_edge2_ = edge2 / count;
  }

  // [GH97] §5. Deviation: weighted by the geometric mean of area and mean area. Unweighted slivers outvote the large
  // triangles beside them; weighted by area, small parts that stick out (claws, ears) go for the sake of large ones.
  void addFaceQuadrics() {
    for (std::uint32_t f = 0; f < topology_.triangleCount(); ++f) {
      if (!topology_.isLive(f)) continue;
      const DVec3 normal = normalOf(f);
      const double length = glm::length(normal);
      if (!(length > 0.0)) continue;
      const DVec3 n = normal / length;
      const Triangle& t = topology_.triangle(f);
      const Quadric q = Quadric::ofPlane(n, -glm::dot(n, at(t[0])), std::sqrt(0.5 * length * mean_area_));
      for (const std::uint32_t p : t) points_[p].quadric += q;
    }
  }

  void addEdgeQuadrics() {
    struct Side {
      std::uint32_t end, triangle;
      auto operator<=>(const Side&) const = default;
    };
    std::vector<Side> sides;
    for (std::uint32_t p = 0; p < points_.size(); ++p) {
      sides.clear();
      topology_.forEachCorner(p, [&](CollapseMesh::Corner c) {
        for (const std::uint32_t n : {topology_.nextPoint(c), topology_.lastPoint(c)})
          if (n > p) sides.push_back({n, c / 3});
      });
      std::sort(sides.begin(), sides.end());
      for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
        while (end < sides.size() && sides[end].end == sides[i].end) ++end;
        const double weight = end - i == 2 ? edgeWeight(p, sides[i].end, sides[i].triangle, sides[i + 1].triangle)
                                           : options_.border_weight;
        if (weight > 0.0)
          for (std::size_t k = i; k < end; ++k) holdEdge(p, sides[k].end, sides[k].triangle, weight);
      }
    }
  }

  // Of the planes at an edge of two triangles. At a sharp edge the planes of the triangles alone are no hold along the
  // bisector of the angle: the rim of a thin sheet would shrink for nearly nothing. Not in [GH97].
  double edgeWeight(std::uint32_t p, std::uint32_t q, std::uint32_t f, std::uint32_t g) {
    if (attributes_ && attributes_->isSeam(topology_, p, q)) return options_.border_weight;
    const DVec3 m = normalOf(f), n = normalOf(g);
    const double scale = std::sqrt(glm::dot(m, m) * glm::dot(n, n));
    if (!(scale > 0.0)) return 0.0;
    return std::max(0.0, (kSharpCos - glm::dot(m, n) / scale) / (1.0 + kSharpCos));
  }

  // [GH97] §6: a plane through the edge, upright on the triangle. Meant for borders; here also for edges of three or
  // more triangles, seams and, lightly, sharp edges, so that those curves stay where they are. Deviation: the squared
  // length counts as kLeastEdge2 means at least, or nothing would keep a thin strip at a border from being drawn in:
  // only the edge at its tip lies across.
  void holdEdge(std::uint32_t p, std::uint32_t q, std::uint32_t triangle, double weight) {
    const DVec3 edge = at(q) - at(p);
    const DVec3 upright = glm::cross(edge, normalOf(triangle));
    const double length = glm::length(upright);
    if (!(length > 0.0)) return;
    const DVec3 m = upright / length;
    const Quadric plane =
        Quadric::ofPlane(m, -glm::dot(m, at(p)), weight * std::max(glm::dot(edge, edge), kLeastEdge2 * mean_edge2_));
    points_[p].quadric += plane;
    points_[q].quadric += plane;
  }

  Placement placementOf(std::uint32_t a, std::uint32_t b) {
    Quadric q = points_[a].quadric + points_[b].quadric;
    if (attributes_) q += attributes_->mergedError(topology_, a, b);
    return bestPlacement(q, at(a), at(b));
  }

  Candidate candidateOf(std::uint32_t p, std::uint32_t q) {
    const std::uint32_t a = std::min(p, q), b = std::max(p, q);
    const auto cost = static_cast<float>(placementOf(a, b).cost);
    return {std::uint64_t{std::bit_cast<std::uint32_t>(cost)} << 32 | a, b, version_[a] + version_[b]};
  }

  void proposeAllEdges() {
    for (std::uint32_t p = 0; p < points_.size(); ++p)
      for (const std::uint32_t n : topology_.neighbours(p))
        if (n > p) queue_.push(candidateOf(p, n));
  }

  // False if the queue is empty.
  bool contractBest() {
    // Versions only grow: an equal sum means that both points are as they were.
    const auto is_void = [&](const Candidate& c) { return version_[c.a()] + version_[c.b] != c.versions; };
    Candidate best;
    if (!queue_.pop(best, is_void)) return false;
    if (!is_void(best)) contract(best.a(), best.b);
    return true;
  }

  void contract(std::uint32_t a, std::uint32_t b) {
    if (!topology_.mayCollapse(a, b)) return;
    const DVec3 place = placementOf(a, b).at;
    if (turnsTriangle(a, b, place) || turnsTriangle(b, a, place)) return;
    if (attributes_) attributes_->collapse(topology_, a, b);
    topology_.collapse(a, b);
    points_[a].at = place;
    points_[a].quadric += points_[b].quadric;
    version_[a] += version_[b] + 1;
    ++version_[b];
    for (const std::uint32_t n : topology_.neighbours(a)) queue_.push(candidateOf(a, n));
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
    return version_[p] != 0 ? frame_.fromUnit(points_[p].at) : source_.positions[p];
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
    for (std::uint32_t f = 0; f < topology_.triangleCount(); ++f) {
      if (!topology_.isLive(f)) continue;
      const Triangle& t = topology_.triangle(f);
      out.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
    }
    return out;
  }

  Mesh withAttributes() const {
    std::vector<std::uint32_t> point_of(wedges_.vertexCount(), kNone), number(wedges_.vertexCount(), kNone);
    for (std::uint32_t f = 0; f < topology_.triangleCount(); ++f)
      for (std::size_t k = 0; topology_.isLive(f) && k < 3; ++k)
        point_of[attributes_->wedgesOf(f)[k]] = topology_.triangle(f)[k];
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
    for (std::uint32_t f = 0; f < topology_.triangleCount(); ++f) {
      if (!topology_.isLive(f)) continue;
      const Triangle& t = attributes_->wedgesOf(f);
      out.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
    }
    return out;
  }

  void storeAttributes(std::uint32_t wedge, std::uint32_t point, Mesh& out, std::size_t vertex) const {
    if (version_[point] != 0) return attributes_->store(wedge, points_[point].at, out, vertex);
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
  std::vector<std::uint32_t> version_;  // per point, grows when it moves or goes: older candidates with it are void
  double mean_area_ = 0.0;              // of a triangle
  double mean_edge2_ = 0.0;             // of squared edge lengths
  std::optional<AttributeQuadrics> attributes_;
  CandidateQueue queue_;
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
