#include "grouping/patches.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "grouping/normal_cone.h"
#include "grouping/patch_cut.h"
#include "grouping/patch_split.h"

namespace sheaf::grouping {
namespace {

using mesh::Mesh;
using mesh::Triangle;

std::uint32_t alignUp(std::uint32_t count) {
  return (count + kRunAlignment - 1) / kRunAlignment * kRunAlignment;
}

// Writes patches into their runs.
class PatchWriter {
 public:
  explicit PatchWriter(const Mesh& mesh) : mesh_(mesh) {}

  // Counts and firsts of `patch` are set; the runs are filled with padding.
  void write(std::span<const std::uint32_t> triangles, Patch& patch, PatchSet& set) {
    vertices_.clear();
    normals_.clear();
    std::uint32_t slot = patch.first_triangle;
    for (const std::uint32_t triangle : triangles) {
      const Triangle& t = mesh_.triangles[triangle];
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t seen = vertices_.count(), local = vertices_.numberOf(t[k]);
        if (local == seen) {
          set.vertex_source[patch.first_vertex + local] = t[k];
          patch.bounds.extend(mesh_.positions[t[k]]);
        }
        set.corners[k][slot] = static_cast<std::uint8_t>(local);
      }
      set.triangle_source[slot++] = triangle;
      if (const DVec3 n = unitNormalOf(mesh_, t); n != DVec3(0.0)) normals_.push_back(n);
    }
    const auto run = set.vertex_source.begin() + patch.first_vertex;
    std::fill(run + patch.vertex_count, run + alignUp(patch.vertex_count), run[patch.vertex_count - 1]);
    patch.cone = coneOf(normals_);
  }

 private:
  const Mesh& mesh_;
  LocalVertices vertices_;
  std::vector<DVec3> normals_;
};

}  // namespace

DVec3 unitNormalOf(const Mesh& mesh, const Triangle& t) {
  // Nearly exact: differences of floats in double.
  const DVec3 p0(mesh.positions[t[0]]);
  const DVec3 n = glm::cross(DVec3(mesh.positions[t[1]]) - p0, DVec3(mesh.positions[t[2]]) - p0);
  const double square = glm::dot(n, n);
  return square > 0.0 ? n * (1.0 / std::sqrt(square)) : DVec3(0.0);
}

PatchSet writePatches(const Mesh& mesh, const PatchCut& cut, TaskPool& pool) {
  PatchSet set;
  set.patches.resize(cut.runs.size());
  std::uint32_t vertices = 0, triangles = 0;
  for (std::size_t i = 0; i < cut.runs.size(); ++i) {
    Patch& p = set.patches[i];
    p.vertex_count = cut.runs[i].vertex_count;
    p.triangle_count = static_cast<std::uint32_t>(cut.runs[i].size());
    p.first_vertex = vertices;
    p.first_triangle = triangles;
    vertices += alignUp(p.vertex_count);
    triangles += alignUp(p.triangle_count);
  }
  set.vertex_source.resize(vertices);
  set.triangle_source.assign(triangles, kNoIndex);
  for (std::vector<std::uint8_t>& corner : set.corners) corner.assign(triangles, 0);
  std::vector<PatchWriter> writers(static_cast<std::size_t>(pool.threadCount()), PatchWriter(mesh));
  pool.parallelFor(static_cast<int>(cut.runs.size()), [&](int piece, int worker) {
    const auto i = static_cast<std::size_t>(piece);
    const auto run = std::span(cut.triangles).subspan(cut.runs[i].begin, cut.runs[i].size());
    writers[static_cast<std::size_t>(worker)].write(run, set.patches[i], set);
  });
  return set;
}

PatchSet splitIntoPatches(const Mesh& mesh, const PatchLimits& limits, TaskPool& pool) {
  std::vector<std::uint32_t> triangles;
  triangles.reserve(mesh.triangleCount());
  for (std::uint32_t t = 0; t < mesh.triangleCount(); ++t)
    if (!usesVertexTwice(mesh.triangles[t])) triangles.push_back(t);
  return writePatches(mesh, splitByPlace(mesh, std::move(triangles), limits, pool), pool);
}

void renewBounds(const Mesh& mesh, PatchSet& set, TaskPool& pool) {
  pool.parallelFor(static_cast<int>(set.patches.size()), [&](int piece, int) {
    Patch& patch = set.patches[static_cast<std::size_t>(piece)];
    patch.bounds = {};
    for (std::uint32_t i = 0; i < patch.vertex_count; ++i)
      patch.bounds.extend(mesh.positions[set.vertex_source[patch.first_vertex + i]]);
  });
}

}  // namespace sheaf::grouping
