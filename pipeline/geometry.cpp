#include "pipeline/geometry.h"

#include <cmath>

namespace sheaf::pipeline {
namespace {

Vec4 clipVertex(const ClipVertices& clip, std::uint32_t v) {
  return {clip.x[v], clip.y[v], clip.z[v], clip.w[v]};
}

// Barycentrics over w as linear functions of the pixel, from the homogeneous corners [OG97]: with columns
// (x_i, y_i, w_i) in pixels times w, sum_i u_i (x_i, y_i, w_i) = (X, Y, 1), so u is the inverse applied to (X, Y, 1).
// It holds for corners behind the eye too. False: the triangle is seen edge-on.
bool shadePlanes(const std::array<Vec4, 3>& corners, const Viewport& viewport, int ref_x, int ref_y,
                 raster::ShadeTriangle& shade) {
  DMat3 screen;
  for (int i = 0; i < 3; ++i) {
    const DVec4 c(corners[static_cast<std::size_t>(i)]);
    screen[i] = DVec3((c.x + c.w) * double{viewport.half_width_px}, (c.w - c.y) * double{viewport.half_height_px}, c.w);
  }
  const double det = glm::determinant(screen);
  if (det == 0.0 || !std::isfinite(det)) return false;
  const DMat3 u = glm::inverse(screen);
  for (int i = 0; i < 3; ++i) {
    const double at_ref = u[0][i] * (ref_x + 0.5) + u[1][i] * (ref_y + 0.5) + u[2][i];
    shade.u0[i] = static_cast<float>(at_ref);
    shade.ux[i] = static_cast<float>(u[0][i]);
    shade.uy[i] = static_cast<float>(u[1][i]);
  }
  return true;
}

struct PatchContext {
  const raster::Facing& facing;
  const grouping::Patch& patch;
  const PreparedMesh& mesh;
  std::uint32_t surface;
  const Viewport& viewport;
};

void drawClippedTriangle(const PatchContext& context, std::uint32_t t, GeometryWorker& worker,
                         raster::SetupCounts& counts) {
  const std::size_t slot = context.patch.first_triangle + t;
  std::uint32_t v[3];
  std::array<Vec4, 3> corners;
  std::int32_t planes = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    v[i] = context.mesh.corners[i][slot];
    corners[i] = clipVertex(worker.clip, v[i]);
    planes |= worker.codes[v[i]] & kClipBits;
  }
  const ClippedPolygon polygon = clipTriangle(corners, planes, context.viewport);
  if (polygon.count < 3) return;

  std::array<raster::ScreenCorner, 9> screen;
  for (int i = 0; i < polygon.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const ProjectedVertex p = projectVertex(polygon.corners[k], context.viewport);
    screen[k] = {p.x_fx, p.y_fx, p.depth};
  }

  const int ref_x = screen[0].x_fx >> raster::kSubpixelBits;
  const int ref_y = screen[0].y_fx >> raster::kSubpixelBits;
  const std::uint32_t index = worker.binner.newShadeTriangle();
  raster::ShadeTriangle& shade = worker.binner.shadeTriangle(index);
  if (!shadePlanes(corners, context.viewport, ref_x, ref_y, shade)) return;
  shade.ref_x = static_cast<std::int16_t>(ref_x);
  shade.ref_y = static_cast<std::int16_t>(ref_y);
  for (std::size_t i = 0; i < 3; ++i) shade.vertex[i] = context.patch.first_vertex + v[i];
  shade.surface = context.surface;
  shade.triangle = context.mesh.triangle_source[slot];
  shade.back_face = 0;
  for (std::size_t i = 2; i < static_cast<std::size_t>(polygon.count); ++i) {
    const int sign =
        raster::setupClippedPiece({screen[0], screen[i - 1], screen[i]}, context.facing, index, worker.binner, counts);
    if (sign != 0 && sign != context.facing.front_sign) shade.back_face = 1;
  }
}

}  // namespace

void drawPatch(const PreparedMesh& mesh, const grouping::Patch& patch, const InstanceView& view, bool cull_back,
               bool inside, std::uint32_t surface, const Viewport& viewport, GeometryWorker& worker) {
  const raster::Facing facing{view.mirrored ? 1 : -1, cull_back};
  const std::uint32_t first = patch.first_vertex;
  const std::array<const float*, 3> position = {mesh.position[0].data() + first, mesh.position[1].data() + first,
                                                mesh.position[2].data() + first};
  raster::PatchTriangles triangles;
  for (std::size_t i = 0; i < 3; ++i) triangles.corner[i] = mesh.corners[i].data() + patch.first_triangle;
  triangles.source = mesh.triangle_source.data() + patch.first_triangle;
  triangles.count = patch.triangle_count;
  triangles.first_vertex = first;
  triangles.surface = surface;
  triangles.facing = facing;
  worker.counters.vertices_transformed += patch.vertex_count;
  worker.counters.vertices_full += patch.vertex_count;
  worker.counters.triangles_assembled += patch.triangle_count;

  worker.clock.then(Stage::kTransform);
  transformVertices(position, patch.vertex_count, view.clip_from_object, worker.clip);
  projectVertices(worker.clip, patch.vertex_count, viewport, worker.projected);

  raster::SetupCounts counts;
  if (!inside) {
    worker.clock.then(Stage::kClip);
    worker.counters.vertices_coded += patch.vertex_count;
    const OutcodeSummary summary = outcodeVertices(worker.clip, patch.vertex_count, viewport, worker.codes.data());
    if (summary.any != 0) {
      ClassifiedTriangles& classified = worker.classified;
      classifyTriangles(triangles.corner, triangles.source, triangles.count, worker.codes.data(), classified);
      for (std::uint32_t i = 0; i < classified.clipped_count; ++i)
        drawClippedTriangle({facing, patch, mesh, surface, viewport}, classified.clipped[i], worker, counts);
      worker.counters.triangles_clipped += classified.clipped_count;
      worker.counters.triangles_outside += classified.outside_count;
      for (std::size_t i = 0; i < 3; ++i) triangles.corner[i] = classified.inside.corner[i].data();
      triangles.source = classified.inside.source.data();
      triangles.count = classified.inside.count;
    }
  }

  worker.clock.then(Stage::kSetupBin);
  const ProjectedVertices& p = worker.projected;
  raster::setupTriangles({p.x_fx, p.y_fx, p.depth, p.inv_w}, triangles, worker.binner, counts);
  worker.counters.triangles_back_facing += counts.back_facing;
  worker.counters.triangles_no_sample += counts.no_sample;
  worker.counters.triangles_binned += counts.binned;
}

}  // namespace sheaf::pipeline
