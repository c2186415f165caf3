// Hierarchical face clustering [HFC]: time, the balance of the hierarchy, what the shape bias does.
#include <fmt/format.h>

#include <array>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "bench/experiments/experiment.h"
#include "bench/experiments/picture.h"
#include "bench/experiments/table.h"
#include "grouping/cluster_colors.h"
#include "grouping/cluster_cuts.h"
#include "grouping/dual_graph.h"
#include "grouping/face_contraction.h"
#include "grouping/shape_tree.h"
#include "pipeline/overlays.h"
#include "scenes/painted_parts.h"

namespace sheaf::experiments {
namespace {

using grouping::ClusterCut;
using grouping::CostWeights;
using grouping::FaceClusters;

constexpr CostWeights kAsPublished{1.0, 1.0, 1.0, 0.0};

FaceClusters clustered(Context& context, const mesh::Mesh& mesh, const CostWeights& weights) {
  return grouping::clusterFaces(mesh, {.weights = weights}, context.pool);
}

/// Of [HFC] on a Pentium III of 450 MHz, seconds.
struct Published {
  std::size_t faces;
  double init_s;
  double cluster_s;
};

std::string timeTable(Context& context) {
  Table table({"model", "faces", "dual graph ms", "whole ms", "ns per face", "[HFC]: faces", "init ms", "cluster ms"});
  const auto add = [&](const std::string& name, const mesh::Mesh& mesh, const Published* published) {
    const int runs = mesh.triangleCount() > 200'000 ? 3 : 9;
    const double graph = medianMs(runs, [&] { grouping::buildDualGraph(mesh, grouping::modelFrameOf(mesh)); });
    const double whole = medianMs(runs, [&] { clustered(context, mesh, {}); });
    const auto ms = [](double seconds) { return fmt::format("{:.0f}", 1000.0 * seconds); };
    table.add({name, fmt::format("{}", mesh.triangleCount()), rounded(graph), rounded(whole),
               rounded(1e6 * whole / static_cast<double>(mesh.triangleCount())),
               published ? fmt::format("{}", published->faces) : "", published ? ms(published->init_s) : "",
               published ? ms(published->cluster_s) : ""});
  };
  const std::array<Published, 3> rows = {{{5804, 0.21, 0.51}, {11'036, 0.4, 1.43}, {375'736, 13.34, 48.31}}};
  add("cow", context.models.whole("cow"), &rows[0]);
  // Nearly as many faces as there: a closed surface has two per vertex.
  add("bunny, simplified", context.models.lod("bunny", rows[1].faces / 2), &rows[1]);
  add("bunny", context.models.whole("bunny"), nullptr);
  add("dragon, simplified", context.models.lod("dragon", rows[2].faces / 2), &rows[2]);
  add("dragon", context.models.whole("dragon"), nullptr);
  return table.text();
}

double meanDepth(const FaceClusters& clusters) {
  std::vector<std::uint32_t> depth(clusters.nodeCount(), 0);
  double sum = 0.0;
  for (std::uint32_t node = clusters.nodeCount(); node-- > 0;) {  // parents are higher than their parts
    if (clusters.parent[node] != grouping::kNoIndex) depth[node] = depth[clusters.parent[node]] + 1;
    if (clusters.isFace(node)) sum += depth[node];
  }
  return sum / clusters.faceCount();
}

std::string balanceTable(Context& context) {
  const mesh::Mesh& mesh = context.models.whole("bunny");
  const double extent = mesh::boundsOf(mesh).longestEdge();
  Table table({"balance", "mean depth", "of 1000 clusters: median faces", "most faces", "RMS %",
               "clusters of at most 512 faces", "RMS %"});
  for (const double balance : {0.0, 0.01, 0.1, 1.0}) {
    const FaceClusters clusters = clustered(context, mesh, {1.0, 1.0, 1.0, balance});
    const auto figures = [&](const ClusterCut& cut) { return grouping::figuresOf(mesh, clusters, cut); };
    const grouping::CutFigures thousand = figures(grouping::cutByCount(clusters, 1000));
    const grouping::CutFigures small = figures(grouping::cutBySize(mesh, clusters, {.max_faces = 512}));
    table.add({fmt::format("{:g}", balance), fmt::format("{:.1f}", meanDepth(clusters)),
               fmt::format("{}", thousand.median_faces), fmt::format("{}", thousand.most_faces),
               percent(thousand.rms_distance / extent, 3), fmt::format("{}", small.clusters),
               percent(small.rms_distance / extent, 3)});
  }
  return table.text();
}

// With a plan of its own, which clusterFaces() does not let one choose.
FaceClusters contracted(const mesh::Mesh& mesh, const grouping::ContractionPlan& plan, TaskPool& pool) {
  const grouping::ModelFrame frame = grouping::modelFrameOf(mesh);
  grouping::DualGraph graph = grouping::buildDualGraph(mesh, frame);
  const std::vector<bool> turned = grouping::findTurnedFaces(graph);
  grouping::MergeTree tree = grouping::contractFaces(mesh, frame, std::move(graph), turned, {}, pool, plan);
  FaceClusters clusters = grouping::hierarchyOf(static_cast<std::uint32_t>(mesh.triangleCount()),
                                                std::move(tree.children), std::move(tree.cost));
  grouping::addShapes(mesh, grouping::ClusterOptions{}.min_shape_faces, pool, clusters);
  return clusters;
}

// Every vertex moved by up to a millionth of the mesh's extent: how far a result depends on nothing that matters.
mesh::Mesh shaken(mesh::Mesh mesh) {
  std::mt19937 rng(0x51a6);
  const float most = 1e-6F * static_cast<float>(mesh::boundsOf(mesh).longestEdge());
  std::uniform_real_distribution<float> step(-most, most);
  for (Vec3& p : mesh.positions)
    for (int k = 0; k < 3; ++k) p[k] += step(rng);
  return mesh;
}

std::string partsTable(Context& context) {
  Table table({"model", "contracted", "1 thread ms", "2 threads ms", "mean cost", "mean depth",
               "faces / 64 clusters: RMS %", "1000 clusters: RMS %", "clusters of at most 512 faces"});
  TaskPool one(1), two(2);
  for (const std::string name : {"bunny", "armadillo", "dragon"}) {
    const mesh::Mesh& mesh = context.models.whole(name);
    const mesh::Mesh moved = shaken(mesh);
    const grouping::ContractionPlan at_once{.most_at_once = mesh.triangleCount()};
    struct Way {
      const char* name;
      const mesh::Mesh& mesh;
      grouping::ContractionPlan plan;
    };
    for (const Way& way : {Way{"at once", mesh, at_once}, Way{"at once, shaken", moved, at_once},
                           Way{"in parts", mesh, {}}, Way{"in parts, shaken", moved, {}}}) {
      FaceClusters clusters;
      const auto ms = mediansInTurns(3, {[&] { clusters = contracted(way.mesh, way.plan, one); },
                                         [&] { clusters = contracted(way.mesh, way.plan, two); }});
      const double extent = mesh::boundsOf(mesh).longestEdge();
      const auto rms = [&](std::uint32_t count) {
        const ClusterCut cut = grouping::cutByCount(clusters, count);
        return percent(grouping::figuresOf(way.mesh, clusters, cut).rms_distance / extent, 4);
      };
      const double cost = std::accumulate(clusters.cost.begin(), clusters.cost.end(), 0.0);
      table.add({name, way.name, rounded(ms[0]), rounded(ms[1]),
                 fmt::format("{:.4f}", cost / static_cast<double>(clusters.cost.size())),
                 fmt::format("{:.1f}", meanDepth(clusters)), rms(clusters.faceCount() / 64), rms(1000),
                 fmt::format("{}", grouping::cutBySize(way.mesh, clusters, {.max_faces = 512}).size())});
    }
  }
  return table.text();
}

Image8 picture(Context& context, const std::string& model, const FaceClusters& clusters, std::uint32_t count,
               const Panel& panel = {}, const pipeline::Overlay& overlay = {}) {
  const mesh::Mesh& mesh = context.models.whole(model);
  const ClusterCut cut = grouping::cutByCount(clusters, count);
  scenes::Material material = plainGrey();
  material.base_color = Vec4(1.0F);
  scenes::Scene scene = sceneOf(mesh, material);
  Extras extras;
  extras.colors = pipeline::colorsByPart(grouping::clusterOfFace(clusters, cut),
                                         grouping::colorClusters(mesh, clusters, cut, scenes::kPartColors),
                                         pipeline::faceCountsOf(scene));
  scenes::Camera camera = cameraOn(scene, 20.0, 10.0, panel);
  if (overlay.any()) {
    extras.overlay = pipeline::clusterOverlay(mesh, clusters, cut, overlay, {camera, panel.height});
    camera = cameraOn(*extras.overlay, 20.0, 10.0, panel);  // it is larger than the surface
  }
  return draw(std::move(scene), camera, panel, context.pool, std::move(extras));
}

std::string pictures(Context& context) {
  const mesh::Mesh& bunny = context.models.whole("bunny");
  const FaceClusters without = clustered(context, bunny, {1.0, 1.0, 0.0, 0.0}),
                     published = clustered(context, bunny, kAsPublished), usual = clustered(context, bunny, {});
  const std::array<Image8, 3> biases = {picture(context, "bunny", without, 100),
                                        picture(context, "bunny", published, 100),
                                        picture(context, "bunny", usual, 100)};
  const FaceClusters figure = clustered(context, context.models.whole("armadillo"), {});
  std::vector<Image8> cuts;
  for (const std::uint32_t count : {1024U, 256U, 64U, 16U})
    cuts.push_back(picture(context, "armadillo", figure, count, {.width = 270, .height = 330}));
  const Panel large{540, 405};
  const std::array<Image8, 2> overlays = {picture(context, "bunny", usual, 24, large, {.boxes = true}),
                                          picture(context, "bunny", usual, 24, large, {.planes = true})};
  return showPicture(context, "clusters_shape.png", sideBySide(biases),
                     "The bunny in 100 clusters: without shape bias; with it, as published; with shape and balance, "
                     "as sheaf does by default.") +
         showPicture(context, "clusters_cuts.png", sideBySide(cuts),
                     "Four cuts of one hierarchy of the armadillo: 1024, 256, 64 and 16 clusters.") +
         showPicture(context, "clusters_overlays.png", sideBySide(overlays),
                     "The bunny in 24 clusters: their oriented boxes, and the planes that fit them.");
}

}  // namespace

std::string writeClustering(Context& context) {
  return "Hierarchies of face clusters as in [HFC]: neighbouring faces are joined in the order of how flat, how evenly "
         "turned and how round what they make is. Times of [HFC] are of a Pentium III at 450 MHz; its other models "
         "than "
         "the cow are not known, so ours have about the same number of faces. The whole includes the dual graph and, "
         "beyond [HFC], boxes and normal cones of all clusters of 8 faces or more.\n\n" +
         timeTable(context) +
         "All terms of the cost in [HFC] are means, so a large cluster takes in one more face almost for nothing, and "
         "the hierarchy becomes a chain of single faces. Ours adds a fourth term: the logarithm of the number of "
         "faces, "
         "with a weight of 0.1. The bunny with other weights; planarity is the RMS distance of corners to the plane of "
         "their cluster, of the longest edge of the box:\n\n" +
         balanceTable(context) +
         "Large meshes are contracted in parts of 8192 clusters, each to a quarter, and what "
         "is left in parts again, cut along other lines. So a part stays in a core's cache, and threads share parts "
         "out; the result does not depend on their number. Against a contraction in which every merge is the cheapest "
         "of all, and what both make of a mesh *shaken*: each vertex moved by up to a millionth of the longest edge of "
         "the box. In parts a merge costs up to 0.002 more or less on the mean; flatness and depth differ about as "
         "much "
         "as by shaking:\n\n" +
         partsTable(context) + pictures(context);
}

}  // namespace sheaf::experiments
