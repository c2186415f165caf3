#include "grouping/dual_graph.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>
#include <utility>

namespace sheaf::grouping {
namespace {

using mesh::Mesh;
using mesh::Triangle;

constexpr std::size_t kMostAroundEdge = 8;

// One side of a mesh edge, filed under its lower vertex.
struct HalfEdge {
  std::uint32_t other;    // the higher vertex
  std::uint32_t face_up;  // twice the face, plus 1 if it runs from the lower vertex to the higher one

  std::uint32_t face() const { return face_up >> 1U; }
  bool operator<(const HalfEdge& h) const { return other != h.other ? other < h.other : face_up < h.face_up; }
};

// Half-edges in runs by lower vertex; within a run by the higher one, so that those of a mesh edge lie side by side.
struct EdgeTable {
  std::vector<HalfEdge> half_edges;
  std::vector<std::uint32_t> end;  // #V, of each vertex's run

  std::span<HalfEdge> runOf(std::size_t v) {
    const std::size_t begin = v == 0 ? 0 : end[v - 1];
    return std::span(half_edges).subspan(begin, end[v] - begin);
  }
};

EdgeTable collectEdges(const Mesh& mesh) {
  EdgeTable table;
  table.end.assign(mesh.vertexCount() + 1, 0);
  // Saves to fetch the corners of every face twice.
  const bool all_finite = std::ranges::all_of(mesh.positions, [](const Vec3& p) { return isFinite(p); });
  const auto for_each_edge = [&](const auto& body) {
    for (std::size_t f = 0; f < mesh.triangleCount(); ++f) {
      const Triangle& t = mesh.triangles[f];
      if (!all_finite && !hasFiniteCorners(mesh, t)) continue;
      const TriangleEdges e = edgesOf(t);
      for (int i = 0; i < e.count; ++i) body(static_cast<std::uint32_t>(f), e.edges[static_cast<std::size_t>(i)]);
    }
  };
  for_each_edge([&](std::uint32_t, const auto& e) { ++table.end[std::min(e[0], e[1]) + 1U]; });
  for (std::size_t v = 1; v < table.end.size(); ++v) table.end[v] += table.end[v - 1];
  table.half_edges.resize(table.end.back());
  for_each_edge([&](std::uint32_t face, const auto& e) {  // moves each start on to the end of its run
    table.half_edges[table.end[std::min(e[0], e[1])]++] = {std::max(e[0], e[1]), 2 * face + (e[0] < e[1] ? 1U : 0U)};
  });
  for (std::size_t v = 0; v < mesh.vertexCount(); ++v) std::ranges::sort(table.runOf(v), std::less<>{});
  return table;
}

// Calls body(half-edges) for each mesh edge of a run.
template <typename Body>
void forEachMeshEdge(std::span<const HalfEdge> run, const Body& body) {
  for (std::size_t i = 0; i < run.size();) {
    std::size_t end = i + 1;
    while (end < run.size() && run[end].other == run[i].other) ++end;
    body(run.subspan(i, end - i));
    i = end;
  }
}

// Grows with the angle of (x, y), from 0 at +x to 4; no libm, whose last bits differ between machines.
double pseudoAngle(double x, double y) {
  const double sum = std::abs(x) + std::abs(y);
  if (!(sum > 0.0)) return 0.0;
  return y >= 0.0 ? 1.0 - x / sum : 3.0 + x / sum;
}

class GraphBuilder {
 public:
  GraphBuilder(const Mesh& mesh, const ModelFrame& frame, DualGraph& graph)
      : mesh_(mesh), frame_(frame), graph_(graph) {}

  void link(std::uint32_t low, std::span<const HalfEdge> edge) {
    if (edge.size() == 1) return;
    if (edge.size() == 2) {
      const double length = glm::length(frame_(mesh_.positions[low]) - frame_(mesh_.positions[edge[0].other]));
      const std::uint32_t id = linkPair(edge[0].face(), edge[1].face(), length);
      if (((edge[0].face_up ^ edge[1].face_up) & 1U) == 0) graph_.opposed.push_back(id);
    } else if (edge.size() <= kMostAroundEdge) {
      linkAround(low, edge);
    } else {
      for (std::size_t i = 0; i + 1 < edge.size(); ++i) linkPair(edge[i].face(), edge[i + 1].face(), 0.0);
    }
  }

 private:
  // Every mesh edge of a face gives it at most two links, so that its list is short.
  std::uint32_t linkPair(std::uint32_t f, std::uint32_t g, double length) {
    for (std::uint32_t id = graph_.first[f]; id != kNoIndex;) {
      DualEdge& e = graph_.edges[id];
      const int side = e.sideOf(f);
      if (e.face[1 - side] == g) {
        e.length += length;
        return id;
      }
      id = e.next[side];
    }
    const auto id = static_cast<std::uint32_t>(graph_.edges.size());
    graph_.edges.push_back({{f, g}, {graph_.first[f], graph_.first[g]}, length, 0.0F, false});
    graph_.first[f] = graph_.first[g] = id;
    return id;
  }

  void linkAround(std::uint32_t low, std::span<const HalfEdge> edge) {
    const DVec3 p = frame_(mesh_.positions[low]);
    const DVec3 axis = frame_(mesh_.positions[edge[0].other]) - p;
    DVec3 x(0.0), y(0.0);
    spokes_.clear();
    for (const HalfEdge& half_edge : edge) {
      const Triangle& t = mesh_.triangles[half_edge.face()];
      DVec3 across(0.0);  // from the edge to the third corner
      for (const std::uint32_t v : t)
        if (v != low && v != edge[0].other) across = frame_(mesh_.positions[v]) - p;
      if (const double square = glm::dot(axis, axis); square > 0.0) across -= axis * (glm::dot(axis, across) / square);
      if (x == DVec3(0.0)) {
        x = across;
        y = glm::cross(axis, across);
        if (const double length = glm::length(axis); length > 0.0) y /= length;
      }
      spokes_.push_back({pseudoAngle(glm::dot(x, across), glm::dot(y, across)), half_edge.face()});
    }
    std::ranges::sort(spokes_, [](const Spoke& a, const Spoke& b) {
      return a.angle != b.angle ? a.angle < b.angle : a.face < b.face;
    });
    for (std::size_t i = 0; i < spokes_.size(); ++i)
      linkPair(spokes_[i].face, spokes_[(i + 1) % spokes_.size()].face, 0.0);
  }

  struct Spoke {
    double angle;
    std::uint32_t face;
  };

  const Mesh& mesh_;
  const ModelFrame& frame_;
  DualGraph& graph_;
  std::vector<Spoke> spokes_;
};

// Spreads orientation over one piece; `turned` says of each of its faces whether it is to be turned over.
class Orienter {
 public:
  explicit Orienter(const DualGraph& graph)
      : graph_(graph), opposed_(graph.edges.size(), false), seen_(graph.first.size(), false) {
    for (const std::uint32_t id : graph.opposed) opposed_[id] = true;
  }

  void orientPiece(std::uint32_t start, std::vector<bool>& turned) {
    if (seen_[start]) return;
    seen_[start] = true;
    piece_.assign(1, start);
    std::size_t turned_count = 0;
    for (std::size_t i = 0; i < piece_.size(); ++i) {
      const std::uint32_t f = piece_[i];
      turned_count += turned[f] ? 1 : 0;
      for (std::uint32_t id = graph_.first[f]; id != kNoIndex;) {
        const DualEdge& e = graph_.edges[id];
        const int side = e.sideOf(f);
        const std::uint32_t g = e.face[1 - side];
        if (e.length > 0.0 && !seen_[g]) {
          seen_[g] = true;
          turned[g] = turned[f] != opposed_[id];
          piece_.push_back(g);
        }
        id = e.next[side];
      }
    }
    if (2 * turned_count > piece_.size())
      for (const std::uint32_t f : piece_) turned[f] = !turned[f];
  }

 private:
  const DualGraph& graph_;
  std::vector<bool> opposed_, seen_;
  std::vector<std::uint32_t> piece_;
};

}  // namespace

bool hasFiniteCorners(const Mesh& mesh, const Triangle& t) {
  return isFinite(mesh.positions[t[0]]) && isFinite(mesh.positions[t[1]]) && isFinite(mesh.positions[t[2]]);
}

TriangleEdges edgesOf(const Triangle& t) {
  TriangleEdges e;
  const auto add = [&](std::uint32_t a, std::uint32_t b) {
    if (a != b) e.edges[static_cast<std::size_t>(e.count++)] = {a, b};
  };
  add(t[0], t[1]);
  if (t[2] != t[0]) add(t[1], t[2]);  // otherwise the first edge again, backwards
  if (t[2] != t[1] && t[0] != t[1]) add(t[2], t[0]);
  return e;
}

ModelFrame modelFrameOf(const Mesh& mesh) {
  // Relative to a corner, so that nothing cancels far from the origin.
  DVec3 origin(0.0), weighted(0.0), plain(0.0);
  double area = 0.0, corners = 0.0;
  for (const Triangle& t : mesh.triangles) {
    if (!hasFiniteCorners(mesh, t)) continue;
    if (corners == 0.0) origin = DVec3(mesh.positions[t[0]]);
    const DVec3 a = DVec3(mesh.positions[t[0]]) - origin, b = DVec3(mesh.positions[t[1]]) - origin,
                c = DVec3(mesh.positions[t[2]]) - origin;
    const double twice_area = glm::length(glm::cross(b - a, c - a));
    weighted += twice_area / 3.0 * (a + b + c);
    area += twice_area;
    plain += a + b + c;
    corners += 3.0;
  }
  ModelFrame frame;
  if (corners == 0.0) return frame;
  frame.center = origin + (area > 0.0 ? weighted / area : plain / corners);
  double farthest2 = 0.0;
  for (const Triangle& t : mesh.triangles) {
    if (!hasFiniteCorners(mesh, t)) continue;
    for (const std::uint32_t v : t) {
      const DVec3 p = DVec3(mesh.positions[v]) - frame.center;
      farthest2 = std::max(farthest2, glm::dot(p, p));
    }
  }
  if (farthest2 > 0.0) frame.scale = 0.5 / std::sqrt(farthest2);
  return frame;
}

void linkEdges(std::size_t cluster_count, DualGraph& graph) {
  graph.first.assign(cluster_count, kNoIndex);
  for (std::uint32_t id = 0; id < graph.edges.size(); ++id) {
    DualEdge& e = graph.edges[id];
    for (std::size_t side = 0; side < 2; ++side) e.next[side] = std::exchange(graph.first[e.face[side]], id);
  }
}

DualGraph buildDualGraph(const Mesh& mesh, const ModelFrame& frame) {
  mesh::assertValid(mesh);
  assert(mesh.triangleCount() < (std::size_t{1} << 30));
  EdgeTable table = collectEdges(mesh);
  std::size_t links = 0;
  for (std::size_t v = 0; v < mesh.vertexCount(); ++v)
    forEachMeshEdge(table.runOf(v),
                    [&](std::span<const HalfEdge> edge) { links += edge.size() <= 2 ? edge.size() - 1 : edge.size(); });
  DualGraph graph;
  graph.edges.reserve(links);
  graph.first.assign(mesh.triangleCount(), kNoIndex);
  GraphBuilder builder(mesh, frame, graph);
  for (std::size_t v = 0; v < mesh.vertexCount(); ++v)
    forEachMeshEdge(table.runOf(v),
                    [&](std::span<const HalfEdge> edge) { builder.link(static_cast<std::uint32_t>(v), edge); });
  return graph;
}

std::vector<bool> findTurnedFaces(const DualGraph& graph) {
  if (graph.opposed.empty()) return {};
  std::vector<bool> turned(graph.first.size(), false);
  Orienter orienter(graph);
  for (std::uint32_t f = 0; f < graph.first.size(); ++f) orienter.orientPiece(f, turned);
  return turned;
}

}  // namespace sheaf::grouping
