#include "cli/coloring.h"

#include <utility>

#include "grouping/cluster_colors.h"
#include "scenes/painted_parts.h"

namespace sheaf::cli {

Coloring::Coloring(const Clustering& c, const pipeline::Overlay& overlay, const pipeline::OverlayView& view,
                   scenes::Scene& scene)
    : by_(ColorBy::kCluster), what_(overlay) {
  colors_ = pipeline::colorsByPart(grouping::clusterOfFace(c.clusters, c.cut),
                                   grouping::colorClusters(c.surface, c.clusters, c.cut, scenes::kPartColors),
                                   pipeline::faceCountsOf(scene));
  if (overlay.any())
    overlay_ = pipeline::clusterOverlay(c.surface, c.clusters, c.cut, overlay, view, c.world_from_surface);
  pipeline::whitenSurfaces(scene);
}

Coloring::Coloring(const GroupsToDraw& groups, const pipeline::Overlay& overlay, scenes::Scene& scene)
    : by_(ColorBy::kGroup), what_(overlay) {
  const pipeline::SceneSurface surface = pipeline::surfaceOf(scene);
  colors_ = pipeline::colorsByPart(
      groups.group_of_face,
      grouping::colorParts(surface.joined, groups.group_of_face, groups.group_count, scenes::kPartColors),
      surface.face_count);
  pipeline::whitenSurfaces(scene);
}

Coloring::Coloring(ColorBy by, const pipeline::Overlay& overlay, scenes::Scene& scene)
    : by_(by), what_(overlay), surface_(pipeline::surfaceOf(scene)) {
  pipeline::whitenSurfaces(scene);
}

void Coloring::finish(const pipeline::OverlayView& view, pipeline::PreparedScene& prepared, Box3& bounds,
                      TaskPool& pool) {
  const bool of_groups = by_ == ColorBy::kGroup;
  if (colors_.empty())
    colors_ = of_groups ? pipeline::colorsByGroup(prepared, surface_) : pipeline::colorsByPatch(prepared, surface_);
  surface_ = {};
  if (by_ != ColorBy::kCluster && what_.any())
    overlay_ = of_groups ? pipeline::groupPlanes(prepared, view) : pipeline::patchBoxes(prepared, view);
  if (!what_.any()) return;
  bounds.extend(scenes::boundsOf(overlay_));
  pipeline::addOverlay(std::exchange(overlay_, {}), prepared, pool);
}

}  // namespace sheaf::cli
