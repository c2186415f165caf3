// grouping/compression: what vertex groups save in storage ([PG] 7, future work), in bits per vertex in use.
#pragma once

#include <cstdint>
#include <span>

#include "grouping/vertex_groups.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

/// Vertices stand in one order for everything here: that of meshoptimizer's vertex cache and fetch optimisation, which
/// favours its codec and costs neither side anything. All quantised figures have the same grid: `bits` over the extent.
struct CompressionFigures {
  int bits = 0;
  std::uint32_t vertices = 0;
  double plain = 0.0;            ///< positions as floats: 96
  double plain_quantised = 0.0;  ///< 3 * bits
  double coded = 0.0;            ///< quantised positions through meshoptimizer's vertex codec

  double grouped_parameters = 0.0;  ///< bits for each parameter of each grouped vertex
  double grouped_retained =
      0.0;                     ///< retained positions and kept bases, 3 * bits each, records of groups, frames in use
  double grouped_order = 0.0;  ///< which vertices a group has; 0 if the mesh is renumbered by group
  double grouped_coded = 0.0;  ///< parameters and retained positions through the same codec, with the records

  double grouped() const { return grouped_parameters + grouped_retained; }
};

/// mesh  the one that was grouped
/// bits  [1, 16]
CompressionFigures measureCompression(const mesh::Mesh& mesh, const VertexGroups& groups, int bits);

}  // namespace sheaf::grouping
