// grouping/optimal_groups: how far from the best is greedy planar grouping? For small meshes.
//   Method the retained vertices of a planar grouping (distance metric) are a dominating set of the graph that joins
//          vertices within epsilon along some plane direction, and each dominating set gives a grouping. A weighted
//          local search finds small sets, branch and bound proves (or improves) them. [PG] 6 tried branch and bound and
//          found "little or no benefit".
//   Cost   exponential at worst, held by max_nodes; n^2 / 8 bytes
#pragma once

#include <cstdint>

#include "grouping/planar_groups.h"

namespace sheaf::grouping {

inline constexpr std::uint32_t kMaxOptimalVertices = 8192;

struct OptimalOptions {
  double epsilon = 0.005;                         ///< as in PlanarOptions
  std::vector<PlaneFrame> planes = axisPlanes();  ///< the same
  std::uint64_t search_steps = 200000;            ///< of the local search
  std::uint64_t max_nodes = 200000;               ///< of branch and bound
  Progress progress;                              ///< may be empty
};

/// Counts of retained vertices, so that smaller is better.
struct OptimalGroups {
  VertexGroups groups;         ///< of the best set found
  std::uint32_t greedy = 0;    ///< the table sorted once (TableKey::kUnion)
  std::uint32_t dynamic = 0;   ///< TableKey::kDynamic
  std::uint32_t best = 0;      ///< the best found
  std::uint32_t at_least = 0;  ///< no grouping retains fewer
  std::uint64_t nodes = 0;     ///< visited by branch and bound
  bool isOptimal() const { return best == at_least; }
};

/// Deterministic. Throws Error(kBadInput) as groupPlanar() does, and Error(kUnsupported) for more than
/// kMaxOptimalVertices vertices in use.
OptimalGroups groupOptimally(const mesh::Mesh& mesh, const OptimalOptions& options);

}  // namespace sheaf::grouping
