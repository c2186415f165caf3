// What a hierarchy of face clusters is good for, of balls of 5,804 to 871,414 faces by one thread: rays and closest
// points, each over a fixed row of them, one ball against another that it just touches, and saving and loading. Beside
// our rays those of Embree: the same rays and faces, single precision, a hierarchy made for rays.
#include <benchmark/benchmark.h>

#include <random>
#include <stdexcept>

#include "grouping/cluster_queries.h"
#include "grouping/clusters_file.h"
#include "tests/embree_scene.h"
#include "tests/grouping/shapes.h"

namespace sheaf::grouping {
namespace {

constexpr int kQueries = 1000;

struct Ball {
  mesh::Mesh mesh;
  FaceClusters clusters;

  explicit Ball(std::int64_t faces) {
    std::mt19937 rng(0xba11);
    const auto rings = static_cast<std::uint32_t>(std::sqrt(double(faces) / 2.8));
    mesh = lumpyBall(rng, rings, static_cast<std::uint32_t>(faces / 2) / rings, 0.2F / float(rings));
    TaskPool pool(1);
    clusters = clusterFaces(mesh, {}, pool);
  }
};

std::vector<DVec3> pointsAround() {
  std::mt19937 rng(0x9e51);
  std::uniform_real_distribution<double> unit(-2.0, 2.0);
  std::vector<DVec3> points;
  for (int i = 0; i < kQueries; ++i) {
    const double x = unit(rng), y = unit(rng), z = unit(rng);
    points.emplace_back(x, y, z);
  }
  return points;
}

void setRate(benchmark::State& state, double count) {
  state.counters["per_second"] = benchmark::Counter(count, benchmark::Counter::kIsIterationInvariantRate);
}

/// hits(origin, direction) says whether there is one.
template <typename Hits>
void castAll(benchmark::State& state, const Hits& hits) {
  const std::vector<DVec3> points = pointsAround();
  int count = 0;
  for (auto _ : state) {
    count = 0;
    for (int i = 0; i < kQueries; ++i) {
      const DVec3& origin = points[i];
      count += hits(origin, 0.5 * points[(i + 1) % kQueries] - origin);
    }
  }
  if (count < kQueries / 4) throw std::runtime_error("the rays miss the ball");
  state.counters["hits"] = count;
  setRate(state, kQueries);
}

void rays(benchmark::State& state) {
  const Ball ball(state.range(0));
  castAll(state, [&](const DVec3& origin, const DVec3& direction) {
    return closestHit(ball.mesh, ball.clusters, {.origin = origin, .direction = direction}).has_value();
  });
}

void embreeRays(benchmark::State& state, bool robust) {
  EmbreeScene embree;
  if (robust) embree.makeRobust();
  embree.add(0, Ball(state.range(0)).mesh);
  embree.commit();
  castAll(state, [&](const DVec3& origin, const DVec3& direction) { return bool(embree.cast(origin, direction)); });
}

void closestPoints(benchmark::State& state) {
  const Ball ball(state.range(0));
  const std::vector<DVec3> points = pointsAround();
  double sum = 0.0;
  for (auto _ : state) {
    sum = 0.0;
    for (const DVec3& p : points) sum += closestPoint(ball.mesh, ball.clusters, p)->distance;
  }
  state.counters["mean_distance"] = sum / kQueries;
  setRate(state, kQueries);
}

void touching(benchmark::State& state) {
  const Ball ball(state.range(0));
  DMat4 beside(1.0);
  beside[3] = DVec4(2.3, 0.0, 0.0, 1.0);
  std::size_t pairs = 0;
  for (auto _ : state) pairs = overlappingFaces({ball.mesh, ball.clusters}, {ball.mesh, ball.clusters}, beside).size();
  state.counters["pairs"] = static_cast<double>(pairs);
}

void saving(benchmark::State& state) {
  const Ball ball(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(encodeClusters(ball.clusters, ball.mesh));
  setRate(state, ball.clusters.faceCount());
}

void loading(benchmark::State& state) {
  const Ball ball(state.range(0));
  const std::string bytes = encodeClusters(ball.clusters, ball.mesh);
  for (auto _ : state) benchmark::DoNotOptimize(decodeClusters(bytes, ball.mesh, "x"));
  state.counters["bytes_per_face"] = static_cast<double>(bytes.size()) / ball.clusters.faceCount();
  setRate(state, ball.clusters.faceCount());
}

void sizes(benchmark::internal::Benchmark* b) {
  b->ArgName("n");
  for (const std::int64_t n : {5804, 69451, 871414}) b->Arg(n);
  b->Unit(benchmark::kMillisecond);
}

BENCHMARK(rays)->Name("grouping/cluster_queries/rays")->Apply(sizes);
BENCHMARK_CAPTURE(embreeRays, robust, true)->Name("grouping/cluster_queries/rays_by_embree/robust")->Apply(sizes);
BENCHMARK_CAPTURE(embreeRays, fast, false)->Name("grouping/cluster_queries/rays_by_embree/fast")->Apply(sizes);
BENCHMARK(closestPoints)->Name("grouping/cluster_queries/closest_points")->Apply(sizes);
BENCHMARK(touching)->Name("grouping/cluster_queries/overlap")->Apply(sizes);
BENCHMARK(saving)->Name("grouping/clusters_file/save")->Apply(sizes);
BENCHMARK(loading)->Name("grouping/clusters_file/load")->Apply(sizes);

}  // namespace
}  // namespace sheaf::grouping
