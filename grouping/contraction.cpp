#include "grouping/contraction.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <unordered_map>
#include <utility>

#include "grouping/merge_queue.h"

namespace sheaf::grouping {
namespace {

// A cluster as long as it lives. When it is merged into another one, what made that merge is noted here in place of its
// neighbours: there are as many merges as clusters that vanish.
struct Slot : ClusterMoments {
  std::uint32_t node;    // in the tree; of a vanished cluster: the other child
  std::uint32_t first;   // head of its list of dual edges; of a vanished cluster: its own node
  std::uint32_t degree;  // dual edges that are left; of a vanished cluster: the number of the merge
  std::uint32_t mark;    // scratch: a dual edge to the cluster that is being merged; of a vanished one: the cost's bits

  bool hasVanished() const { return corners < 0.0; }
};
static_assert(sizeof(Slot) == 184);

class Contraction {
 public:
  Contraction(DualGraph graph, std::uint32_t own, const MomentsOf& moments_of, const CostWeights& weights)
      : weights_(weights),
        own_(own),
        edges_(std::move(graph.edges)),
        slots_(makeSlots(std::exchange(graph.first, {}), moments_of)),
        queue_(edges_, [this](const DualEdge& e) { return costOf(e); }) {
    for (const DualEdge& e : edges_) {
      assert(e.face[0] < own_);
      ++slots_[e.face[0]].degree, ++slots_[e.face[1]].degree;
    }
  }

  // Until `most` merges have been made, or none is left that stays in the part.
  void run(std::uint32_t most) {
    while (merges_ < most && queue_.prepareTop()) {
      const std::uint32_t id = queue_.top();
      const DualEdge& e = edges_[id];
      if (e.face[0] >= own_ || e.face[1] >= own_) {
        queue_.pop();
        continue;
      }
      if (isHub(slots_[e.face[0]]) || isHub(slots_[e.face[1]])) {
        queue_.update(id, costOf(e));
        if (!queue_.prepareTop() || queue_.top() != id) continue;
      }
      contract(id);
    }
  }

  // Nothing else can be asked for afterwards.
  MergeTree takeTree() {
    std::vector<DualEdge>().swap(edges_);  // makes room
    return tree();
  }

  ContractedPart takePart() {
    ContractedPart part;
    part.tree = tree();
    std::vector<std::uint32_t> number(slots_.size());  // of what is left; the halo keeps its distance from own_
    for (std::uint32_t s = 0; s < own_; ++s) {
      if (slots_[s].hasVanished()) continue;
      number[s] = static_cast<std::uint32_t>(part.node.size());
      part.node.push_back(slots_[s].node);
      part.moments.push_back(slots_[s]);
    }
    const auto left = static_cast<std::uint32_t>(part.node.size());
    for (auto s = own_; s < slots_.size(); ++s) number[s] = left + (s - own_);
    for (const DualEdge& e : edges_)
      if (e.length != kContracted) part.links.push_back({{number[e.face[0]], number[e.face[1]]}, e.length});
    return part;
  }

 private:
  MergeTree tree() const {
    MergeTree tree;
    tree.children.resize(merges_);
    tree.cost.resize(merges_);
    for (const Slot& s : slots_) {
      if (!s.hasVanished()) continue;
      tree.children[s.degree] = {std::min(s.first, s.node), std::max(s.first, s.node)};
      tree.cost[s.degree] = std::bit_cast<float>(s.mark);
    }
    return tree;
  }

  static std::vector<Slot> makeSlots(const std::vector<std::uint32_t>& first, const MomentsOf& moments_of) {
    std::vector<Slot> slots(first.size());
    for (std::uint32_t i = 0; i < slots.size(); ++i) {
      static_cast<ClusterMoments&>(slots[i]) = moments_of(i);
      slots[i].node = i;
      slots[i].first = first[i];
      slots[i].mark = kNoIndex;
    }
    return slots;
  }

  static bool isHub(const Slot& s) { return s.degree > kHubDegree; }

  double costOf(const DualEdge& e) const { return joinCost(slots_[e.face[0]], slots_[e.face[1]], e.length, weights_); }

  // Calls body(id, edge, other end) for the dual edges of `slot` and takes contracted ones out of its list. The body
  // may contract the edge that it is given.
  template <typename Body>
  void forEachEdge(std::uint32_t slot, const Body& body) {
    for (std::uint32_t* link = &slots_[slot].first; *link != kNoIndex;) {
      const std::uint32_t id = *link;
      DualEdge& e = edges_[id];
      const int side = e.sideOf(slot);
      if (e.length == kContracted) {
        *link = e.next[side];
        continue;
      }
      body(id, e, e.face[1 - side]);
      link = &e.next[side];
    }
  }

  void removeEdge(std::uint32_t id) {
    edges_[id].length = kContracted;
    for (const std::uint32_t slot : edges_[id].face)
      if (--slots_[slot].degree == kHubDegree) former_hubs_.push_back(slot);
  }

  // Contracts a dual edge: the cluster with fewer neighbours goes into the other one.
  void contract(std::uint32_t id) {
    const auto cost = std::bit_cast<std::uint32_t>(edges_[id].cost);
    auto [a, b] = edges_[id].face;
    if (slots_[a].degree < slots_[b].degree || (slots_[a].degree == slots_[b].degree && a > b)) std::swap(a, b);
    const double border = edges_[id].length;
    queue_.pop();
    removeEdge(id);
    joinParallelEdges(a, b);
    moveEdges(b, a);
    Slot &kept = slots_[a], &gone = slots_[b];
    static_cast<ClusterMoments&>(kept) = joined(kept, gone, border);
    gone.corners = -1.0;
    gone.first = std::exchange(gone.node, kept.node);
    gone.degree = merges_;
    gone.mark = cost;
    kept.node = own_ + merges_++;
    evaluateAround(a);
    for (const std::uint32_t slot : former_hubs_)
      if (slot != a && !slots_[slot].hasVanished()) evaluateAround(slot);
    former_hubs_.clear();
  }

  // Where both have an edge to the same neighbour, that of `a` takes up the length of the other one.
  void joinParallelEdges(std::uint32_t a, std::uint32_t b) {
    const auto join = [&](std::uint32_t kept, std::uint32_t gone) {
      edges_[kept].length += edges_[gone].length;
      removeEdge(gone);
    };
    if (isHub(slots_[a])) {
      forEachEdge(b, [&](std::uint32_t id, const DualEdge&, std::uint32_t neighbour) {
        if (const std::uint32_t other = findEdge(a, neighbour); other != kNoIndex) join(other, id);
      });
      return;
    }
    forEachEdge(b, [&](std::uint32_t id, const DualEdge&, std::uint32_t neighbour) { slots_[neighbour].mark = id; });
    forEachEdge(a, [&](std::uint32_t id, const DualEdge&, std::uint32_t neighbour) {
      if (const std::uint32_t other = slots_[neighbour].mark; other != kNoIndex) {
        slots_[neighbour].mark = kNoIndex;
        join(id, other);
      }
    });
    forEachEdge(b, [&](std::uint32_t, const DualEdge&, std::uint32_t neighbour) { slots_[neighbour].mark = kNoIndex; });
  }

  // The edge between two clusters, or kNoIndex. It is looked for in the shorter list and moved to the head of it: two
  // hubs with many neighbours in common are asked for again and again.
  std::uint32_t findEdge(std::uint32_t a, std::uint32_t b) {
    if (slots_[b].degree < slots_[a].degree) std::swap(a, b);
    std::uint32_t* const head = &slots_[a].first;
    for (std::uint32_t* link = head; *link != kNoIndex;) {
      const std::uint32_t id = *link;
      DualEdge& e = edges_[id];
      const int side = e.sideOf(a);
      if (e.length == kContracted) {
        *link = e.next[side];
      } else if (e.face[1 - side] == b) {
        *link = e.next[side];
        e.next[side] = *head;  // if it was the head already, the line above has moved that on
        *head = id;
        return id;
      } else {
        link = &e.next[side];
      }
    }
    return kNoIndex;
  }

  void moveEdges(std::uint32_t from, std::uint32_t to) {
    for (std::uint32_t id = slots_[from].first; id != kNoIndex;) {
      DualEdge& e = edges_[id];
      const int side = e.sideOf(from);
      const std::uint32_t following = e.next[side];
      if (e.length != kContracted) {
        e.face[side] = to;
        e.next[side] = std::exchange(slots_[to].first, id);
        ++slots_[to].degree;
      }
      id = following;
    }
  }

  // A hub waits until it has grown enough.
  void evaluateAround(std::uint32_t slot) {
    const Slot& s = slots_[slot];
    if (isHub(s)) {
      double& corners_then = evaluated_[slot];
      if (s.corners < 1.125 * corners_then) return;
      corners_then = s.corners;
    }
    forEachEdge(slot, [&](std::uint32_t id, const DualEdge& e, std::uint32_t) { queue_.update(id, costOf(e)); });
  }

  const CostWeights weights_;
  const std::uint32_t own_;
  std::vector<DualEdge> edges_;
  std::vector<Slot> slots_;
  MergeQueue queue_;
  std::vector<bool> waits_;                              // clusters whose next merge cannot be made here
  std::unordered_map<std::uint32_t, double> evaluated_;  // corners of a hub when its edges were last evaluated
  std::vector<std::uint32_t> former_hubs_;               // in this merge
  std::uint32_t merges_ = 0;
};

}  // namespace

MergeTree contract(DualGraph graph, const MomentsOf& moments_of, const CostWeights& weights) {
  const auto count = static_cast<std::uint32_t>(graph.first.size());
  Contraction contraction(std::move(graph), count, moments_of, weights);
  contraction.run(count);
  return contraction.takeTree();
}

ContractedPart contractPart(DualGraph graph, std::uint32_t own, std::uint32_t least, const MomentsOf& moments_of,
                            const CostWeights& weights) {
  Contraction contraction(std::move(graph), own, moments_of, weights);
  contraction.run(own - std::min(own, least));
  return contraction.takePart();
}

}  // namespace sheaf::grouping
