// grouping/cluster_colors: numbers of colours for face clusters and other parts of meshes, so that neighbours can be
// told apart in a picture.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "grouping/cluster_cuts.h"

namespace sheaf::grouping {

/// A number in [0, color_count) for each part. Parts that share an edge of the mesh get different ones unless more than
/// color_count would be needed; six always suffice for connected parts of a surface without handles, since then some
/// part has at most five neighbours (smallest-last colouring [MB83]). Beyond that, colours are used evenly.
/// part_of_face  #F, below part_count, or kNoIndex: in no part
/// color_count   at least 1
std::vector<std::uint32_t> colorParts(const mesh::Mesh& mesh, std::span<const std::uint32_t> part_of_face,
                                      std::uint32_t part_count, std::uint32_t color_count);

/// The same for the clusters of a cut.
std::vector<std::uint32_t> colorClusters(const mesh::Mesh& mesh, const FaceClusters& clusters,
                                         std::span<const std::uint32_t> cut, std::uint32_t color_count);

}  // namespace sheaf::grouping
