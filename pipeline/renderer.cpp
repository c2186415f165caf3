#include "pipeline/renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "core/error.h"
#include "pipeline/cull.h"
#include "pipeline/geometry.h"
#include "raster/shade.h"
#include "raster/tile.h"
#include "scenes/camera.h"

namespace sheaf::pipeline {
namespace {

constexpr int kPatchesPerGeometryPiece = 8;
constexpr int kInstancesPerPiece = 64;

int pieces(std::size_t count, int per_piece) {
  return static_cast<int>((count + static_cast<std::size_t>(per_piece) - 1) / static_cast<std::size_t>(per_piece));
}

// Takes normals to world space for any affine transform: the cofactor matrix, det(M) M^-T without the division. Scaled
// so that its largest element is 1, lest squares overflow.
Mat3 normalMatrix(const DMat4& world_from_object) {
  const DMat3 m(world_from_object);
  DMat3 cofactor(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  // A mirroring transform turns the sign: normals keep pointing to the front.
  if (glm::determinant(m) < 0.0) cofactor = -cofactor;
  double largest = 0.0;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) largest = std::max(largest, std::abs(cofactor[c][r]));
  return Mat3(largest > 0.0 ? cofactor / largest : DMat3(1.0));
}

template <typename T>
const T* dataOrNull(const std::vector<T>& v) {
  return v.empty() ? nullptr : v.data();
}

raster::Surface surfaceOf(const PreparedMesh& mesh, const scenes::Instance& instance, std::uint32_t number) {
  raster::Surface s;
  for (std::size_t k = 0; k < 3; ++k) s.position_object[k] = mesh.shadingPosition(k);
  s.normal = dataOrNull(mesh.normal);
  for (std::size_t k = 0; k < 2; ++k) s.texcoord[k] = dataOrNull(mesh.texcoord[k]);
  for (std::size_t k = 0; k < 2; ++k) s.color[k] = dataOrNull(mesh.color[k]);
  s.world_from_object_normal = normalMatrix(instance.world_from_object);
  s.material = instance.material;
  s.instance = number;
  return s;
}

// Directions from surface points to the eye, as a linear function of the pixel (raster::ShadeScene).
void setEyeDirections(const scenes::Camera& camera, const DMat4& view_from_world, int width, int height,
                      raster::ShadeScene& shade) {
  const DMat3 world_from_view = glm::transpose(DMat3(view_from_world));
  if (camera.orthographic_height > 0.0) {
    shade.to_eye = Vec3(world_from_view * DVec3(0.0, 0.0, 1.0));
    shade.to_eye_dx = shade.to_eye_dy = Vec3(0.0F);
    return;
  }
  const double step = 2.0 * std::tan(0.5 * camera.vertical_fov_rad) / height;
  const DVec3 first(-step * (0.5 - 0.5 * width), step * (0.5 - 0.5 * height), 1.0);
  shade.to_eye = Vec3(world_from_view * first);
  shade.to_eye_dx = Vec3(world_from_view * DVec3(-step, 0.0, 0.0));
  shade.to_eye_dy = Vec3(world_from_view * DVec3(0.0, step, 0.0));
}

void resizeFor(bool wanted, int width, int height, auto& image) {
  if (!wanted)
    image = {};
  else if (image.width() != width || image.height() != height)
    image = {width, height};
}

// Copies a tile's depths and ids to the images that were asked for.
void writeData(const raster::TileVisibility& tile, std::span<const raster::ShadeTriangle> triangles, int x0, int y0,
               Frame& frame) {
  const int width = frame.depth.empty() ? frame.instance_id.width() : frame.depth.width();
  const int height = frame.depth.empty() ? frame.instance_id.height() : frame.depth.height();
  for (int y = y0; y < std::min(height, y0 + raster::kTileSize); ++y)
    for (int x = x0; x < std::min(width, x0 + raster::kTileSize); ++x) {
      const int p = raster::tileIndex(x - x0, y - y0);
      if (!frame.depth.empty()) frame.depth.at(x, y) = tile.depth[p];
      if (frame.instance_id.empty()) continue;
      const std::uint32_t seen = tile.triangle[p];
      const bool nothing = seen == raster::kNoTriangle;
      frame.instance_id.at(x, y) = nothing ? raster::kNoTriangle : triangles[seen].surface;
      frame.triangle_id.at(x, y) = nothing ? raster::kNoTriangle : triangles[seen].triangle;
    }
}

}  // namespace

struct Renderer::State {
  explicit State(TaskPool& task_pool) : pool(task_pool), workers(static_cast<std::size_t>(task_pool.threadCount())) {}

  TaskPool& pool;
  std::vector<GeometryWorker> workers;
  std::vector<raster::TileVisibility> tiles = std::vector<raster::TileVisibility>(workers.size());
  raster::ShadeTriangleArena arena;
  std::vector<InstanceView> instances;
  std::vector<raster::Surface> surfaces;
  std::vector<CullJob> jobs;
  std::vector<DrawnPatch> drawn;

  void begin(const PreparedScene& scene, const RenderSettings& settings);
  void cull(const PreparedScene& scene, const View& view, const RenderSettings& settings, Counters& counters);
  void viewInstances(const PreparedScene& scene, const View& view, Culling culling);
  void listJobs(const PreparedScene& scene, Counters& counters);
  void cullPatches(const PreparedScene& scene, Culling culling);
  void gatherDrawn(const PreparedScene& scene, Counters& counters);
  void drawGeometry(const PreparedScene& scene, const View& view);
  void drawTiles(const PreparedScene& scene, const scenes::Camera& camera, const DMat4& view_from_world,
                 const RenderSettings& settings, Frame& frame);
  void drawTile(int tile, int worker, const raster::ShadeScene& shade, Frame& frame);
  void endPhase(std::int64_t begin_ns, Frame& frame);
};

Renderer::Renderer(TaskPool& pool) : state_(std::make_unique<State>(pool)) {}
Renderer::~Renderer() = default;

void Renderer::State::begin(const PreparedScene& scene, const RenderSettings& settings) {
  for (std::size_t i = 0; i < workers.size(); ++i) {
    GeometryWorker& w = workers[i];
    w.binner.reset(settings.width, settings.height, arena);
    w.clock.reset(static_cast<int>(i), settings.record_spans);
    w.counters = {};
    w.culled.drawn.clear();
    w.culled.boxes_tested = w.culled.outside = w.culled.back_facing = 0;
  }
  instances.resize(scene.instances.size());
  surfaces.resize(scene.instances.size());
}

void Renderer::State::cull(const PreparedScene& scene, const View& view, const RenderSettings& settings,
                           Counters& counters) {
  viewInstances(scene, view, settings.culling);
  listJobs(scene, counters);
  cullPatches(scene, settings.culling);
  gatherDrawn(scene, counters);
}

void Renderer::State::viewInstances(const PreparedScene& scene, const View& view, Culling culling) {
  pool.parallelFor(pieces(instances.size(), kInstancesPerPiece), [&](int piece, int worker) {
    StageClock& clock = workers[static_cast<std::size_t>(worker)].clock;
    clock.begin(Stage::kCull);
    const std::size_t first = static_cast<std::size_t>(piece) * kInstancesPerPiece;
    const std::size_t last = std::min(instances.size(), first + kInstancesPerPiece);
    for (std::size_t i = first; i < last; ++i) {
      const scenes::Instance& instance = scene.instances[i];
      const PreparedMesh& mesh = scene.meshes[instance.mesh];
      instances[i] = viewInstance(instance, mesh.bounds, view, culling != Culling::kNone);
      instances[i].culls_back = !scene.double_sided[instance.material];
      surfaces[i] = surfaceOf(mesh, instance, static_cast<std::uint32_t>(i));
    }
    clock.end();
  });
}

void Renderer::State::listJobs(const PreparedScene& scene, Counters& counters) {
  jobs.clear();
  counters.instances = instances.size();
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    const PreparedMesh& mesh = scene.meshes[scene.instances[i].mesh];
    counters.patches += mesh.patches.size();
    counters.triangles_in += mesh.triangle_count;
    if (!instances[i].visible) {
      counters.patches_outside += mesh.patches.size();
      continue;
    }
    for (std::uint32_t part = 0; part < mesh.tree.partCount(); ++part) jobs.push_back({i, part});
  }
}

void Renderer::State::cullPatches(const PreparedScene& scene, Culling culling) {
  pool.parallelFor(static_cast<int>(jobs.size()), [&](int piece, int worker) {
    GeometryWorker& w = workers[static_cast<std::size_t>(worker)];
    w.clock.begin(Stage::kCull);
    const CullJob& job = jobs[static_cast<std::size_t>(piece)];
    const PreparedMesh& mesh = scene.meshes[scene.instances[job.instance].mesh];
    cullPart(job, mesh.tree, culling, instances[job.instance], w.culled);
    w.clock.end();
  });
}

// From all workers, and makes room for their triangles.
void Renderer::State::gatherDrawn(const PreparedScene& scene, Counters& counters) {
  drawn.clear();
  for (const GeometryWorker& w : workers) {
    drawn.insert(drawn.end(), w.culled.drawn.begin(), w.culled.drawn.end());
    counters.boxes_tested += w.culled.boxes_tested;
    counters.patches_outside += w.culled.outside;
    counters.patches_back_facing += w.culled.back_facing;
  }
  std::uint64_t triangles = 0;
  for (const DrawnPatch& d : drawn)
    triangles += scene.meshes[scene.instances[d.instance].mesh].patches[d.patch].triangle_count;
  if (!arena.reset(triangles, static_cast<int>(workers.size())))
    throw Error(ErrorCode::kUnsupported, fmt::format("{} triangles are in view, the raster can number {}", triangles,
                                                     raster::ShadeTriangleArena::kMaxTriangles));
}

void Renderer::State::drawGeometry(const PreparedScene& scene, const View& view) {
  const auto meshOf = [&](const DrawnPatch& d) -> const PreparedMesh& {
    return scene.meshes[scene.instances[d.instance].mesh];
  };
  pool.parallelFor(pieces(drawn.size(), kPatchesPerGeometryPiece), [&](int piece, int worker) {
    GeometryWorker& w = workers[static_cast<std::size_t>(worker)];
    w.clock.begin(Stage::kTransform);
    const std::size_t first = static_cast<std::size_t>(piece) * kPatchesPerGeometryPiece;
    const std::size_t last = std::min(drawn.size(), first + kPatchesPerGeometryPiece);
    for (std::size_t i = first; i < last; ++i) {
      const DrawnPatch& next = drawn[std::min(i + 1, drawn.size() - 1)];
      w.next = {&meshOf(next).vertices, next.patch};
      drawPatch(drawn[i], meshOf(drawn[i]), instances[drawn[i].instance], view.viewport, w);
    }
    w.clock.end();
  });
}

void Renderer::State::drawTiles(const PreparedScene& scene, const scenes::Camera& camera, const DMat4& view_from_world,
                                const RenderSettings& settings, Frame& frame) {
  raster::ShadeScene shade;
  shade.triangles = {arena.data(), arena.capacity()};
  shade.surfaces = surfaces;
  shade.materials = scene.materials;
  shade.light_count = static_cast<int>(scene.lights.size());
  for (std::size_t i = 0; i < scene.lights.size(); ++i)
    shade.lights[i] = {scene.lights[i].direction_to_light_world, scene.lights[i].radiance};
  shade.ambient_sky = scene.ambient.sky;
  shade.ambient_ground = scene.ambient.ground;
  shade.background = settings.background;
  setEyeDirections(camera, view_from_world, settings.width, settings.height, shade);

  const raster::Binner& any = workers.front().binner;
  const int tile_count = any.tilesX() * any.tilesY();
  frame.counters.tiles = static_cast<std::uint64_t>(tile_count);
  pool.parallelFor(tile_count, [&](int tile, int worker) { drawTile(tile, worker, shade, frame); });
}

void Renderer::State::drawTile(int tile, int worker, const raster::ShadeScene& shade, Frame& frame) {
  GeometryWorker& w = workers[static_cast<std::size_t>(worker)];
  raster::TileVisibility& visibility = tiles[static_cast<std::size_t>(worker)];
  const int tiles_x = w.binner.tilesX();
  const int x0 = (tile % tiles_x) * raster::kTileSize;
  const int y0 = (tile / tiles_x) * raster::kTileSize;
  const raster::ColorTarget target{frame.color.empty() ? nullptr : &frame.color,
                                   frame.linear.empty() ? nullptr : &frame.linear};

  w.clock.begin(Stage::kRaster);
  w.tile_entries.clear();
  for (const GeometryWorker& source : workers)
    if (const raster::Binner::Chunk* chunks = source.binner.tile(tile))
      w.tile_entries.push_back({chunks, source.binner.largeTriangles()});
  const bool empty = w.tile_entries.empty();
  const bool data_wanted = !frame.depth.empty() || !frame.instance_id.empty();
  if (!empty || data_wanted) raster::rasterTile(w.tile_entries, shade.triangles.data(), x0, y0, visibility);
  if (data_wanted) writeData(visibility, shade.triangles, x0, y0, frame);

  w.clock.then(Stage::kShade);
  const raster::ShadeCounts counts =
      empty ? raster::fillTile(shade, x0, y0, target) : raster::shadeTile(shade, visibility, x0, y0, target);
  if (empty) ++w.counters.tiles_empty;
  w.counters.pixels_shaded += counts.pixels_shaded;
  w.counters.pixels_background += counts.pixels_background;
  w.clock.end();
}

void Renderer::State::endPhase(std::int64_t begin_ns, Frame& frame) {
  // The wall time since begin_ns goes to the stages by their cpu time since the last call.
  const std::int64_t wall = nowNs() - begin_ns;
  StageTimes total;
  for (const GeometryWorker& w : workers) total += w.clock.times();
  std::int64_t phase_cpu = 0;
  for (std::size_t s = 0; s < kStageCount; ++s) phase_cpu += total.ns[s] - frame.cpu.ns[s];
  for (std::size_t s = 0; s < kStageCount && phase_cpu > 0; ++s) {
    const double share = static_cast<double>(total.ns[s] - frame.cpu.ns[s]) / static_cast<double>(phase_cpu);
    frame.wall.ns[s] += static_cast<std::int64_t>(share * static_cast<double>(wall));
  }
  frame.cpu = total;
}

void Renderer::render(const PreparedScene& scene, const scenes::Camera& camera, const RenderSettings& settings,
                      Frame& frame) {
  assert(settings.width >= 1 && settings.width <= raster::kMaxTargetSize);
  assert(settings.height >= 1 && settings.height <= raster::kMaxTargetSize);
  assert(camera.near > 0.0 && camera.far > camera.near);
  const std::int64_t start = nowNs();
  State& state = *state_;

  frame.counters = {};
  frame.cpu = {};
  frame.wall = {};
  frame.spans.clear();
  resizeFor(settings.want_srgb, settings.width, settings.height, frame.color);
  resizeFor(settings.want_linear, settings.width, settings.height, frame.linear);
  resizeFor(settings.want_depth, settings.width, settings.height, frame.depth);
  resizeFor(settings.want_ids, settings.width, settings.height, frame.instance_id);
  resizeFor(settings.want_ids, settings.width, settings.height, frame.triangle_id);
  state.begin(scene, settings);

  const DMat4 view_from_world = scenes::viewFromWorld(camera);
  const double aspect = static_cast<double>(settings.width) / settings.height;
  const bool parallel = camera.orthographic_height > 0.0;
  const View view{scenes::clipFromView(camera, aspect) * view_from_world,
                  parallel ? DVec4(camera.eye - camera.target, 0.0) : DVec4(camera.eye, 1.0),
                  Viewport(settings.width, settings.height)};

  std::int64_t phase = nowNs();
  state.cull(scene, view, settings, frame.counters);
  state.endPhase(phase, frame);
  phase = nowNs();
  state.drawGeometry(scene, view);
  state.endPhase(phase, frame);
  phase = nowNs();
  state.drawTiles(scene, camera, view_from_world, settings, frame);
  state.endPhase(phase, frame);

  for (const GeometryWorker& w : state.workers) {
    frame.counters += w.counters;
    frame.counters.bin_entries += w.binner.entryCount();
    frame.spans.insert(frame.spans.end(), w.clock.spans().begin(), w.clock.spans().end());
  }
  frame.wall_ns = nowNs() - start;
}

}  // namespace sheaf::pipeline
