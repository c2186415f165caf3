#include "grouping/cluster_patches.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "grouping/cluster_cuts.h"
#include "grouping/dual_graph.h"
#include "grouping/patch_cut.h"
#include "grouping/patch_split.h"
#include "mesh/weld.h"

namespace sheaf::grouping {
namespace {

using mesh::Mesh;
using mesh::Triangle;

// Clusters within this share of the limits are the pieces that patches are made of. The dragon, the bunny and a terrain
// come out with 370 to 400 triangles a patch; whole clusters in place of pieces, with the small ones joined, give 310
// to 330, because the last ones to be taken do not fit anywhere.
constexpr double kPieceShare = 0.125;
// How much it counts that a piece faces another way than the patch, against the vertices that it brings. 2 makes cones
// hardly narrower and borders longer.
constexpr double kTurnWeight = 0.5;
// How much it counts that a piece has neighbours that are in no patch yet. Without it, pieces between full patches stay
// alone: a fifth more patches.
constexpr double kOpenWeight = 1.0;

// Clusters that patches are made of, in the order of the hierarchy.
struct Pieces {
  std::vector<std::uint32_t> triangles;        // in runs
  std::vector<std::uint32_t> first_triangle;   // #P + 1
  std::vector<std::uint32_t> vertices;         // in runs, each once per piece
  std::vector<std::uint32_t> first_vertex;     // #P + 1
  std::vector<std::uint32_t> neighbours;       // in runs, ascending
  std::vector<std::uint32_t> first_neighbour;  // #P + 1
  std::vector<DVec3> normal;                   // sum of unit normals

  std::size_t size() const { return normal.size(); }
  std::span<const std::uint32_t> trianglesOf(std::uint32_t p) const { return run(triangles, first_triangle, p); }
  std::span<const std::uint32_t> verticesOf(std::uint32_t p) const { return run(vertices, first_vertex, p); }
  std::span<const std::uint32_t> neighboursOf(std::uint32_t p) const { return run(neighbours, first_neighbour, p); }

 private:
  static std::span<const std::uint32_t> run(const std::vector<std::uint32_t>& all,
                                            const std::vector<std::uint32_t>& first, std::uint32_t p) {
    return std::span(all).subspan(first[p], first[p + 1] - first[p]);
  }
};

class PieceMaker {
 public:
  explicit PieceMaker(const Mesh& mesh) : mesh_(mesh) {}

  // Triangles that use a vertex twice are left out; nothing is added if none is left.
  void add(std::span<const std::uint32_t> faces) {
    vertices_.clear();
    DVec3 normal(0.0);
    const std::size_t first = pieces_.triangles.size();
    for (const std::uint32_t f : faces) {
      const Triangle& t = mesh_.triangles[f];
      if (usesVertexTwice(t)) continue;
      pieces_.triangles.push_back(f);
      normal += unitNormalOf(mesh_, t);
      for (const std::uint32_t v : t)
        if (vertices_.numberOf(v) + 1 > pieces_.vertices.size() - first_vertex_) pieces_.vertices.push_back(v);
    }
    if (pieces_.triangles.size() == first) return;
    pieces_.first_triangle.push_back(static_cast<std::uint32_t>(first));
    pieces_.first_vertex.push_back(static_cast<std::uint32_t>(first_vertex_));
    pieces_.normal.push_back(normal);
    first_vertex_ = pieces_.vertices.size();
  }

  Pieces finish() {
    pieces_.first_triangle.push_back(static_cast<std::uint32_t>(pieces_.triangles.size()));
    pieces_.first_vertex.push_back(static_cast<std::uint32_t>(pieces_.vertices.size()));
    return std::move(pieces_);
  }

 private:
  const Mesh& mesh_;
  Pieces pieces_;
  LocalVertices vertices_;
  std::size_t first_vertex_ = 0;
};

// Pieces of `clusters`, without neighbours yet. Parts of the mesh that are too small to be worth a patch go to
// `crumbs`, ascending.
Pieces cutIntoPieces(const Mesh& mesh, const FaceClusters& clusters, const PatchLimits& limits,
                     std::vector<std::uint32_t>& crumbs) {
  const auto share = [](std::uint32_t limit, std::uint32_t least) {
    return std::max(least, static_cast<std::uint32_t>(kPieceShare * limit));
  };
  const std::uint32_t max_faces = share(limits.max_triangles, 1), max_vertices = share(limits.max_vertices, 3);
  PieceMaker maker(mesh);
  VertexCounter vertices(mesh);
  walkDown(clusters, [&](std::uint32_t node) {
    const std::span<const std::uint32_t> faces = clusters.facesOf(node);
    if (clusters.parent[node] == kNoIndex && faces.size() < limits.max_triangles / 4) {
      std::ranges::copy_if(faces, std::back_inserter(crumbs),
                           [&](std::uint32_t f) { return !usesVertexTwice(mesh.triangles[f]); });
      return false;
    }
    if (faces.size() > max_faces || vertices.count(faces, max_vertices) > max_vertices) return true;
    maker.add(faces);
    return false;
  });
  std::ranges::sort(crumbs);
  return maker.finish();
}

// Pairs of faces that share an edge.
using FaceLinks = std::vector<std::array<std::uint32_t, 2>>;

FaceLinks linksOf(const DualGraph& graph) {
  FaceLinks links;
  links.reserve(graph.edges.size());
  for (const DualEdge& e : graph.edges) links.push_back(e.face);
  return links;
}

// Two pieces are neighbours if a face of one is linked to one of the other.
void findNeighbours(std::size_t face_count, const FaceLinks& links, Pieces& pieces) {
  std::vector<std::uint32_t> piece_of_face(face_count, kNoIndex);
  for (std::uint32_t p = 0; p < pieces.size(); ++p)
    for (const std::uint32_t f : pieces.trianglesOf(p)) piece_of_face[f] = p;
  FaceLinks between;  // pieces, with repetition
  for (const auto& [f, g] : links) {
    const std::uint32_t a = piece_of_face[f], b = piece_of_face[g];
    if (a != b && a != kNoIndex && b != kNoIndex) between.push_back({a, b});
  }
  std::vector<std::uint32_t> end(pieces.size() + 1, 0), all(2 * between.size());  // in runs by piece
  for (const auto& [a, b] : between) ++end[a + 1], ++end[b + 1];
  std::partial_sum(end.begin(), end.end(), end.begin());
  for (const auto& [a, b] : between) all[end[a]++] = b, all[end[b]++] = a;  // moves each start on to the run's end
  pieces.first_neighbour.assign(1, 0);
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const auto run = std::span(all).subspan(p == 0 ? 0 : end[p - 1], end[p] - (p == 0 ? 0 : end[p - 1]));
    std::ranges::sort(run);
    std::ranges::unique_copy(run, std::back_inserter(pieces.neighbours));
    pieces.first_neighbour.push_back(static_cast<std::uint32_t>(pieces.neighbours.size()));
  }
}

// Grows one patch after the other, each from the first piece that is left.
class PatchGrower {
 public:
  PatchGrower(const Pieces& pieces, const PatchLimits& limits)
      : pieces_(pieces), limits_(limits), is_taken_(pieces.size(), false) {}

  PatchCut grow() {
    for (std::uint32_t seed = 0; seed < pieces_.size(); ++seed)
      if (!is_taken_[seed]) growFrom(seed);
    return std::move(cut_);
  }

 private:
  void growFrom(std::uint32_t seed) {
    vertices_.clear();
    candidates_.clear();
    normal_ = DVec3(0.0);
    const std::size_t begin = cut_.triangles.size();
    for (std::uint32_t next = seed; next != kNoIndex; next = bestCandidate(cut_.triangles.size() - begin)) take(next);
    cut_.runs.push_back({begin, cut_.triangles.size(), vertices_.count()});
  }

  void take(std::uint32_t p) {
    is_taken_[p] = true;
    const auto triangles = pieces_.trianglesOf(p);
    cut_.triangles.insert(cut_.triangles.end(), triangles.begin(), triangles.end());
    for (const std::uint32_t v : pieces_.verticesOf(p)) vertices_.numberOf(v);
    normal_ += pieces_.normal[p];
    std::erase(candidates_, p);
    for (const std::uint32_t n : pieces_.neighboursOf(p))
      if (!is_taken_[n] && std::ranges::find(candidates_, n) == candidates_.end()) candidates_.push_back(n);
  }

  // The piece that brings the fewest vertices for its triangles, faces the same way and would stay alone if it were not
  // taken; ties go to the lower one. kNoIndex: none fits.
  std::uint32_t bestCandidate(std::size_t triangle_count) {
    std::uint32_t best = kNoIndex;
    double best_price = 0.0;
    for (const std::uint32_t p : candidates_) {
      const std::size_t triangles = pieces_.trianglesOf(p).size();
      std::uint32_t new_vertices = 0;
      for (const std::uint32_t v : pieces_.verticesOf(p)) new_vertices += vertices_.has(v) ? 0 : 1;
      if (triangle_count + triangles > limits_.max_triangles || vertices_.count() + new_vertices > limits_.max_vertices)
        continue;
      const double price = (new_vertices + 1.0) / static_cast<double>(triangles) * (1.0 + kTurnWeight * turnOf(p)) *
                           (1.0 + kOpenWeight * opennessOf(p));
      if (best == kNoIndex || price < best_price || (price == best_price && p < best)) {
        best = p;
        best_price = price;
      }
    }
    return best;
  }

  // 0 where piece and patch face one way, 2 where they face opposite ways.
  double turnOf(std::uint32_t p) const {
    const DVec3& n = pieces_.normal[p];
    const double lengths = std::sqrt(glm::dot(n, n) * glm::dot(normal_, normal_));
    return lengths > 0.0 ? 1.0 - glm::dot(n, normal_) / lengths : 0.0;
  }

  // The share of the piece's neighbours that still are in no patch: one that has few left would stay alone.
  double opennessOf(std::uint32_t p) const {
    const auto neighbours = pieces_.neighboursOf(p);
    const auto open = std::ranges::count_if(neighbours, [&](std::uint32_t n) { return !is_taken_[n]; });
    return static_cast<double>(open) / static_cast<double>(neighbours.size());
  }

  const Pieces& pieces_;
  PatchLimits limits_;
  std::vector<bool> is_taken_;
  PatchCut cut_;
  // Of the patch that grows:
  LocalVertices vertices_;
  std::vector<std::uint32_t> candidates_;
  DVec3 normal_{0.0};
};

void append(const PatchCut& part, PatchCut& cut) {
  const std::size_t before = cut.triangles.size();
  for (const PatchRun& r : part.runs) cut.runs.push_back({before + r.begin, before + r.end, r.vertex_count});
  cut.triangles.insert(cut.triangles.end(), part.triangles.begin(), part.triangles.end());
}

PatchSet growPatches(const Mesh& mesh, const FaceClusters& clusters, const FaceLinks& links, const PatchLimits& limits,
                     TaskPool& pool) {
  std::vector<std::uint32_t> crumbs;
  Pieces pieces = cutIntoPieces(mesh, clusters, limits, crumbs);
  findNeighbours(mesh.triangleCount(), links, pieces);
  PatchCut cut = PatchGrower(pieces, limits).grow();
  pieces = {};
  append(splitByPlace(mesh, std::move(crumbs), limits, pool), cut);
  return writePatches(mesh, cut, pool);
}

}  // namespace

PatchSet clusterPatches(const Mesh& mesh, const Mesh& surface, const FaceClusters& clusters, const PatchLimits& limits,
                        TaskPool& pool) {
  assert(clusters.faceCount() == mesh.triangleCount() && surface.triangleCount() == mesh.triangleCount());
  return growPatches(mesh, clusters, linksOf(buildDualGraph(surface, modelFrameOf(surface))), limits, pool);
}

PatchSet clusterPatches(const Mesh& mesh, const PatchLimits& limits, TaskPool& pool) {
  ClusterOptions options;
  options.min_shape_faces = std::numeric_limits<std::uint32_t>::max();  // patches get bounds of their own
  const Mesh surface = mesh::surfaceOf(mesh);
  const ModelFrame frame = modelFrameOf(surface);
  DualGraph graph = buildDualGraph(surface, frame);
  const FaceLinks links = linksOf(graph);
  return growPatches(mesh, clusterFaces(surface, frame, std::move(graph), options, pool), links, limits, pool);
}

}  // namespace sheaf::grouping
