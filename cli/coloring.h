// cli/coloring: a picture in which colours tell the parts of a surface apart, from the scene to the pixels.
#pragma once

#include "cli/cut_options.h"
#include "cli/saved_groups.h"
#include "cli/scene_options.h"
#include "pipeline/triangle_colors.h"

namespace sheaf::cli {

enum class ColorBy { kCluster, kGroup, kPatch };

/// Made of a scene before it is prepared; then taken along.
class Coloring {
 public:
  /// Face clusters, neighbours in different colours.
  /// scene  that was clustered; loses its own colours
  Coloring(const Clustering& clustering, const pipeline::Overlay& overlay, const pipeline::OverlayView& view,
           scenes::Scene& scene);
  /// Saved groups, also where vertices are drawn in full.
  /// scene  loses its own colours
  Coloring(const GroupsToDraw& groups, const pipeline::Overlay& overlay, scenes::Scene& scene);
  /// Groups that are found on the way, or patches. Throws Error(kUnsupported) as pipeline::surfaceOf() does.
  /// scene  loses its own colours
  Coloring(ColorBy by, const pipeline::Overlay& overlay, scenes::Scene& scene);

  /// Finds the colours, if they were not known, of what was prepared from the scene and adds the overlay to it.
  /// bounds  of the scene; made to hold the overlay too
  void finish(const pipeline::OverlayView& view, pipeline::PreparedScene& prepared, Box3& bounds, TaskPool& pool);

  /// Afterwards.
  /// frame  drawn with want_linear and want_ids
  void apply(pipeline::Frame& frame, TaskPool& pool) const { pipeline::colorPixels(colors_, frame, pool); }

 private:
  ColorBy by_;
  pipeline::Overlay what_;
  pipeline::SceneSurface surface_;  // of what is colored in finish(), until then
  scenes::Scene overlay_;           // of clusters, until finish()
  pipeline::TriangleColors colors_;
};

}  // namespace sheaf::cli
