// Face clustering by one thread and by two, from 5,804 faces (as many as the cow has) to 4 million.
// Counters: peak memory beside the input, and what the hierarchy is like, so that a faster run cannot hide a worse one.
#include <benchmark/benchmark.h>

#include <map>
#include <random>
#include <stdexcept>

#include "bench/grouping/peak_memory.h"
#include "grouping/face_clusters.h"
#include "tests/grouping/shapes.h"

namespace sheaf::grouping {
namespace {

// About this many faces of a lumpy, slightly noisy ball.
const mesh::Mesh& ball(std::int64_t faces) {
  static std::map<std::int64_t, mesh::Mesh> made;
  const auto [entry, is_new] = made.try_emplace(faces);
  if (is_new) {
    std::mt19937 rng(0xba11);
    const auto rings = static_cast<std::uint32_t>(std::sqrt(double(faces) / 2.8));
    entry->second = lumpyBall(rng, rings, static_cast<std::uint32_t>(faces / 2) / rings, 0.2F / float(rings));
  }
  return entry->second;
}

double meanDepth(const FaceClusters& clusters) {
  std::vector<std::uint32_t> depth(clusters.nodeCount(), 0);
  double sum = 0.0;
  for (std::uint32_t node = clusters.nodeCount(); node-- > 0;) {
    if (clusters.parent[node] != kNoIndex) depth[node] = depth[clusters.parent[node]] + 1;
    if (clusters.isFace(node)) sum += depth[node];
  }
  return sum / clusters.faceCount();
}

void clusterMesh(benchmark::State& state, const mesh::Mesh& mesh) {
  TaskPool pool(static_cast<int>(state.range(1)));
  FaceClusters clusters;
  std::size_t peak = 0;
  for (auto _ : state) {
    clusters = {};
    bench::resetPeakMemory();
    clusters = clusterFaces(mesh, {}, pool);
    peak = bench::peakMemory();
  }
  const double faces = clusters.faceCount();
  state.counters["faces"] = faces;
  state.counters["mean_depth"] = meanDepth(clusters);
  state.counters["shapes"] = static_cast<double>(clusters.shapes.size());
  state.counters["peak_bytes_per_face"] = static_cast<double>(peak) / faces;
  state.counters["faces_per_second"] = benchmark::Counter(faces, benchmark::Counter::kIsIterationInvariantRate);
}

void cluster(benchmark::State& state) {
  clusterMesh(state, ball(state.range(0)));
}

// Costs rise steadily outwards, so that parts wait for each other: the worst case of contraction in parts.
void clusterBowl(benchmark::State& state) {
  clusterMesh(state, bowl(static_cast<std::uint32_t>(std::sqrt(double(state.range(0)) / 2.0))));
}

void sizes(benchmark::internal::Benchmark* b) {
  b->ArgNames({"n", "threads"});
  for (const std::int64_t threads : {1, 2})
    for (const std::int64_t n : {5804, 20000, 69451, 250000, 871414, 4000000}) b->Args({n, threads});
  b->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(cluster)->Name("grouping/cluster")->Apply(sizes);
BENCHMARK(clusterBowl)->Name("grouping/cluster_bowl")->Apply(sizes);

}  // namespace
}  // namespace sheaf::grouping
