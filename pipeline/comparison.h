// pipeline/comparison: what grouping does to the pictures of a scene. Two questions, never mixed:
//   drawing   is the grouped geometry stage right? Grouped drawing against the snapped mesh drawn ungrouped: the same
//             vertices at the same places, so the same picture
//   quality   what does grouping cost? Grouped drawing against the original mesh drawn ungrouped
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pipeline/prepare.h"
#include "pipeline/renderer.h"
#include "raster/image_compare.h"
#include "raster/silhouette.h"
#include "scenes/scene.h"

namespace sheaf::pipeline {

/// What share of a picture's pixels may differ between grouped drawing and the snapped mesh drawn ungrouped. By planes
/// across an axis none: vertices come out the same to the bit. By lines and by planes of patches a hundredth:
/// V1' + s S' + t T' rounds otherwise than M (V1 + s S + t T), so that pixels whose centres lie on an edge may show the
/// triangle beside it. Usually these are 0.02 % of the pixels at most, as tests demand; the rest is for what is near
/// the eye or far from the origin, where a float is coarse: 0.3 and 0.5 % were seen.
double maxDrawingDifference(Grouping method);

struct PictureDifference {
  raster::ImageDifference pixels;
  raster::SilhouetteShift silhouette;
};

struct ViewComparison {
  scenes::Camera camera;
  PictureDifference drawing;
  PictureDifference quality;
};

/// Of all meshes of the scene, each counted once whatever its instances. Lengths are fractions of each mesh's own
/// extent; means are over the vertices in use, the RMS of normals over triangles.
struct GeometricError {
  std::uint64_t vertices = 0;  ///< in use
  std::uint64_t grouped = 0;
  double displacement_max = 0.0;
  double displacement_mean = 0.0;
  double displacement_rms = 0.0;
  double normal_deviation_max_rad = 0.0;
  double normal_deviation_rms_rad = 0.0;
  std::uint64_t flipped_faces = 0;
  std::uint64_t collapsed_faces = 0;
  double search_ms = 0.0;

  double eliminated() const;  ///< grouped / vertices, 0 without vertices
};

GeometricError geometricError(const PreparedScene& scene);

/// Share of the patches' vertices that are drawn by groups; the others are stored in full, moved or not.
double shareDrawnByGroups(const PreparedScene& scene);

/// Bytes that the geometry stage reads of vertices, for each vertex of each patch; 0 without vertices.
double bytesPerVertex(const PreparedScene& scene);

struct Comparison {
  GroupingOptions grouping;
  std::vector<ViewComparison> views;  ///< at least one
  GeometricError geometry;
  double drawn_by_groups = 0.0;  ///< shareDrawnByGroups()
  double original_bytes_per_vertex = 0.0;
  double grouped_bytes_per_vertex = 0.0;
  std::size_t worst_view = 0;  ///< of greatest RMS error in `quality`, of equal ones the first
  Image8 original;             ///< the pictures of that view
  Image8 grouped;
  Image8 snapped;
  std::vector<std::string> warnings;

  /// In every view `drawing` keeps to maxDrawingDifference().
  bool drawsRight() const;
};

/// cameras   at least one; near and far are set
/// grouping  use_groups does not count
/// settings  size, background, patch culling
/// Scenes without lights are lit from each camera anew (scenes::addDefaultLights). Three prepared copies of the scene
/// are in memory at once. Throws what Renderer::render() throws.
/// progress  as for prepareScene()
Comparison compareGrouping(const scenes::Scene& scene, std::span<const scenes::Camera> cameras,
                           GroupingOptions grouping, RenderSettings settings, TaskPool& pool,
                           const grouping::Progress& progress = {});

inline constexpr int kSideBySideGapPx = 8;

/// The three pictures of the worst view side by side, with gaps between: original, grouped, heat map of their
/// difference (raster::heatMap).
Image8 sideBySide(const Comparison& comparison);

}  // namespace sheaf::pipeline
