// Planes of patches, each in its own frame, against planes across the axes through the whole mesh.
#include <fmt/format.h>

#include <array>
#include <span>
#include <utility>

#include "bench/experiments/experiment.h"
#include "bench/experiments/lit_scene.h"
#include "bench/experiments/picture.h"
#include "bench/experiments/rounds.h"
#include "bench/experiments/table.h"
#include "pipeline/baselines.h"
#include "pipeline/comparison.h"
#include "scenes/camera.h"

namespace sheaf::experiments {
namespace {

constexpr const char* kQualityVerdict =
    "On dense meshes (dragon, terrain) planes of patches move vertices less than half as far, turn normals half as "
    "much, and shift silhouettes half as much. In return a fifth of the vertices stays in full, on the borders of "
    "patches, and takes its 12 bytes. On coarse meshes, where a patch is no longer flat within epsilon, the two are "
    "alike. Drawing differs from the same vertices in full by a few pixels along edges, since sums in another frame "
    "round otherwise; on planes across the axes by none.\n\n";
constexpr const char* kTimeVerdict =
    "*Raster* pays for terraces: on planes across the axes it takes up to twice as long, since steps stand on end and "
    "overlap; on planes of patches 4 to 9 % more. So the dragon, a fifth slower to draw on planes across the axes, is "
    "4 "
    "% slower on its own. *Transform and clipping* take about as long as without groups, 0.89 to 1.06 times as fast on "
    "large meshes; on small ones up to half as long again, which is microseconds of a frame of milliseconds.\n\n";

using pipeline::Grouping;
using pipeline::GroupingOptions;

using pipeline::Prefer;

struct Way {
  const char* name;
  Grouping method;
  Prefer prefer;

  GroupingOptions options() const {
    GroupingOptions options;
    options.method = method;
    options.prefer = prefer;
    return options;
  }
};
constexpr std::array<Way, 2> kCompared = {
    {{"axes", Grouping::kPlanar, Prefer::kMemory}, {"patches", Grouping::kCluster, Prefer::kMemory}}};
constexpr std::array<Way, 3> kTimed = {{{"axes", Grouping::kPlanar, Prefer::kSpeed},
                                        {"patches", Grouping::kCluster, Prefer::kSpeed},
                                        {"patches, for memory", Grouping::kCluster, Prefer::kMemory}}};

pipeline::RenderSettings timedSettings() {
  pipeline::RenderSettings settings;
  settings.width = 1280;
  settings.height = 720;
  return settings;
}

double planesPerPatch(const pipeline::PreparedScene& scene) {
  double planes = 0.0, patches = 0.0;
  for (const pipeline::PreparedMesh& mesh : scene.meshes) {
    for (const grouping::VertexRun& run : mesh.vertices.runs) planes += run.kind == grouping::RunKind::kPlane ? 1 : 0;
    patches += static_cast<double>(mesh.patches.size());
  }
  return planes / patches;
}

std::string qualityTable(Context& context, std::span<const std::string> names) {
  Table table({"mesh, planes across", "eliminated %", "planes per patch", "bytes per vertex", "displacement RMS %",
               "normals RMS degrees", "faces flipped %", "pixels differing %", "RMS error", "silhouette px",
               "of drawing: pixels %"});
  const pipeline::RenderSettings settings = timedSettings();
  for (const std::string& name : names) {
    const scenes::Scene scene = litScene(context, name);
    for (const Way& way : kCompared) {
      const GroupingOptions options = way.options();
      const pipeline::Comparison c =
          pipeline::compareGrouping(scene, timedOrbit(scene, 4), options, settings, context.pool);
      const pipeline::ViewComparison& worst = c.views[c.worst_view];
      double drawing = 0.0;
      for (const auto& view : c.views) drawing = std::max(drawing, view.drawing.pixels.differingFraction());
      table.add({fmt::format("{}, {}", name, way.name), percent(c.geometry.eliminated()),
                 fmt::format("{:.2f}", planesPerPatch(pipeline::prepareScene(scene, context.pool, options))),
                 fmt::format("{:.1f}", c.grouped_bytes_per_vertex), percent(c.geometry.displacement_rms, 3),
                 fmt::format("{:.1f}", degrees(c.geometry.normal_deviation_rms_rad)),
                 percent(static_cast<double>(c.geometry.flipped_faces) / static_cast<double>(scene.triangleCount()), 2),
                 percent(worst.quality.pixels.differingFraction()), fmt::format("{:.2f}", worst.quality.pixels.rms),
                 fmt::format("{:.2f}", worst.quality.silhouette.mean_px), percent(drawing, 4)});
    }
  }
  return table.text();
}

std::string timeTable(Context& context, std::span<const std::string> names) {
  Table table({"mesh, planes across", "transform+clip: ungrouped ms", "grouped ms", "times as fast",
               "geometry: times as fast", "raster: times as fast", "frame: ungrouped ms", "grouped ms",
               "times as fast"});
  const pipeline::RenderSettings settings = timedSettings();
  for (const std::string& name : names) {
    const scenes::Scene scene = litScene(context, name);
    const std::vector<scenes::Camera> cameras = timedOrbit(scene, 4);
    for (const Way& way : kTimed) {
      pipeline::BaselineBench bench(scene, way.options(), settings, context.pool);
      const auto rows = pipeline::summarize(bench.run(cameras, 24, [](double) {}), bench.vertexCount());
      const auto row = [&](std::string_view wanted) -> const pipeline::BaselineRow& {
        return *std::ranges::find(rows, wanted, &pipeline::BaselineRow::name);
      };
      constexpr std::size_t kModern = 1, kGrouped = 2;
      const auto median = [&](std::string_view of, std::size_t baseline) {
        return rounded(row(of).wall_ms[baseline].median);
      };
      const auto gain = [&](std::string_view of) { return fmt::format("{:.2f}", row(of).speedup[kModern].median); };
      table.add({fmt::format("{}, {}", name, way.name), median("transform+clip", kModern),
                 median("transform+clip", kGrouped), gain("transform+clip"), gain("geometry"), gain("raster"),
                 median("frame", kModern), median("frame", kGrouped), gain("frame")});
    }
  }
  return table.text();
}

std::string picture(Context& context) {
  const Panel panel{480, 360};
  scenes::Scene scene = sceneOf(context.models.whole("dragon"), plainGrey());
  scenes::Camera camera = cameraOn(scene, 20.0, 15.0, panel);
  camera.vertical_fov_rad *= 0.4;
  camera = scenes::fitClipPlanes(camera, scenes::boundsOf(scene));
  scenes::addDefaultLights(scene, camera);
  std::vector<Image8> pictures;
  for (const Grouping method : {Grouping::kNone, Grouping::kPlanar, Grouping::kCluster}) {
    GroupingOptions options;
    options.method = method;
    pipeline::RenderSettings settings;
    settings.width = panel.width;
    settings.height = panel.height;
    pipeline::Frame frame;
    pipeline::Renderer(context.pool)
        .render(pipeline::prepareScene(scene, context.pool, options), camera, settings, frame);
    pictures.push_back(std::move(frame.color));
  }
  return showPicture(context, "patch_groups.png", sideBySide(pictures),
                     "The dragon: as it is; on planes across the axes; on planes of patches, both with an epsilon of "
                     "0.5 %.");
}

}  // namespace

std::string writePatchGroups(Context& context) {
  const std::array<std::string, 6> names = {
      "cow", "bunny", "dragon", "builtin:terrain?n=512", "builtin:gallery", "builtin:teapot"};
  const std::array<std::string, 6> timed = {
      "bunny", "dragon", "builtin:gallery", "builtin:terrain?n=512", "builtin:terrain?n=1448", "builtin:sphere?n=836"};
  return "Both with an epsilon of 0.5 %, the distance metric and 16-bit parameters. *Axes*: planes across x, y and z "
         "through the whole mesh, as published; *patches*: patches are made of face clusters, and each has planes in "
         "a frame of its own. Vertices on borders between patches stay where they are, and planes that would take "
         "fewer than 16 vertices of a patch are left out, as by --prefer memory. Pictures are of 1280x720, the "
         "worst of four views; *of drawing* is what differs from the same moved vertices drawn without groups.\n\n" +
         qualityTable(context, names) + kQualityVerdict + picture(context) +
         "Times, one thread, by default and, where it says so, with --prefer memory; medians of 24 frames in turns "
         "from four sides; *ungrouped* is the original mesh with "
         "patches out of view or facing away left out.\n\n" +
         timeTable(context, timed) + kTimeVerdict;
}

}  // namespace sheaf::experiments
