#include "grouping/patch_groups.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>
#include <vector>

#include "core/stage_timer.h"
#include "grouping/cluster_shapes.h"
#include "grouping/group_assembly.h"
#include "grouping/group_quality.h"
#include "grouping/quadric.h"
#include "mesh/weld.h"

namespace sheaf::grouping {
namespace {

constexpr std::uint32_t kSeveral = kNoIndex - 1;

// The patch that has a vertex, or the vertex at a place; kSeveral once there is a second one.
void claim(std::uint32_t& owner, std::uint32_t by) {
  if (owner == kNoIndex)
    owner = by;
  else if (owner != by)
    owner = kSeveral;
}

// #V, whether a vertex may move: it is inside one patch, and no other vertex in use lies where it does. Those stand at
// seams of attributes: one might be retained and the other go to the grid of a plane.
std::vector<bool> innerVertices(const mesh::Mesh& mesh, const PatchSet& set) {
  std::vector<std::uint32_t> patch_of(mesh.vertexCount(), kNoIndex);
  for (std::uint32_t p = 0; p < set.patches.size(); ++p)
    for (const std::uint32_t v : set.verticesOf(set.patches[p])) claim(patch_of[v], p);
  const std::vector<std::uint32_t> place = mesh::firstAtSamePlace(mesh.positions);
  std::vector<std::uint32_t> vertex_at(mesh.vertexCount(), kNoIndex);
  for (std::uint32_t v = 0; v < patch_of.size(); ++v)
    if (patch_of[v] != kNoIndex) claim(vertex_at[place[v]], v);
  std::vector<bool> inner(mesh.vertexCount(), false);
  for (std::uint32_t v = 0; v < patch_of.size(); ++v) inner[v] = patch_of[v] < kSeveral && vertex_at[place[v]] == v;
  return inner;
}

// How far vertices may move.
struct Reach {
  double eps;                        // by the distance metric, in the unit of the mesh
  std::span<const Sym3> ellipsoids;  // #V by the quadric metric, else empty

  double along(const DVec3& normal, std::uint32_t v) const {
    if (ellipsoids.empty()) return eps;
    return std::sqrt(std::max(0.0, glm::dot(normal, ellipsoids[v].times(normal))));
  }
};

// Finds the planes of one patch.
class PatchSearch {
 public:
  PatchSearch(const mesh::Mesh& mesh, const std::vector<bool>& inner, const Reach& reach, std::uint32_t min_members)
      : mesh_(mesh), inner_(inner), reach_(reach), min_members_(min_members) {}

  // Writes the seeds' numbers within the patch to `owner` of their members.
  std::vector<Findings::Seed> search(std::span<const std::uint32_t> vertices, const ClusterShape& shape,
                                     std::uint32_t patch, std::vector<std::uint32_t>& owner) {
    read(vertices, shape);
    std::vector<Findings::Seed> seeds;
    while (true) {
      const Best best = findBest();
      if (best.members < min_members_) return seeds;
      take(best, static_cast<std::uint32_t>(seeds.size()), owner);
      seeds.push_back({candidates_[best.candidate].vertex, kNoIndex, patch});
      candidates_[best.candidate].is_free = false;
    }
  }

 private:
  struct Candidate {
    std::uint32_t vertex;
    double height;  // above the fitted plane
    double reach;   // how far the vertex may move along the normal; < 0: it may not
    bool is_free;   // neither a member nor on a plane that has been taken
    bool retained;  // not a member
  };
  struct Best {
    std::size_t candidate = 0;
    std::uint32_t members = 0;
  };

  void read(std::span<const std::uint32_t> vertices, const ClusterShape& shape) {
    const DVec3 normal(shape.frame.normal), center(shape.center);
    candidates_.clear();
    for (const std::uint32_t v : vertices) {
      const bool moves = inner_[v];
      candidates_.push_back({v, glm::dot(DVec3(mesh_.positions[v]) - center, normal),
                             moves ? reach_.along(normal, v) : -1.0, moves, true});
    }
  }

  // How many free vertices have a height within their reach: those whose interval has begun less those it has ended
  // for.
  Best findBest() {
    begins_.clear();
    ends_.clear();
    for (const Candidate& c : candidates_) {
      if (!c.is_free) continue;
      begins_.push_back(c.height - c.reach);
      ends_.push_back(c.height + c.reach);
    }
    Best best;
    if (begins_.size() < min_members_) return best;
    std::sort(begins_.begin(), begins_.end());
    std::sort(ends_.begin(), ends_.end());
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      const Candidate& c = candidates_[i];
      if (!c.retained) continue;
      const auto begun = std::upper_bound(begins_.begin(), begins_.end(), c.height) - begins_.begin();
      const auto ended = std::lower_bound(ends_.begin(), ends_.end(), c.height) - ends_.begin();
      const auto members = static_cast<std::uint32_t>(begun - ended) - (c.is_free ? 1U : 0U);
      const bool nearer = members == best.members && std::abs(c.height) < std::abs(candidates_[best.candidate].height);
      if (members > best.members || nearer) best = {i, members};
    }
    return best;
  }

  void take(const Best& best, std::uint32_t seed, std::vector<std::uint32_t>& owner) {
    const double height = candidates_[best.candidate].height;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      Candidate& c = candidates_[i];
      // As they were counted, to the last bit.
      if (i == best.candidate || !c.is_free || !(c.height - c.reach <= height && height <= c.height + c.reach))
        continue;
      owner[c.vertex] = seed;
      c.is_free = c.retained = false;
    }
  }

  const mesh::Mesh& mesh_;
  const std::vector<bool>& inner_;
  Reach reach_;
  std::uint32_t min_members_;
  std::vector<Candidate> candidates_;
  std::vector<double> begins_, ends_;
};

// What is found in each patch by itself.
struct PatchPlanes {
  std::vector<PlaneFrame> frames;
  std::vector<std::vector<Findings::Seed>> seeds;
  std::vector<std::uint32_t> owner;  // #V: of a member, its seed's number within the patch; else kNoIndex
};

PatchPlanes searchPatches(const PatchSearch& one_patch, const mesh::Mesh& mesh, const PatchSet& set, TaskPool& pool) {
  constexpr std::size_t kPatchesPerPiece = 16;
  const std::size_t count = set.patches.size();
  PatchPlanes found{std::vector<PlaneFrame>(count), std::vector<std::vector<Findings::Seed>>(count),
                    std::vector<std::uint32_t>(mesh.vertexCount(), kNoIndex)};
  pool.parallelFor(static_cast<int>((count + kPatchesPerPiece - 1) / kPatchesPerPiece), [&](int piece, int) {
    PatchSearch search = one_patch;
    const std::size_t begin = static_cast<std::size_t>(piece) * kPatchesPerPiece;
    for (std::size_t p = begin; p < std::min(count, begin + kPatchesPerPiece); ++p) {
      const Patch& patch = set.patches[p];
      const ClusterShape shape = shapeOfFaces(mesh, set.trianglesOf(patch));
      found.frames[p] = shape.frame;
      found.seeds[p] = search.search(set.verticesOf(patch), shape, static_cast<std::uint32_t>(p), found.owner);
    }
  });
  return found;
}

// Joins the seeds of all patches, in the order of the patches. A vertex has moved in one patch at most.
Findings joinSeeds(const PatchSet& set, const std::vector<bool>& inner, PatchPlanes found) {
  Findings findings;
  findings.owner = std::move(found.owner);
  for (std::size_t p = 0; p < set.patches.size(); ++p) {
    const auto first = static_cast<std::uint32_t>(findings.seeds.size());
    for (const std::uint32_t v : set.verticesOf(set.patches[p]))
      if (inner[v] && findings.owner[v] != kNoIndex) findings.owner[v] += first;
    findings.seeds.insert(findings.seeds.end(), found.seeds[p].begin(), found.seeds[p].end());
  }
  return findings;
}

}  // namespace

VertexGroups groupInPatches(const mesh::Mesh& mesh, const PatchSet& patches, const PatchGroupOptions& options,
                            TaskPool& pool) {
  assert(options.epsilon >= 0.0 && options.epsilon <= kMaxEpsilon && options.min_members >= 1);
  mesh::assertValid(mesh);
  const std::int64_t start_ns = nowNs();
  const std::vector<std::uint32_t> in_use = verticesInUse(mesh.positions, mesh.triangles);

  VertexGroups out;
  out.kind = GroupKind::kPlane;
  out.epsilon = options.epsilon;
  out.extent = extentOf(mesh.positions, in_use);
  chooseMetric(mesh, options.metric, options.limit, out);
  const double eps = out.epsilon * out.extent;
  const std::vector<Sym3> ellipsoids =
      out.metric == Metric::kQuadric ? vertexEllipsoids(mesh, eps, out.limit) : std::vector<Sym3>{};
  const std::vector<bool> inner = innerVertices(mesh, patches);
  const PatchSearch search(mesh, inner, Reach{eps, ellipsoids}, options.min_members);
  PatchPlanes found = searchPatches(search, mesh, patches, pool);
  out.planes = std::move(found.frames);
  assembleGroups(mesh.positions, in_use, joinSeeds(patches, inner, std::move(found)), Placement(ellipsoids), out);
  finishGroups(mesh, options.restore_flipped, start_ns, out);
  return out;
}

}  // namespace sheaf::grouping
