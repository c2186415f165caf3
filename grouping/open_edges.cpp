#include "grouping/open_edges.h"

#include <algorithm>

namespace sheaf::grouping {
namespace {

// The edges of the mesh by their lower vertex.
struct EdgeList {
  struct Entry {
    std::uint32_t upper;
    std::uint32_t corner;  // 3 * face + corner, where the edge starts in its face
  };
  std::vector<std::uint32_t> first;  // #V + 1, into entries
  std::vector<Entry> entries;
};

template <class Body>
void forEachEdge(const mesh::Mesh& mesh, const std::vector<bool>& wanted, const Body& body) {
  for (std::uint32_t f = 0; f < mesh.triangleCount(); ++f)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[f][k], b = mesh.triangles[f][(k + 1) % 3];
      if (a != b && wanted[a] && wanted[b]) body(std::min(a, b), std::max(a, b), 3 * f + k);
    }
}

// Marks the vertices at which some neighbour is left more often than entered. Where every edge has two faces that run
// along it in opposite directions the hashed balance is 0, and no edge there can be open: an open edge has a single
// term for this neighbour. (The hash is 64 bits wide: a false 0 would take about 2^64 vertices.) Most meshes are closed
// nearly everywhere, so this one pass saves sorting nearly all edges.
std::vector<bool> unbalancedVertices(const mesh::Mesh& mesh) {
  const auto hash = [](std::uint64_t v) {
    v = (v + 1) * 0x9E3779B97F4A7C15ULL;
    v = (v ^ (v >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    v = (v ^ (v >> 27U)) * 0x94D049BB133111EBULL;
    return v ^ (v >> 31U);
  };
  std::vector<std::uint64_t> balance(mesh.vertexCount(), 0), hashes(mesh.vertexCount());
  for (std::size_t v = 0; v < hashes.size(); ++v) hashes[v] = hash(v);
  for (const mesh::Triangle& t : mesh.triangles) {
    const std::uint64_t h[3] = {hashes[t[0]], hashes[t[1]], hashes[t[2]]};
    for (int k = 0; k < 3; ++k) balance[t[k]] += h[(k + 1) % 3] - h[(k + 2) % 3];
  }
  std::vector<bool> unbalanced(mesh.vertexCount());
  for (std::size_t v = 0; v < balance.size(); ++v) unbalanced[v] = balance[v] != 0;
  return unbalanced;
}

EdgeList listEdges(const mesh::Mesh& mesh, const std::vector<bool>& wanted) {
  EdgeList list;
  list.first.assign(mesh.vertexCount() + 1, 0);
  forEachEdge(mesh, wanted, [&](std::uint32_t lower, std::uint32_t, std::uint32_t) { ++list.first[lower + 1]; });
  for (std::size_t v = 0; v < mesh.vertexCount(); ++v) list.first[v + 1] += list.first[v];
  list.entries.resize(list.first.back());
  std::vector<std::uint32_t> next(list.first.begin(), list.first.end() - 1);
  forEachEdge(mesh, wanted, [&](std::uint32_t lower, std::uint32_t upper, std::uint32_t corner) {
    list.entries[next[lower]++] = {upper, corner};
  });
  return list;
}

}  // namespace

std::vector<OpenEdge> findOpenEdges(const mesh::Mesh& mesh) {
  EdgeList list = listEdges(mesh, unbalancedVertices(mesh));
  std::vector<OpenEdge> open;
  for (std::size_t v = 0; v + 1 < list.first.size(); ++v) {
    const auto begin = list.entries.begin() + list.first[v], end = list.entries.begin() + list.first[v + 1];
    std::sort(begin, end, [](const auto& x, const auto& y) {
      return x.upper != y.upper ? x.upper < y.upper : x.corner < y.corner;
    });
    for (auto run = begin; run != end;) {
      auto next = run + 1;
      while (next != end && next->upper == run->upper) ++next;
      const std::uint32_t face = run->corner / 3, k = run->corner % 3;
      if (next - run == 1) open.push_back({mesh.triangles[face][k], mesh.triangles[face][(k + 1) % 3], face});
      run = next;
    }
  }
  return open;
}

}  // namespace sheaf::grouping
