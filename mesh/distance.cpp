#include "mesh/distance.h"

#include <cassert>
#include <numeric>

#include "mesh/triangle_queries.h"

namespace sheaf::mesh {
namespace {

double squaredLength(const DVec3& v) {
  return glm::dot(v, v);
}

bool isUsable(const Mesh& mesh, const Triangle& t) {
  return isFinite(mesh.positions[t[0]]) && isFinite(mesh.positions[t[1]]) && isFinite(mesh.positions[t[2]]);
}

// Boxes over triangles, halved at the median centroid along the longest side.
class SurfaceTree {
 public:
  explicit SurfaceTree(const Mesh& mesh) {
    for (const Triangle& t : mesh.triangles)
      if (isUsable(mesh, t))
        triangles_.push_back({DVec3(mesh.positions[t[0]]), DVec3(mesh.positions[t[1]]), DVec3(mesh.positions[t[2]])});
    if (triangles_.empty()) return;
    nodes_.reserve(2 * triangles_.size() / kLeafSize + 1);
    build(0, static_cast<std::uint32_t>(triangles_.size()));
  }

  bool empty() const { return triangles_.empty(); }

  double squaredDistance(const DVec3& p) const {
    struct Open {
      std::uint32_t node;
      double distance;
    };
    std::array<Open, 64> open;  // the tree is balanced: depth below 32
    std::size_t depth = 0;
    double best = std::numeric_limits<double>::infinity();
    open[depth++] = {0, nodes_[0].squaredDistance(p)};
    while (depth > 0) {
      const Open at = open[--depth];
      if (at.distance >= best) continue;
      const Node& node = nodes_[at.node];
      if (node.count > 0) {
        for (std::uint32_t i = 0; i < node.count; ++i)
          best = std::min(best, squaredLength(closestPoint(triangles_[node.first + i], p) - p));
        continue;
      }
      Open near{at.node + 1, nodes_[at.node + 1].squaredDistance(p)};
      Open far{node.first, nodes_[node.first].squaredDistance(p)};
      if (far.distance < near.distance) std::swap(near, far);
      open[depth++] = far;
      open[depth++] = near;
    }
    return best;
  }

 private:
  static constexpr std::uint32_t kLeafSize = 4;

  struct Node {
    DVec3 lo, hi;
    std::uint32_t first = 0;  // leaf: its first triangle; else the second child (the first one follows its parent)
    std::uint32_t count = 0;  // 0: not a leaf

    double squaredDistance(const DVec3& p) const {
      return squaredLength(glm::max(glm::max(lo - p, p - hi), DVec3(0.0)));
    }
  };

  std::uint32_t build(std::uint32_t begin, std::uint32_t end) {
    const auto self = static_cast<std::uint32_t>(nodes_.size());
    Node node{triangles_[begin][0], triangles_[begin][0], begin, end - begin};
    for (std::uint32_t i = begin; i < end; ++i)
      for (const DVec3& c : triangles_[i]) {
        node.lo = glm::min(node.lo, c);
        node.hi = glm::max(node.hi, c);
      }
    nodes_.push_back(node);
    if (end - begin <= kLeafSize) return self;
    const DVec3 size = node.hi - node.lo;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto sum = [axis](const Corners& t) { return t[0][axis] + t[1][axis] + t[2][axis]; };
    const std::uint32_t middle = begin + (end - begin) / 2;
    const auto at = triangles_.begin();
    std::nth_element(at + begin, at + middle, at + end,
                     [&](const Corners& a, const Corners& b) { return sum(a) < sum(b); });
    build(begin, middle);
    const std::uint32_t second = build(middle, end);
    nodes_[self].first = second;
    nodes_[self].count = 0;
    return self;
  }

  std::vector<Corners> triangles_;
  std::vector<Node> nodes_;
};

// Points spread evenly by area: one in the middle of each of `count` equal slices of the running area, at a place in
// its triangle from the R2 sequence (Roberts 2018), which fills a square evenly.
class SurfaceSamples {
 public:
  SurfaceSamples(const Mesh& mesh, std::size_t count) : mesh_(mesh), count_(count) {
    area_.reserve(mesh.triangleCount());
    double sum = 0.0;
    for (const Triangle& t : mesh.triangles) {
      if (isUsable(mesh, t)) {
        const DVec3 p0(mesh.positions[t[0]]);
        const double area = glm::length(glm::cross(DVec3(mesh.positions[t[1]]) - p0, DVec3(mesh.positions[t[2]]) - p0));
        if (area <= std::numeric_limits<double>::max()) sum += area;
      }
      area_.push_back(sum);
    }
  }

  bool empty() const { return area_.empty() || !(area_.back() > 0.0); }

  DVec3 at(std::size_t i) const {
    const double target = area_.back() * (static_cast<double>(i) + 0.5) / static_cast<double>(count_);
    const auto slice = std::upper_bound(area_.begin(), area_.end(), target) - area_.begin();
    const Triangle& t = mesh_.triangles[std::min(static_cast<std::size_t>(slice), area_.size() - 1)];
    const auto fraction = [](double x) { return x - std::floor(x); };
    double s = fraction(0.5 + 0.7548776662466927 * static_cast<double>(i));
    double r = fraction(0.5 + 0.5698402909980532 * static_cast<double>(i));
    if (s + r > 1.0) s = 1.0 - s, r = 1.0 - r;
    const DVec3 p0(mesh_.positions[t[0]]);
    return p0 + s * (DVec3(mesh_.positions[t[1]]) - p0) + r * (DVec3(mesh_.positions[t[2]]) - p0);
  }

 private:
  const Mesh& mesh_;
  std::size_t count_;
  std::vector<double> area_;  // of the triangles up to each, doubled
};

std::vector<std::uint32_t> usedVertices(const Mesh& mesh) {
  std::vector<std::uint8_t> used(mesh.vertexCount(), 0);
  for (const Triangle& t : mesh.triangles)
    if (isUsable(mesh, t))
      for (const std::uint32_t v : t) used[v] = 1;
  std::vector<std::uint32_t> out;
  for (std::uint32_t v = 0; v < used.size(); ++v)
    if (used[v] != 0) out.push_back(v);
  return out;
}

struct Sums {
  double max2 = 0.0, sum = 0.0, sum2 = 0.0;
};

DistanceStats measure(const Mesh& from, const SurfaceTree& to, std::size_t samples, TaskPool& pool) {
  assert(samples >= 1);
  const SurfaceSamples points(from, samples);
  if (points.empty() || to.empty()) return {};
  const std::vector<std::uint32_t> vertices = usedVertices(from);
  // Pieces of fixed size, added up in order: the sums do not depend on the threads.
  constexpr std::size_t kPiece = 4096;
  const std::size_t pieces = (samples + vertices.size() + kPiece - 1) / kPiece;
  std::vector<Sums> sums(pieces);
  pool.parallelFor(static_cast<int>(pieces), [&](int piece, int) {
    const std::size_t begin = static_cast<std::size_t>(piece) * kPiece;
    Sums& s = sums[static_cast<std::size_t>(piece)];
    for (std::size_t i = begin; i < std::min(begin + kPiece, samples + vertices.size()); ++i) {
      const bool is_sample = i < samples;
      const DVec3 p = is_sample ? points.at(i) : DVec3(from.positions[vertices[i - samples]]);
      const double d2 = to.squaredDistance(p);
      s.max2 = std::max(s.max2, d2);
      s.sum += is_sample ? std::sqrt(d2) : 0.0;
      s.sum2 += is_sample ? d2 : 0.0;
    }
  });
  Sums all;
  for (const Sums& s : sums) {
    all.max2 = std::max(all.max2, s.max2);
    all.sum += s.sum;
    all.sum2 += s.sum2;
  }
  const auto n = static_cast<double>(samples);
  return {std::sqrt(all.max2), all.sum / n, std::sqrt(all.sum2 / n), samples};
}

}  // namespace

DistanceStats distanceToSurface(const Mesh& from, const Mesh& to, std::size_t samples, TaskPool& pool) {
  return measure(from, SurfaceTree(to), samples, pool);
}

SurfaceDistance distanceBetween(const Mesh& a, const Mesh& b, std::size_t samples, TaskPool& pool) {
  return {measure(a, SurfaceTree(b), samples, pool), measure(b, SurfaceTree(a), samples, pool)};
}

}  // namespace sheaf::mesh
