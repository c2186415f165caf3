// cli/cluster_picture: face clusters to look at.
#pragma once

#include <span>

#include "cli/cluster_options.h"
#include "scenes/scene.h"

namespace sheaf::cli {

/// Draws the mesh to request.output, each cluster in its colour (scenes::paintedParts).
/// scene  that the mesh was made from: its cameras and lights
void drawClusters(const ClusterRequest& request, const scenes::Scene& scene, mesh::Mesh mesh,
                  std::span<const std::uint32_t> cluster_of_face, std::span<const std::uint32_t> cluster_colors,
                  TaskPool& pool);

}  // namespace sheaf::cli
