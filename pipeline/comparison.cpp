#include "pipeline/comparison.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "scenes/camera.h"

namespace sheaf::pipeline {
namespace {

constexpr Rgba8 kGapColor{128, 128, 128, 255};

/// The same scene, prepared in three ways.
struct Forms {
  PreparedScene original;
  PreparedScene snapped;
  PreparedScene grouped;
};

Forms prepareForms(const scenes::Scene& scene, GroupingOptions grouping, TaskPool& pool,
                   const grouping::Progress& progress) {
  // The groups are found twice.
  const auto firstHalf = [&](double done) { return !progress || progress(0.5 * done); };
  const auto secondHalf = [&](double done) { return !progress || progress(0.5 + 0.5 * done); };
  Forms forms;
  forms.original = prepareScene(scene, pool);
  grouping.use_groups = false;
  forms.snapped = prepareScene(scene, pool, grouping, firstHalf);
  grouping.use_groups = true;
  forms.grouped = prepareScene(scene, pool, grouping, secondHalf);
  return forms;
}

void lightFrom(const scenes::Camera& camera, std::initializer_list<PreparedScene*> forms) {
  scenes::Scene lights;
  scenes::addDefaultLights(lights, camera);
  for (PreparedScene* form : forms) {
    form->lights = lights.lights;
    form->ambient = lights.ambient;
  }
}

PictureDifference differenceOf(const Frame& a, const Frame& b) {
  return {raster::compareImages(a.color, b.color), raster::silhouetteShift(a.instance_id, b.instance_id)};
}

}  // namespace

double maxDrawingDifference(Grouping method) {
  return method == Grouping::kLinear || method == Grouping::kCluster ? 0.01 : 0.0;
}

double GeometricError::eliminated() const {
  return vertices > 0 ? static_cast<double>(grouped) / static_cast<double>(vertices) : 0.0;
}

GeometricError geometricError(const PreparedScene& scene) {
  GeometricError error;
  double triangles = 0.0;
  for (const PreparedMesh& mesh : scene.meshes) {
    const grouping::GroupingStats& s = mesh.grouping;
    const double n = s.vertices;
    const auto t = static_cast<double>(mesh.triangle_count);
    error.vertices += s.vertices;
    error.grouped += s.grouped;
    error.displacement_max = std::max(error.displacement_max, s.displacement_max);
    error.displacement_mean += n * s.displacement_mean;
    error.displacement_rms += n * s.displacement_rms * s.displacement_rms;
    error.normal_deviation_max_rad = std::max(error.normal_deviation_max_rad, s.normal_deviation_max_rad);
    error.normal_deviation_rms_rad += t * s.normal_deviation_rms_rad * s.normal_deviation_rms_rad;
    error.flipped_faces += s.flipped_faces;
    error.collapsed_faces += s.collapsed_faces;
    error.search_ms += s.search_ms;
    triangles += t;
  }
  const double vertices = std::max(1.0, static_cast<double>(error.vertices));
  error.displacement_mean /= vertices;
  error.displacement_rms = std::sqrt(error.displacement_rms / vertices);
  error.normal_deviation_rms_rad = std::sqrt(error.normal_deviation_rms_rad / std::max(1.0, triangles));
  return error;
}

double shareDrawnByGroups(const PreparedScene& scene) {
  std::uint64_t grouped = 0;
  std::uint64_t vertices = 0;
  for (const PreparedMesh& mesh : scene.meshes) {
    for (const grouping::VertexRun& run : mesh.vertices.runs)
      if (run.kind != grouping::RunKind::kFull) grouped += run.vertex_count;
    vertices += mesh.vertex_count;
  }
  return vertices > 0 ? static_cast<double>(grouped) / static_cast<double>(vertices) : 0.0;
}

double bytesPerVertex(const PreparedScene& scene) {
  std::uint64_t bytes = 0;
  std::uint64_t vertices = 0;
  for (const PreparedMesh& mesh : scene.meshes) {
    bytes += mesh.vertexBytes();
    vertices += mesh.vertex_count;
  }
  return vertices > 0 ? static_cast<double>(bytes) / static_cast<double>(vertices) : 0.0;
}

bool Comparison::drawsRight() const {
  const double allowed = maxDrawingDifference(grouping.method);
  return std::all_of(views.begin(), views.end(),
                     [&](const ViewComparison& view) { return view.drawing.pixels.differingFraction() <= allowed; });
}

Comparison compareGrouping(const scenes::Scene& scene, std::span<const scenes::Camera> cameras,
                           GroupingOptions grouping, RenderSettings settings, TaskPool& pool,
                           const grouping::Progress& progress) {
  assert(!cameras.empty());
  Forms forms = prepareForms(scene, grouping, pool, progress);
  Comparison result;
  result.grouping = grouping;
  result.geometry = geometricError(forms.grouped);
  result.drawn_by_groups = shareDrawnByGroups(forms.grouped);
  result.original_bytes_per_vertex = bytesPerVertex(forms.original);
  result.grouped_bytes_per_vertex = bytesPerVertex(forms.grouped);
  result.warnings = forms.grouped.warnings;

  settings.want_srgb = settings.want_ids = true;
  Renderer renderer(pool);
  Frame original;
  Frame snapped;
  Frame grouped;
  for (const scenes::Camera& camera : cameras) {
    if (scene.lights.empty()) lightFrom(camera, {&forms.original, &forms.snapped, &forms.grouped});
    renderer.render(forms.original, camera, settings, original);
    renderer.render(forms.snapped, camera, settings, snapped);
    renderer.render(forms.grouped, camera, settings, grouped);
    result.views.push_back({camera, differenceOf(snapped, grouped), differenceOf(original, grouped)});
    const double worst_rms = result.views[result.worst_view].quality.pixels.rms;
    if (result.views.size() > 1 && result.views.back().quality.pixels.rms <= worst_rms) continue;
    result.worst_view = result.views.size() - 1;
    result.original = original.color;
    result.grouped = grouped.color;
    result.snapped = snapped.color;
  }
  return result;
}

Image8 sideBySide(const Comparison& comparison) {
  const Image8 heat = raster::heatMap(comparison.original, comparison.grouped);
  const int width = heat.width();
  Image8 picture(3 * width + 2 * kSideBySideGapPx, heat.height(), kGapColor);
  int x = 0;
  for (const Image8* part : {&comparison.original, &comparison.grouped, &heat}) {
    for (int y = 0; y < heat.height(); ++y) std::copy_n(part->row(y), width, picture.row(y) + x);
    x += width + kSideBySideGapPx;
  }
  return picture;
}

}  // namespace sheaf::pipeline
