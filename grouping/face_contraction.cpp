#include "grouping/face_contraction.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

#include "grouping/graph_parts.h"

namespace sheaf::grouping {
namespace {

using mesh::Mesh;
using mesh::Triangle;

ClusterMoments momentsOf(const Mesh& mesh, const ModelFrame& frame, std::uint32_t face, bool turned) {
  const Triangle& t = mesh.triangles[face];
  if (!hasFiniteCorners(mesh, t)) return {};
  double perimeter = 0.0;
  const TriangleEdges e = edgesOf(t);
  for (std::size_t i = 0; i < static_cast<std::size_t>(e.count); ++i)
    perimeter += glm::length(frame(mesh.positions[e.edges[i][0]]) - frame(mesh.positions[e.edges[i][1]]));
  ClusterMoments m =
      momentsOfFace(frame(mesh.positions[t[0]]), frame(mesh.positions[t[1]]), frame(mesh.positions[t[2]]), perimeter);
  if (turned) m.area_vector = -m.area_vector;
  return m;
}

// A part is contracted to this share. Going on to an eighth is hardly faster, and clusters along borders, which have to
// wait for the next round, then cost too much.
constexpr std::uint32_t kPartShare = 4;

// What became of a part, and where it goes in the whole.
struct PartResult {
  ContractedPart rest;
  std::vector<std::uint32_t> clusters;  // before the round: the part's own, then the halo
  std::uint32_t own = 0;
  std::uint32_t first_merge = 0;    // in the whole tree
  std::uint32_t first_cluster = 0;  // among those that are left of all parts
};

std::size_t totalLeft(const std::vector<PartResult>& results) {
  return results.empty() ? 0 : results.back().first_cluster + results.back().rest.node.size();
}

class FaceContraction {
 public:
  FaceContraction(const Mesh& mesh, const ModelFrame& frame, DualGraph graph, const std::vector<bool>& turned,
                  const CostWeights& weights, TaskPool& pool)
      : mesh_(mesh), frame_(frame), turned_(turned), weights_(weights), pool_(pool), graph_(std::move(graph)) {}

  std::size_t clusterCount() const { return graph_.first.size(); }

  // One round: the dual graph of what is left takes the place of the present one.
  void contractInParts(std::size_t part_size) {
    std::vector<PartResult> results = contractParts(cutIntoParts(graph_, part_size));
    const std::size_t count = clusterCount();
    graph_ = {};  // makes room
    placeResults(results);
    for (const PartResult& r : results)
      appendTree(r.rest.tree, r.own, [&](std::uint32_t i) { return nodeOf(r.clusters[i]); });
    joinLinks(results, successorsOf(results, count));
    takeClusters(results);
  }

  void contractRest() {
    const auto count = static_cast<std::uint32_t>(clusterCount());
    const MergeTree rest = contract(
        std::move(graph_), [this](std::uint32_t cluster) { return momentsOfCluster(cluster); }, weights_);
    appendTree(rest, count, [this](std::uint32_t cluster) { return nodeOf(cluster); });
  }

  MergeTree takeTree() { return std::move(tree_); }

 private:
  bool isFirstRound() const { return node_.empty(); }

  std::uint32_t nodeOf(std::uint32_t cluster) const { return isFirstRound() ? cluster : node_[cluster]; }

  ClusterMoments momentsOfCluster(std::uint32_t cluster) const {
    if (!isFirstRound()) return moments_[cluster];
    return momentsOf(mesh_, frame_, cluster, !turned_.empty() && turned_[cluster]);
  }

  std::uint32_t mergedNode(std::uint32_t merge) const {
    return static_cast<std::uint32_t>(mesh_.triangleCount()) + merge;
  }

  template <typename Body>
  void forEachPart(std::size_t count, const Body& body) const {
    pool_.parallelFor(static_cast<int>(count), [&](int part, int) { body(static_cast<std::size_t>(part)); });
  }

  std::vector<PartResult> contractParts(const GraphParts& parts) const {
    std::vector<PartResult> results(parts.count());
    forEachPart(parts.count(), [&](std::size_t part) {
      PartGraph g = partGraph(graph_, parts, part);
      PartResult& r = results[part];
      r.rest = contractPart(
          std::move(g.graph), g.own, g.own / kPartShare,
          [&](std::uint32_t i) { return momentsOfCluster(g.clusters[i]); }, weights_);
      r.clusters = std::move(g.clusters);
      r.own = g.own;
    });
    return results;
  }

  void placeResults(std::vector<PartResult>& results) const {
    auto merge = static_cast<std::uint32_t>(tree_.children.size());
    std::uint32_t cluster = 0;
    for (PartResult& r : results) {
      r.first_merge = merge;
      r.first_cluster = cluster;
      merge += static_cast<std::uint32_t>(r.rest.tree.children.size());
      cluster += static_cast<std::uint32_t>(r.rest.node.size());
    }
  }

  // node_of(cluster)  in the whole tree, of the `own` clusters that there were before
  template <typename NodeOf>
  void appendTree(const MergeTree& part, std::uint32_t own, const NodeOf& node_of) {
    const auto first = static_cast<std::uint32_t>(tree_.children.size());
    const auto whole = [&](std::uint32_t node) {
      return node < own ? node_of(node) : mergedNode(first + (node - own));
    };
    for (const auto& [a, b] : part.children) {
      const auto [low, high] = std::minmax({whole(a), whole(b)});
      tree_.children.push_back({low, high});
    }
    tree_.cost.insert(tree_.cost.end(), part.cost.begin(), part.cost.end());
  }

  // By number before the round: what the cluster has become a part of.
  std::vector<std::uint32_t> successorsOf(const std::vector<PartResult>& results, std::size_t count) const {
    std::vector<std::uint32_t> successors(count);
    forEachPart(results.size(), [&](std::size_t part) {
      const PartResult& r = results[part];
      std::vector<std::uint32_t> of_node(r.own + r.rest.tree.children.size());
      for (std::uint32_t i = 0; i < r.rest.node.size(); ++i) of_node[r.rest.node[i]] = r.first_cluster + i;
      for (std::size_t i = r.rest.tree.children.size(); i-- > 0;)
        for (const std::uint32_t child : r.rest.tree.children[i]) of_node[child] = of_node[r.own + i];
      for (std::uint32_t i = 0; i < r.own; ++i) successors[r.clusters[i]] = of_node[i];
    });
    return successors;
  }

  // The dual edges of what is left: those within parts as they are, and those between parts, of which several may have
  // become one. Each part brings the ones that lead to later parts.
  void joinLinks(const std::vector<PartResult>& results, const std::vector<std::uint32_t>& successors) {
    std::vector<std::vector<DualEdge>> edges(results.size());
    forEachPart(results.size(), [&](std::size_t part) {
      const PartResult& r = results[part];
      const auto left = static_cast<std::uint32_t>(r.rest.node.size());
      std::vector<DualEdge> between;
      for (const auto& [cluster, length] : r.rest.links) {
        const std::uint32_t a = r.first_cluster + cluster[0];
        if (cluster[1] < left) {
          edges[part].push_back({{a, r.first_cluster + cluster[1]}, {}, length, 0.0F, false});
        } else if (const std::uint32_t b = successors[r.clusters[r.own + (cluster[1] - left)]]; b > a) {
          between.push_back({{a, b}, {}, length, 0.0F, false});
        }
      }
      std::ranges::stable_sort(between, {}, &DualEdge::face);
      for (const DualEdge& e : between) {
        if (edges[part].empty() || edges[part].back().face != e.face)
          edges[part].push_back(e);
        else
          edges[part].back().length += e.length;
      }
    });
    for (std::vector<DualEdge>& e : edges) {
      graph_.edges.insert(graph_.edges.end(), e.begin(), e.end());
      std::vector<DualEdge>().swap(e);
    }
    linkEdges(totalLeft(results), graph_);
  }

  void takeClusters(std::vector<PartResult>& results) {
    std::vector<std::uint32_t> nodes;
    nodes.reserve(totalLeft(results));
    moments_.clear();
    for (PartResult& r : results) {
      for (const std::uint32_t node : r.rest.node)
        nodes.push_back(node < r.own ? nodeOf(r.clusters[node]) : mergedNode(r.first_merge + (node - r.own)));
      moments_.insert(moments_.end(), r.rest.moments.begin(), r.rest.moments.end());
      r = {};
    }
    node_ = std::move(nodes);
  }

  const Mesh& mesh_;
  const ModelFrame& frame_;
  const std::vector<bool>& turned_;
  const CostWeights& weights_;
  TaskPool& pool_;
  MergeTree tree_;
  // What is left, by cluster. The first clusters are the faces, whose sums are only made when they are asked for.
  DualGraph graph_;
  std::vector<std::uint32_t> node_;  // in tree_
  std::vector<ClusterMoments> moments_;
};

// Numbers merges as if they had been made in the order of their costs; none before the merges that made its parts.
void sortByCost(std::uint32_t face_count, MergeTree& tree) {
  const auto merges = static_cast<std::uint32_t>(tree.children.size());
  std::vector<float> worst = tree.cost;  // of the merge and all below it
  for (std::uint32_t i = 0; i < merges; ++i)
    for (const std::uint32_t child : tree.children[i])
      if (child >= face_count) worst[i] = std::max(worst[i], worst[child - face_count]);
  std::vector<std::uint32_t> order(merges), rank(merges);
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t merge) { return worst[merge]; });
  for (std::uint32_t i = 0; i < merges; ++i) rank[order[i]] = i;
  MergeTree sorted;
  sorted.children.reserve(merges);
  sorted.cost.reserve(merges);
  for (const std::uint32_t merge : order) {
    auto [a, b] = tree.children[merge];
    if (a >= face_count) a = face_count + rank[a - face_count];
    if (b >= face_count) b = face_count + rank[b - face_count];
    sorted.children.push_back({std::min(a, b), std::max(a, b)});
    sorted.cost.push_back(tree.cost[merge]);
  }
  tree = std::move(sorted);
}

}  // namespace

MergeTree contractFaces(const Mesh& mesh, const ModelFrame& frame, DualGraph graph, const std::vector<bool>& turned,
                        const CostWeights& weights, TaskPool& pool, const ContractionPlan& plan) {
  assert(plan.part_size > 0);
  FaceContraction contraction(mesh, frame, std::move(graph), turned, weights, pool);
  const bool is_in_parts = contraction.clusterCount() > plan.most_at_once;
  for (std::size_t before = 0;
       contraction.clusterCount() > plan.most_at_once && contraction.clusterCount() != before;) {
    before = contraction.clusterCount();
    contraction.contractInParts(plan.part_size);
  }
  contraction.contractRest();
  MergeTree tree = contraction.takeTree();
  if (is_in_parts) sortByCost(static_cast<std::uint32_t>(mesh.triangleCount()), tree);
  return tree;
}

}  // namespace sheaf::grouping
