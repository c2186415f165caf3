#include "pipeline/geometry.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/aligned.h"

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

void prefetch(const auto* begin, std::size_t count) {
  // GCC 12 takes a function that does nothing but this for one without effect and drops its calls, except for:
  asm volatile("");
  const char* const bytes = reinterpret_cast<const char*>(begin);
  for (std::size_t at = 0; at < count * sizeof(*begin); at += kCacheLine) __builtin_prefetch(bytes + at);
}

void prefetchVertices(const PatchVertices& next) {
  if (next.of_mesh == nullptr) return;
  const grouping::VertexRuns& vertices = *next.of_mesh;
  const grouping::PatchRuns& at = vertices.patches[next.patch];
  const bool is_last = next.patch + 1 == vertices.patches.size();
  const std::size_t full_end = is_last ? vertices.full_stride : vertices.patches[next.patch + 1].first_full;
  for (std::size_t k = 0; k < 3; ++k)
    prefetch(vertices.full.data() + k * vertices.full_stride + at.first_full, full_end - at.first_full);
  const auto prefetchParameters = [&](const auto& parameters) {
    if (parameters.empty()) return;
    const std::size_t end = is_last ? parameters.size() : vertices.patches[next.patch + 1].first_parameter;
    prefetch(parameters.data() + at.first_parameter, end - at.first_parameter);
  };
  prefetchParameters(vertices.quantised);
  prefetchParameters(vertices.parameters);
}

// Draws one patch of one instance.
class PatchDrawer {
 public:
  PatchDrawer(const DrawnPatch& drawn, const PreparedMesh& mesh, const InstanceView& view, const Viewport& viewport,
              GeometryWorker& worker)
      : mesh_(mesh),
        patch_(mesh.patches[drawn.patch]),
        stored_(mesh.vertices.patches[drawn.patch]),
        view_(view),
        viewport_(viewport),
        worker_(worker) {
    for (std::size_t i = 0; i < 3; ++i) triangles_.corner[i] = mesh.corners[i].data() + patch_.first_triangle;
    triangles_.source = mesh.triangle_source.data() + patch_.first_triangle;
    triangles_.first_vertex = patch_.first_vertex;
    triangles_.surface = drawn.instance;
    triangles_.facing = {view.mirrored ? 1 : -1, view.culls_back};
    worker.counters.triangles_assembled += patch_.triangle_count;
  }

  // Nothing needs clipping, and nothing is worth rejecting.
  void drawWhole() {
    worker_.clock.then(Stage::kTransform);
    transformWhole();
    prefetchVertices(worker_.next);
    worker_.clock.then(Stage::kSetupBin);
    setUp(0, patch_.triangle_count);
  }

  // may_clip  some vertex may be beyond near, far or the guard band
  void drawAcrossView(bool may_clip) {
    worker_.clock.then(Stage::kClip);
    testRuns(may_clip);
    if (!may_clip && !any_rejected_) return drawWhole();
    worker_.clock.then(Stage::kTransform);
    transformKept();
    prefetchVertices(worker_.next);
    worker_.clock.then(Stage::kClip);
    codeVertices();
    sortTriangles();
    worker_.clock.then(Stage::kSetupBin);
    setUpUnclipped();
  }

  void addCounts() {
    worker_.counters.triangles_back_facing += counts_.back_facing;
    worker_.counters.triangles_no_sample += counts_.no_sample;
    worker_.counters.triangles_binned += counts_.binned;
  }

 private:
  std::span<const grouping::VertexRun> runs() const {
    return std::span(mesh_.vertices.runs).subspan(stored_.first_run, stored_.run_count);
  }
  bool isRejected(std::size_t run) const { return (worker_.run_codes[run].must & kOutsideBits) != 0; }
  bool needsCodes(std::size_t run) const { return (worker_.run_codes[run].may & kClipBits) != 0; }

  void transformWhole() {
    transformPatch(mesh_.vertices, stored_, view_.clip_from_object, viewport_, worker_.projected);
    for (const grouping::VertexRun& run : runs()) countTransformed(run, run.vertex_count);
  }

  void countTransformed(const grouping::VertexRun& run, std::uint32_t count) {
    worker_.counters.vertices_transformed += count;
    (run.kind == grouping::RunKind::kFull ? worker_.counters.vertices_full : worker_.counters.vertices_grouped) +=
        count;
  }

  // A patch of one run has been tested as a whole already.
  void testRuns(bool may_clip) {
    if (stored_.run_count == 1) {
      worker_.run_codes[0] = {0, kOutsideBits | kClipBits};
      return;
    }
    codeAllRuns();
    worker_.counters.groups_tested += stored_.run_count;
    for (std::size_t r = 0; r < stored_.run_count; ++r) {
      // The patch's box has a slack of its own; what it says of clipping holds.
      if (!may_clip) worker_.run_codes[r].may &= ~kClipBits;
      if (isRejected(r))
        ++worker_.counters.groups_outside;
      else if (!needsCodes(r))
        ++worker_.counters.groups_inside;
      any_rejected_ = any_rejected_ || isRejected(r);
    }
  }

  // Vertices in full are in object space, and their run is the first.
  void codeAllRuns() {
    if (stored_.frame == grouping::kNoIndex) return codeRuns(runs(), view_.run_planes, worker_.run_codes.data());
    const std::size_t in_full = runs()[0].kind == grouping::RunKind::kFull ? 1 : 0;
    codeRuns(runs().first(in_full), view_.run_planes, worker_.run_codes.data());
    const RunPlanes planes = runPlanes(clipFromPlanes(mesh_.vertices, stored_, view_.clip_from_object), viewport_);
    codeRuns(runs().subspan(in_full), planes, worker_.run_codes.data() + in_full);
  }

  void transformKept() {
    RunStart start(stored_);
    for (std::size_t r = 0; r < stored_.run_count; ++r) {
      const grouping::VertexRun& run = runs()[r];
      if (!isRejected(r)) transform({run, start, 0, run.vertex_count});
      start.skip(run);
    }
  }

  void transform(const RunPiece& piece) {
    transformRun(mesh_.vertices, stored_, piece, view_.clip_from_object, worker_.clip);
    projectVertices(worker_.clip, piece.firstVertex(), piece.endVertex(), viewport_, worker_.projected);
    countTransformed(piece.run, piece.end - piece.begin);
  }

  // Rejected and accepted runs give their codes to all members; in the others each vertex is coded, after which such a
  // run may prove to be one or the other.
  void codeVertices() {
    std::uint32_t first = 0;
    for (std::size_t r = 0; r < stored_.run_count; ++r) {
      const std::uint32_t last = first + runs()[r].vertex_count;
      const bool untransformed = isRejected(r);
      worker_.run_untransformed[r] = untransformed;
      if (!untransformed && needsCodes(r)) {
        worker_.run_codes[r] = codeExactly(first, last);
      } else {
        std::fill(worker_.codes.must.begin() + first, worker_.codes.must.begin() + last, worker_.run_codes[r].must);
        std::fill(worker_.codes.may.begin() + first, worker_.codes.may.begin() + last,
                  worker_.run_codes[r].may | (untransformed ? kUntransformed : 0));
      }
      first = last;
    }
  }

  RunCodes codeExactly(std::uint32_t first, std::uint32_t last) {
    const OutcodeSummary summary = outcodeVertices(worker_.clip, first, last, viewport_, worker_.codes.must.data());
    std::copy(worker_.codes.must.begin() + first, worker_.codes.must.begin() + last, worker_.codes.may.begin() + first);
    worker_.counters.vertices_coded += last - first;
    return {summary.all, summary.any};
  }

  std::int32_t exactCode(std::uint32_t v) const {
    return worker_.codes.isExact(v) ? worker_.codes.must[v] : outcodeVertex(clipVertex(worker_.clip, v), viewport_);
  }

  std::array<std::uint32_t, 3> cornersOf(std::uint32_t t) const {
    return {triangles_.corner[0][t], triangles_.corner[1][t], triangles_.corner[2][t]};
  }

  // Drops triangles that are outside, clips those that must be, and collects the others in `unclipped`, except for
  // those between the vertices of one accepted run: set-up takes them from where they are.
  void sortTriangles() {
    undecided_count_ = 0;
    std::uint32_t first = 0;
    for (std::size_t r = 0; r < stored_.run_count; ++r) {
      const std::uint32_t count = runs()[r].triangle_count;
      if (isRejected(r))
        worker_.counters.triangles_outside += count;
      else if (needsCodes(r))
        dropOutside(first, first + count);
      first += count;
    }
    dropOutside(first, patch_.triangle_count);
    rebuildNeeded();
    worker_.unclipped.count = 0;
    for (std::uint32_t i = 0; i < undecided_count_; ++i) decide(worker_.undecided[i]);
    worker_.unclipped.finish();
  }

  void dropOutside(std::uint32_t begin, std::uint32_t end) {
    const VertexCodes& codes = worker_.codes;
    for (std::uint32_t t = begin; t < end; ++t) {
      const auto [a, b, c] = cornersOf(t);
      if ((codes.must[a] & codes.must[b] & codes.must[c] & kOutsideBits) != 0) {
        ++worker_.counters.triangles_outside;
      } else {
        worker_.undecided[undecided_count_++] = t;
        any_untransformed_ |= codes.may[a] | codes.may[b] | codes.may[c];
      }
    }
  }

  // Members of rejected runs that a triangle needs after all, in pieces of a vector.
  void rebuildNeeded() {
    if ((any_untransformed_ & kUntransformed) == 0) return;
    std::array<bool, kMaxPatchVertices> needed{};
    for (std::uint32_t i = 0; i < undecided_count_; ++i)
      for (const std::uint32_t v : cornersOf(worker_.undecided[i])) needed[v] = true;
    RunStart start(stored_);
    for (std::size_t r = 0; r < stored_.run_count; ++r) {
      const grouping::VertexRun& run = runs()[r];
      for (std::uint32_t begin = 0; worker_.run_untransformed[r] && begin < run.vertex_count; begin += kRebuiltAtOnce) {
        const RunPiece piece{run, start, begin, std::min<std::uint32_t>(begin + kRebuiltAtOnce, run.vertex_count)};
        const auto end = needed.begin() + piece.endVertex();
        if (std::find(needed.begin() + piece.firstVertex(), end, true) == end) continue;
        transform(piece);
        codeExactly(piece.firstVertex(), piece.endVertex());
      }
      start.skip(run);
    }
  }

  // By exact codes wherever they can matter, so that a triangle takes the same way as without groups.
  void decide(std::uint32_t t) {
    const std::array<std::uint32_t, 3> v = cornersOf(t);
    const VertexCodes& codes = worker_.codes;
    if (((codes.may[v[0]] | codes.may[v[1]] | codes.may[v[2]]) & kClipBits) == 0) {
      worker_.unclipped.add(triangles_.corner, triangles_.source, t);
      return;
    }
    const std::array<std::int32_t, 3> exact = {exactCode(v[0]), exactCode(v[1]), exactCode(v[2])};
    const std::int32_t any = exact[0] | exact[1] | exact[2];
    if ((exact[0] & exact[1] & exact[2] & kOutsideBits) != 0)
      ++worker_.counters.triangles_outside;
    else if ((any & kClipBits) != 0)
      drawClipped(t, v, any & kClipBits);
    else
      worker_.unclipped.add(triangles_.corner, triangles_.source, t);
  }

  void drawClipped(std::uint32_t t, const std::array<std::uint32_t, 3>& v, std::int32_t planes) {
    ++worker_.counters.triangles_clipped;
    std::array<Vec4, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = clipVertex(worker_.clip, v[i]);
    const ClippedPolygon polygon = clipTriangle(corners, planes, viewport_);
    if (polygon.count < 3) return;

    std::array<raster::ScreenCorner, 9> screen;
    for (int i = 0; i < polygon.count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const raster::ScreenVertex p = projectVertex(polygon.corners[k], viewport_);
      screen[k] = {p.x_fx, p.y_fx, p.depth};
    }

    const int ref_x = screen[0].x_fx >> raster::kSubpixelBits;
    const int ref_y = screen[0].y_fx >> raster::kSubpixelBits;
    const std::uint32_t index = worker_.binner.newShadeTriangle();
    raster::ShadeTriangle& shade = worker_.binner.shadeTriangle(index);
    if (!shadePlanes(corners, viewport_, ref_x, ref_y, shade)) return;
    shade.ref_x = static_cast<std::int16_t>(ref_x);
    shade.ref_y = static_cast<std::int16_t>(ref_y);
    for (std::size_t i = 0; i < 3; ++i) shade.vertex[i] = patch_.first_vertex + v[i];
    shade.surface = triangles_.surface;
    shade.triangle = triangles_.source[t];
    shade.back_face = 0;
    for (std::size_t i = 2; i < static_cast<std::size_t>(polygon.count); ++i) {
      const int sign = raster::setupClippedPiece({screen[0], screen[i - 1], screen[i]}, triangles_.facing, index,
                                                 worker_.binner, counts_);
      if (sign != 0 && sign != triangles_.facing.front_sign) shade.back_face = 1;
    }
  }

  // The triangles of accepted runs, as few and long stretches as possible, then those that were picked.
  void setUpUnclipped() {
    std::uint32_t begin = 0, end = 0;
    for (std::size_t r = 0; r < stored_.run_count; ++r) {
      const std::uint32_t count = runs()[r].triangle_count;
      if (isRejected(r) || needsCodes(r)) {
        setUp(begin, end);
        begin = end + count;
      }
      end += count;
    }
    setUp(begin, end);

    raster::PatchTriangles picked = triangles_;
    for (std::size_t i = 0; i < 3; ++i) picked.corner[i] = worker_.unclipped.corner[i].data();
    picked.source = worker_.unclipped.source.data();
    picked.count = worker_.unclipped.count;
    setUp(picked);
  }

  void setUp(std::uint32_t begin, std::uint32_t end) {
    raster::PatchTriangles part = triangles_;
    for (auto& corner : part.corner) corner += begin;
    part.source += begin;
    part.count = end - begin;
    setUp(part);
  }

  void setUp(const raster::PatchTriangles& part) {
    if (part.count == 0) return;
    raster::setupTriangles(worker_.projected.data(), part, worker_.binner, counts_);
  }

  static constexpr std::uint32_t kRebuiltAtOnce = 16;

  const PreparedMesh& mesh_;
  const grouping::Patch& patch_;
  const grouping::PatchRuns& stored_;  // where the patch's vertices are
  const InstanceView& view_;
  const Viewport& viewport_;
  GeometryWorker& worker_;
  raster::PatchTriangles triangles_;
  raster::SetupCounts counts_;
  std::uint32_t undecided_count_ = 0;
  std::int32_t any_untransformed_ = 0;
  bool any_rejected_ = false;
};

}  // namespace

void drawPatch(const DrawnPatch& drawn, const PreparedMesh& mesh, const InstanceView& view, const Viewport& viewport,
               GeometryWorker& worker) {
  PatchDrawer drawer(drawn, mesh, view, viewport, worker);
  const bool tests_runs = mesh.vertices.patches[drawn.patch].run_count > 1;
  if (drawn.seen == PatchVisibility::kInside || (drawn.seen == PatchVisibility::kAcrossSides && !tests_runs))
    drawer.drawWhole();
  else
    drawer.drawAcrossView(drawn.seen == PatchVisibility::kStraddling);
  drawer.addCounts();
}

}  // namespace sheaf::pipeline
