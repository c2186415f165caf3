// grouping/open_edges: the edges that exactly one face uses.
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/mesh.h"

namespace sheaf::grouping {

/// Goes from a to b in the face that owns it.
struct OpenEdge {
  std::uint32_t a;
  std::uint32_t b;
  std::uint32_t face;
};

/// In ascending order of (lower vertex, upper vertex). Edges from a vertex to itself do not count.
std::vector<OpenEdge> findOpenEdges(const mesh::Mesh& mesh);

}  // namespace sheaf::grouping
