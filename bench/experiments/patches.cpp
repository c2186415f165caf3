// How a mesh is best cut into patches, and what a tree over them gains.
#include <fmt/format.h>
#include <meshoptimizer.h>

#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/experiments/experiment.h"
#include "bench/experiments/lit_scene.h"
#include "bench/experiments/rounds.h"
#include "bench/experiments/table.h"
#include "grouping/cluster_cuts.h"
#include "grouping/cluster_patches.h"
#include "grouping/patch_cut.h"
#include "pipeline/patch_culling.h"
#include "pipeline/prepare.h"
#include "pipeline/renderer.h"
#include "scenes/camera.h"

namespace sheaf::experiments {
namespace {

using grouping::PatchCut;
using grouping::PatchSet;
using pipeline::Culling;

constexpr const char* kPatchVerdict =
    "*Fill*: meshlets win, with an eighth to a fifth more triangles per patch than the split and fewer "
    "vertices on borders; growing makes clusters 1.5 times as full as they come out of the hierarchy, a little "
    "fuller than the split. *Culling*: whole clusters leave the fewest triangles, being the smallest and "
    "flattest; meshlets leave the most from inside, on the bunny with 10 % in view 1.6 to 1.9 times as many as "
    "the split. *Frames* hardly tell: around a mesh all are within the noise of each other; from inside, "
    "patches grown of clusters take 1 to 4 % less of the geometry stage than the split, but 8 % more on the bunny "
    "with 10 % in view; whole clusters take between 7 % less and 5 % more, meshlets between 2 % less and a third "
    "more; of the frame no more than 3 % is gained. *Preparing*: on two threads the split cuts 13 to 18 M "
    "triangles/s; patches grown of clusters, which have to be clustered first, 1.0 to 1.3 M, nearly as many as "
    "meshlets. That is over ten times the wait for next to nothing in a frame, so the split stays the default, and "
    "meshes are clustered only for what needs clusters.\n\n";
constexpr const char* kTreeVerdict =
    "**1.5 times as fast as flat culling is not reached**, because both use the same kernels: with 16 boxes at "
    "a time the flat test takes a sixth to a fourteenth of the time of the reference, and what is left of it "
    "is too little to save. The tree takes three to six tenths of that again by itself, but within a frame "
    "both mostly wait for boxes and patches that are no longer in the caches, a few hundredths of a "
    "millisecond. Even where nearly nothing is drawn it shows in some runs only (sphere: 1.0 to 1.1 times). At 10 % of "
    "the terrain "
    "in view the transform is nine tenths of the three stages, so that no culling could be 1.5 times as fast; "
    "with set-up and binning the difference is noise. Against the reference, flat and tree are 1.3 times as "
    "fast in these stages on the terrain and some four times on the sphere.\n\n";

constexpr int kWidth = 1920, kHeight = 1080;
constexpr double kAspect = static_cast<double>(kWidth) / kHeight;

/// One mesh of positions and normals, grey; backs are culled.
scenes::Scene bareScene(Context& context, const std::string& name) {
  scenes::Scene scene = litScene(context, name);
  mesh::Mesh& mesh = scene.meshes[0];
  mesh.texcoords.clear();
  mesh.colors.clear();
  scene.materials = {scenes::Material{}};
  scene.instances = {scenes::Instance{}};
  return scene;
}

// --- ways of cutting ---

PatchSet cutBySplit(const mesh::Mesh& mesh, TaskPool& pool) {
  return grouping::splitIntoPatches(mesh, {}, pool);
}

/// The largest clusters within the limits, each a patch.
PatchSet cutToWholeClusters(const mesh::Mesh& mesh, TaskPool& pool) {
  grouping::ClusterOptions options;
  options.min_shape_faces = std::numeric_limits<std::uint32_t>::max();  // patches get bounds of their own
  const grouping::FaceClusters clusters = grouping::clusterFaces(mesh, options, pool);
  const grouping::PatchLimits limits;
  PatchCut cut;
  cut.triangles = clusters.faces;
  grouping::VertexCounter counter(mesh);
  for (const std::uint32_t node : grouping::cutBySize(mesh, clusters, {limits.max_triangles, limits.max_vertices})) {
    const std::size_t begin = clusters.first_face[node];
    cut.runs.push_back(
        {begin, begin + clusters.faceCountOf(node), counter.count(clusters.facesOf(node), limits.max_vertices)});
  }
  return grouping::writePatches(mesh, cut, pool);
}

PatchSet cutToClusterPatches(const mesh::Mesh& mesh, TaskPool& pool) {
  return grouping::clusterPatches(mesh, {}, pool);
}

/// Numbers of triangles in the result are the meshlets' own.
PatchSet cutToMeshlets(const mesh::Mesh& mesh, float cone_weight, TaskPool& pool) {
  constexpr std::size_t kMaxVertices = 255, kMaxTriangles = 512;  // the most that the library takes
  const std::size_t corners = 3 * mesh.triangleCount();
  std::vector<meshopt_Meshlet> meshlets(meshopt_buildMeshletsBound(corners, kMaxVertices, kMaxTriangles));
  std::vector<unsigned> vertices(meshlets.size() * kMaxVertices);
  std::vector<unsigned char> local(meshlets.size() * kMaxTriangles * 3);
  meshlets.resize(meshopt_buildMeshlets(meshlets.data(), vertices.data(), local.data(), mesh.triangles[0].data(),
                                        corners, &mesh.positions[0].x, mesh.vertexCount(), sizeof(Vec3), kMaxVertices,
                                        kMaxTriangles, cone_weight));
  mesh::Mesh sorted;
  sorted.positions = mesh.positions;
  PatchCut cut;
  for (const meshopt_Meshlet& m : meshlets) {
    const std::size_t begin = sorted.triangles.size();
    for (std::size_t t = 0; t < m.triangle_count; ++t) {
      mesh::Triangle triangle;
      for (std::size_t k = 0; k < 3; ++k)
        triangle[k] = vertices[m.vertex_offset + local[m.triangle_offset + 3 * t + k]];
      cut.triangles.push_back(static_cast<std::uint32_t>(sorted.triangles.size()));
      sorted.triangles.push_back(triangle);
    }
    cut.runs.push_back({begin, sorted.triangles.size(), m.vertex_count});
  }
  return grouping::writePatches(sorted, cut, pool);
}

struct Way {
  std::string name;
  std::function<PatchSet(const mesh::Mesh&, TaskPool&)> cut;
};

const std::vector<Way>& ways() {
  static const std::vector<Way> all = {
      {"split by place", cutBySplit},
      {"whole clusters", cutToWholeClusters},
      {"grown of clusters", cutToClusterPatches},
      {"meshlets, cone weight 0", [](const auto& mesh, TaskPool& pool) { return cutToMeshlets(mesh, 0.0F, pool); }},
      {"meshlets, cone weight 0.5", [](const auto& mesh, TaskPool& pool) { return cutToMeshlets(mesh, 0.5F, pool); }}};
  return all;
}

/// The scene of one mesh, prepared with these patches in place of its own.
pipeline::PreparedScene preparedWith(const scenes::Scene& scene, PatchSet set, TaskPool& pool) {
  pipeline::PreparedScene prepared = pipeline::prepareScene(scene, pool);
  pipeline::PreparedMesh& out = prepared.meshes[0];
  const mesh::Mesh& mesh = scene.meshes[0];
  out.vertices = grouping::ungroupedRuns(mesh, set, pool);
  out.normal.clear();
  for (const std::uint32_t v : set.vertex_source) out.normal.push_back(raster::vertexNormal(mesh.normals[v]));
  out.vertex_count = 0;
  for (const grouping::Patch& patch : set.patches) out.vertex_count += patch.vertex_count;
  out.patches = std::move(set.patches);
  out.tree = grouping::buildPatchTree(out.patches);
  out.corners = std::move(set.corners);
  out.triangle_source = std::move(set.triangle_source);
  return prepared;
}

// --- frames ---

struct DrawWay {
  const pipeline::PreparedScene* scene;
  Culling culling = Culling::kTree;
};

/// Medians over the frames, milliseconds of wall time; counters are sums.
struct Drawn {
  Spread to_clip;  ///< culling, transform and clipping
  Spread geometry;
  Spread frame;
  pipeline::Counters counters;
};

double ms(const StageTimes& times, std::initializer_list<Stage> stages) {
  std::int64_t sum = 0;
  for (const Stage stage : stages) sum += times[stage];
  return 1e-6 * static_cast<double>(sum);
}

// Each way draws a frame untimed before the timed one, so that it finds its own data in the caches.
std::vector<Drawn> drawInTurns(const std::vector<DrawWay>& ways, const std::vector<scenes::Camera>& cameras, int rounds,
                               TaskPool& pool) {
  pipeline::Renderer renderer(pool);
  pipeline::RenderSettings settings;
  settings.width = kWidth;
  settings.height = kHeight;
  std::vector<pipeline::Frame> frames(ways.size());
  std::vector<std::array<std::vector<double>, 3>> times(ways.size());
  std::vector<Drawn> result(ways.size());
  for (int round = 0; round < rounds; ++round)
    for (const scenes::Camera& camera : cameras)
      for (std::size_t w = 0; w < ways.size(); ++w) {
        settings.culling = ways[w].culling;
        for (int i = 0; i < 2; ++i) renderer.render(*ways[w].scene, camera, settings, frames[w]);
        const StageTimes& wall = frames[w].wall;
        times[w][0].push_back(ms(wall, {Stage::kCull, Stage::kTransform, Stage::kClip}));
        times[w][1].push_back(ms(wall, {Stage::kCull, Stage::kTransform, Stage::kClip, Stage::kSetupBin}));
        times[w][2].push_back(1e-6 * static_cast<double>(frames[w].wall_ns));
        result[w].counters += frames[w].counters;
      }
  for (std::size_t w = 0; w < ways.size(); ++w) {
    result[w].to_clip = spreadOf(std::move(times[w][0]));
    result[w].geometry = spreadOf(std::move(times[w][1]));
    result[w].frame = spreadOf(std::move(times[w][2]));
  }
  return result;
}

std::string spreadText(const Spread& s) {
  return fmt::format("{} [{}, {}]", rounded(s.median), rounded(s.lower), rounded(s.upper));
}

std::string share(std::uint64_t part, std::uint64_t whole) {
  return percent(static_cast<double>(part) / static_cast<double>(whole));
}

// --- tables ---

void addCutRow(const std::string& model, const Way& way, const mesh::Mesh& mesh, const PatchSet& set, Table& table) {
  std::uint64_t vertices = 0, triangles = 0, with_cone = 0;
  for (const grouping::Patch& p : set.patches) {
    vertices += p.vertex_count;
    triangles += p.triangle_count;
    with_cone += p.cone.sin_angle < 1.0F ? 1 : 0;
  }
  const int runs = mesh.triangleCount() > 200'000 ? 1 : 5;
  std::array<double, 2> times;
  for (const int threads : {1, 2}) {
    TaskPool pool(threads);
    times[static_cast<std::size_t>(threads - 1)] = medianMs(runs, [&] { way.cut(mesh, pool); });
  }
  table.add({fmt::format("{}, {}", model, way.name), fmt::format("{}", set.patches.size()),
             fmt::format("{:.0f}", static_cast<double>(triangles) / static_cast<double>(set.patches.size())),
             fmt::format("{:.3f}", static_cast<double>(vertices) / static_cast<double>(mesh.vertexCount())),
             share(with_cone, set.patches.size()), rounded(times[0]),
             fmt::format("{:.2f}", 1e-3 * static_cast<double>(mesh.triangleCount()) / times[1])});
}

void addDrawnRows(const std::string& name, const std::vector<DrawWay>& drawn_ways,
                  const std::vector<scenes::Camera>& cameras, int rounds, TaskPool& pool, Table& table) {
  const std::vector<Drawn> drawn = drawInTurns(drawn_ways, cameras, rounds, pool);
  for (std::size_t w = 0; w < drawn.size(); ++w) {
    const pipeline::Counters& c = drawn[w].counters;
    table.add({fmt::format("{}, {}", name, ways()[w].name), share(c.patches_outside, c.patches),
               share(c.patches_back_facing, c.patches), share(c.triangles_assembled, c.triangles_in),
               spreadText(drawn[w].geometry), spreadText(drawn[w].frame)});
  }
}

struct CullTimes {
  std::uint64_t drawn = 0;
  std::uint64_t boxes_tested = 0;
  Spread reference_ns, flat_ns, tree_ns;
};

CullTimes timeCulling(const pipeline::PreparedScene& scene, const scenes::Camera& camera) {
  const pipeline::PreparedMesh& mesh = scene.meshes[0];
  const pipeline::View view{scenes::clipFromView(camera, kAspect) * scenes::viewFromWorld(camera),
                            DVec4(camera.eye, 1.0), pipeline::Viewport(kWidth, kHeight)};
  const pipeline::InstanceView instance = pipeline::viewInstance(scene.instances[0], mesh.bounds, view, true);
  pipeline::CulledPatches culled;
  std::vector<pipeline::DrawnPatch>& drawn = culled.drawn;
  const auto cull = [&](Culling culling) {
    drawn.clear();
    culled.boxes_tested = 0;
    for (std::uint32_t part = 0; part < mesh.tree.partCount(); ++part)
      cullPart({0, part}, mesh.tree, culling, instance, culled);
  };
  const auto by_reference = [&] {
    drawn.clear();
    for (std::uint32_t p = 0; p < mesh.patches.size(); ++p) {
      const pipeline::PatchVisibility seen = classifyPatch(mesh.patches[p], instance);
      if (seen != pipeline::PatchVisibility::kOutside && seen != pipeline::PatchVisibility::kBackFacing)
        drawn.push_back({0, p, seen});
    }
  };
  const std::vector<Spread> times =
      timeInTurns({by_reference, [&] { cull(Culling::kPatches); }, [&] { cull(Culling::kTree); }}, 31, 5, 1);
  return {drawn.size(), culled.boxes_tested, times[0], times[1], times[2]};
}

std::string microseconds(const Spread& ns) {
  return rounded(1e-3 * ns.median);
}

}  // namespace

std::string writePatches(Context& context) {
  Table cuts({"mesh, way", "patches", "triangles per patch", "vertices stored per vertex", "with a cone %",
              "one thread ms", "two threads, M faces/s"});
  Table frames({"mesh, way", "patches out of view %", "facing away %", "triangles left %", "geometry ms", "frame ms"});
  for (const std::string name : {"bunny", "dragon", "builtin:terrain?n=708"}) {
    const scenes::Scene scene = bareScene(context, name);
    std::vector<pipeline::PreparedScene> prepared;
    for (const Way& way : ways()) {
      PatchSet set = way.cut(scene.meshes[0], context.pool);
      addCutRow(name, way, scene.meshes[0], set, cuts);
      prepared.push_back(preparedWith(scene, std::move(set), context.pool));
    }
    std::vector<DrawWay> drawn_ways;
    for (const pipeline::PreparedScene& p : prepared) drawn_ways.push_back({&p});
    addDrawnRows(name + ", orbit", drawn_ways, timedOrbit(scene, 6), 3, context.pool, frames);
    for (const double share_in_view : {0.1, 0.25}) {
      const scenes::InsideView inside = scenes::insideView(scene, share_in_view, timedPath());
      addDrawnRows(fmt::format("{}, {} % in view", name, percent(inside.share_in_view, 0)), drawn_ways, {inside.camera},
                   15, context.pool, frames);
    }
  }
  return fmt::format(
             "Ways to cut a mesh into patches of at most 256 vertices and 512 triangles. *Split by place* halves by "
             "position and orientation; *whole clusters* are the largest of the hierarchy [HFC] that are within the "
             "limits; *grown of clusters* starts from clusters of an eighth of that and grows patches of neighbours; "
             "meshlets are meshoptimizer's (at most 255 vertices). Times include the clustering; a patch *with a "
             "cone* can be found to face away. Machine: {}.\n\n",
             machineText()) +
         cuts.text() +
         "What is left of them in frames of 1920x1080, one thread: six cameras around the mesh, and two from "
         "inside; medians and quartiles of frames in turns.\n\n" +
         frames.text() + kPatchVerdict;
}

std::string writePatchTree(Context& context) {
  Table culling({"mesh, view", "patches", "drawn", "boxes tested", "reference µs", "flat µs", "tree µs"});
  Table stage({"mesh, view", "to clip: classic ms", "flat ms", "tree ms", "flat / tree", "geometry: classic ms",
               "flat ms", "tree ms", "flat / tree"});
  for (const std::string name : {"builtin:terrain?n=1448", "builtin:sphere?n=578", "dragon"}) {
    const scenes::Scene scene = bareScene(context, name);
    const pipeline::PreparedScene prepared = pipeline::prepareScene(scene, context.pool);
    const scenes::InsideView inside = scenes::insideView(scene, 0.1, timedPath());
    const scenes::Camera whole = timedOrbit(scene, 1).front();
    for (const auto& [view, camera] :
         {std::pair{std::string("whole"), whole}, {percent(inside.share_in_view, 0) + " % in view", inside.camera}}) {
      const CullTimes times = timeCulling(prepared, camera);
      const std::string label = fmt::format("{}, {}", name, view);
      culling.add({label, fmt::format("{}", prepared.meshes[0].patches.size()), fmt::format("{}", times.drawn),
                   fmt::format("{}", times.boxes_tested), microseconds(times.reference_ns), microseconds(times.flat_ns),
                   microseconds(times.tree_ns)});
      const std::vector<Drawn> drawn =
          drawInTurns({{&prepared, Culling::kNone}, {&prepared, Culling::kPatches}, {&prepared, Culling::kTree}},
                      {camera}, 21, context.pool);
      const auto text = [](const Spread& s) { return rounded(s.median); };
      const auto ratio = [](const Spread& a, const Spread& b) { return fmt::format("{:.2f}", a.median / b.median); };
      stage.add({label, text(drawn[0].to_clip), text(drawn[1].to_clip), spreadText(drawn[2].to_clip),
                 ratio(drawn[1].to_clip, drawn[2].to_clip), text(drawn[0].geometry), text(drawn[1].geometry),
                 spreadText(drawn[2].geometry), ratio(drawn[1].geometry, drawn[2].geometry)});
    }
  }
  return fmt::format(
             "Which patches are drawn, without groups, one thread: *reference* is a plain loop over the patches; "
             "*flat* tests each with kernels that take 16 boxes at once; *tree* uses the same kernels on boxes around "
             "16 and 256 patches first. All three give the same patches. By themselves, with warm caches, medians of "
             "31 rounds in turns; machine: {}.\n\n",
             machineText()) +
         culling.text() +
         "In frames of 1920x1080, after the rest of the frame has used the caches: culling, transform and clipping "
         "(*to clip*), and with set-up and binning the whole geometry stage; medians of 21 frames in turns. *Classic* "
         "leaves out nothing.\n\n" +
         stage.text() + kTreeVerdict;
}

}  // namespace sheaf::experiments
