// grouping/cluster_colors: numbers of colours for face clusters, so that neighbours can be told apart in a picture.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "grouping/cluster_cuts.h"

namespace sheaf::grouping {

/// A number in [0, color_count) for each cluster of the cut. Clusters that share an edge of the mesh get different ones
/// unless more than color_count would be needed; six always suffice on a surface without handles, since then some
/// cluster has at most five neighbours (smallest-last colouring [MB83]). Beyond that, colours are used evenly.
/// color_count  at least 1
std::vector<std::uint32_t> colorClusters(const mesh::Mesh& mesh, const FaceClusters& clusters,
                                         std::span<const std::uint32_t> cut, std::uint32_t color_count);

}  // namespace sheaf::grouping
