// pipeline/geometry: the per-frame geometry stage for one patch: transform, clip, set up and bin. What one worker needs
// for it lies in a GeometryWorker.
#pragma once

#include <cstdint>
#include <vector>

#include "core/stage_timer.h"
#include "pipeline/clip.h"
#include "pipeline/counters.h"
#include "pipeline/cull.h"
#include "pipeline/patch_culling.h"
#include "pipeline/prepare.h"
#include "pipeline/transform.h"
#include "raster/bins.h"
#include "raster/setup.h"
#include "raster/tile.h"

namespace sheaf::pipeline {

/// Scratch memory of one worker; all of it stays in its caches.
struct GeometryWorker {
  raster::Binner binner;
  StageClock clock;
  Counters counters;
  std::vector<DrawnPatch> drawn;
  ClipVertices clip;
  ProjectedVertices projected;
  VertexCodes codes;
  std::array<RunCodes, kMaxPatchVertices> run_codes;
  std::array<bool, kMaxPatchVertices> run_untransformed;
  std::array<std::uint32_t, 512> undecided;  ///< triangles that are not known to be outside
  TriangleRun unclipped;
  std::vector<raster::TileEntries> tile_entries;
};

/// Draws one patch into the worker's bins. The clock must run; it is left in some stage.
void drawPatch(const PreparedMesh& mesh, std::uint32_t patch, PatchVisibility seen, const InstanceView& view,
               bool cull_back, std::uint32_t surface, const Viewport& viewport, GeometryWorker& worker);

}  // namespace sheaf::pipeline
