// pipeline/overlays: the planes and boxes of face clusters, vertex groups and patches as thin dark bars, drawn into the
// picture of the surface that they belong to.
//   In     what the geometry stage and the queries work with, so that it can be looked at, and the view that it is for
//   Out    geometry like any other: what is behind the surface is hidden by it. Bars are as wide everywhere in the
//          picture, whatever the scene and their distance, and narrower on what is small there
#pragma once

#include <span>

#include "core/task_pool.h"
#include "grouping/face_clusters.h"
#include "mesh/mesh.h"
#include "pipeline/prepare.h"
#include "scenes/scene.h"

namespace sheaf::pipeline {

struct Overlay {
  bool boxes = false;   ///< all edges
  bool planes = false;  ///< a rectangle with a lattice of lines, as large as the box
  bool any() const { return boxes || planes; }
};

/// The picture that the bars are for.
struct OverlayView {
  scenes::Camera camera;  ///< near is set: what is nearer to the eye is left out
  int height_px = 720;
};

/// Of each cluster, by its shape: the oriented box, and the plane that fits it.
/// mesh              that the clusters were made of
/// world_from_mesh  a rigid motion
scenes::Scene clusterOverlay(const mesh::Mesh& mesh, const grouping::FaceClusters& clusters,
                             std::span<const std::uint32_t> cut, const Overlay& what, const OverlayView& view,
                             const DMat4& world_from_mesh = DMat4(1.0));

/// The box of each patch of each instance.
scenes::Scene patchBoxes(const PreparedScene& scene, const OverlayView& view);

/// Of each instance the part of its plane that a run of vertices spans, of its line likewise.
scenes::Scene groupPlanes(const PreparedScene& scene, const OverlayView& view);

/// Adds instances behind those of the scene. Lights and the like of the overlay do not count.
void addOverlay(scenes::Scene overlay, PreparedScene& scene, TaskPool& pool);

}  // namespace sheaf::pipeline
