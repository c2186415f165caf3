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

/// The vertices of one patch.
struct PatchVertices {
  const grouping::VertexRuns* of_mesh = nullptr;
  std::uint32_t patch = 0;
};

/// Scratch memory of one worker; all of it stays in its caches.
struct GeometryWorker {
  raster::Binner binner;
  StageClock clock;
  Counters counters;
  CulledPatches culled;
  PatchVertices next;  ///< asked for while a patch is set up, to be in the caches when their turn comes
  ClipVertices clip;
  ProjectedVertices projected;
  VertexCodes codes;
  std::array<RunCodes, kMaxPatchVertices> run_codes;
  std::array<bool, kMaxPatchVertices> run_untransformed;
  std::array<std::uint32_t, 512> undecided;  ///< triangles that are not known to be outside
  TriangleRun unclipped;
  std::vector<raster::TileEntries> tile_entries;
};

/// Draws one patch of `mesh` into the worker's bins; its triangles' surface is the number of the instance. The clock
/// must run; it is left in some stage.
void drawPatch(const DrawnPatch& drawn, const PreparedMesh& mesh, const InstanceView& view, const Viewport& viewport,
               GeometryWorker& worker);

}  // namespace sheaf::pipeline
