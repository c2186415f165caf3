// Vertex groups by one thread: planar from 3 thousand to 4 million vertices, linear at 3000, what stands beside them.
// Counters: share eliminated, peak memory beside the input, so that a faster run cannot hide a worse result.
#include <benchmark/benchmark.h>

#include <map>
#include <random>
#include <stdexcept>

#include "bench/grouping/peak_memory.h"
#include "grouping/compression.h"
#include "grouping/groups_file.h"
#include "grouping/linear_groups.h"
#include "grouping/naive_groups.h"
#include "grouping/planar_groups.h"
#include "grouping/update_groups.h"
#include "tests/grouping/shapes.h"

namespace sheaf::grouping {
namespace {

// About this many vertices of a lumpy, slightly noisy ball.
const mesh::Mesh& ball(std::int64_t vertices) {
  static std::map<std::int64_t, mesh::Mesh> made;
  const auto [entry, is_new] = made.try_emplace(vertices);
  if (is_new) {
    std::mt19937 rng(0xba11);
    const auto rings = static_cast<std::uint32_t>(std::sqrt(double(vertices) / 1.4));
    entry->second = lumpyBall(rng, rings, static_cast<std::uint32_t>(vertices) / rings, 0.2F / float(rings));
  }
  return entry->second;
}

template <class Group>
void run(benchmark::State& state, const mesh::Mesh& mesh, const Group& group) {
  VertexGroups groups;
  std::size_t peak = 0;
  for (auto _ : state) {
    groups = {};
    bench::resetPeakMemory();
    groups = group(mesh);
    peak = bench::peakMemory();
  }
  if (const std::string reason = findInconsistency(groups); !reason.empty()) throw std::logic_error(reason);
  const double n = groups.stats.vertices;
  state.counters["vertices"] = n;
  state.counters["eliminated_percent"] = 100.0 * groups.stats.eliminated;
  state.counters["peak_bytes_per_vertex"] = double(peak) / n;
  state.counters["vertices_per_second"] = benchmark::Counter(n, benchmark::Counter::kIsIterationInvariantRate);
  state.SetComplexityN(static_cast<std::int64_t>(n));
}

void planar(benchmark::State& state, Metric metric, TableKey key) {
  PlanarOptions options;
  options.metric = metric;
  options.key = key;
  run(state, ball(state.range(0)), [&](const mesh::Mesh& mesh) { return groupPlanar(mesh, options); });
}

void planarNaive(benchmark::State& state) {
  run(state, ball(state.range(0)), [](const mesh::Mesh& mesh) { return naiveGroupPlanar(mesh, {}); });
}

void linear(benchmark::State& state, Metric metric, int dimensions) {
  mesh::Mesh mesh = ball(state.range(0));
  if (dimensions == 2)
    for (Vec3& p : mesh.positions) p.z = 0.0F;
  LinearOptions options;
  options.metric = metric;
  options.dimensions = static_cast<std::uint8_t>(dimensions);
  run(state, mesh, [&](const mesh::Mesh& m) { return groupLinear(m, options); });
}

void linearNaive(benchmark::State& state) {
  run(state, ball(state.range(0)), [](const mesh::Mesh& mesh) { return naiveGroupLinear(mesh, {}); });
}

// A thousandth of the vertices moves a little.
void update(benchmark::State& state) {
  mesh::Mesh mesh = ball(state.range(0));
  VertexGroups groups = groupPlanar(mesh, {});
  std::vector<std::uint32_t> moved;
  for (std::uint32_t v = 500; v < mesh.vertexCount(); v += 1000) moved.push_back(v);
  float step = 0.003F;
  for (auto _ : state) {
    for (const std::uint32_t v : moved) mesh.positions[v].x += step;
    step = -step;
    benchmark::DoNotOptimize(updateGroups(mesh, moved, groups));
  }
  state.counters["moved"] = double(moved.size());
}

void saveAndLoad(benchmark::State& state, int bits) {
  const VertexGroups groups = groupPlanar(ball(state.range(0)), {});
  GroupsFileOptions options;
  options.parameter_bits = bits;
  std::size_t bytes = 0;
  for (auto _ : state) {
    const std::string file = encodeGroups(groups, options);
    bytes = file.size();
    benchmark::DoNotOptimize(decodeGroups(file, "memory"));
  }
  state.counters["bits_per_vertex"] = 8.0 * double(bytes) / groups.stats.vertices;
}

// No time of interest: the bits per vertex are the result.
void compression(benchmark::State& state) {
  const mesh::Mesh& mesh = ball(state.range(0));
  const VertexGroups groups = groupPlanar(mesh, {});
  CompressionFigures figures;
  for (auto _ : state) figures = measureCompression(mesh, groups, 14);
  state.counters["plain"] = figures.plain;
  state.counters["quantised"] = figures.plain_quantised;
  state.counters["codec"] = figures.coded;
  state.counters["groups"] = figures.grouped();
  state.counters["groups_codec"] = figures.grouped_coded;
  state.counters["order"] = figures.grouped_order;
}

template <std::int64_t kVertices>
void one(benchmark::internal::Benchmark* b) {
  b->ArgName("n")->Arg(kVertices)->Unit(benchmark::kMillisecond);
}

void sizes(benchmark::internal::Benchmark* b) {
  b->ArgName("n");
  for (const std::int64_t n : {3000, 12000, 36000, 108000, 437000, 1300000, 4000000}) b->Arg(n);
  b->Unit(benchmark::kMillisecond);
}

BENCHMARK_CAPTURE(planar, distance, Metric::kDistance, TableKey::kAuto)
    ->Name("grouping/planar/distance")
    ->Apply(sizes)
    ->Complexity(benchmark::oNLogN);
BENCHMARK_CAPTURE(planar, quadric, Metric::kQuadric, TableKey::kAuto)
    ->Name("grouping/planar/quadric")
    ->Apply(sizes)
    ->Complexity(benchmark::oNLogN);
BENCHMARK_CAPTURE(planar, sum, Metric::kDistance, TableKey::kSum)->Name("grouping/planar/sum")->Apply(one<3000>);
BENCHMARK_CAPTURE(planar, dynamic, Metric::kDistance, TableKey::kDynamic)
    ->Name("grouping/planar/dynamic")
    ->Apply(one<3000>);
BENCHMARK(planarNaive)->Name("grouping/planar/naive")->Apply(one<3000>);
BENCHMARK_CAPTURE(linear, distance, Metric::kDistance, 3)->Name("grouping/linear/distance")->Apply(one<300>);
BENCHMARK_CAPTURE(linear, distance3000, Metric::kDistance, 3)->Name("grouping/linear/distance")->Apply(one<3000>);
BENCHMARK_CAPTURE(linear, quadric, Metric::kQuadric, 3)->Name("grouping/linear/quadric")->Apply(one<3000>);
BENCHMARK_CAPTURE(linear, flat, Metric::kDistance, 2)->Name("grouping/linear/flat")->Apply(one<3000>);
BENCHMARK(linearNaive)->Name("grouping/linear/naive")->Apply(one<300>);
BENCHMARK(update)->Name("grouping/update")->Apply(one<36000>);
BENCHMARK_CAPTURE(saveAndLoad, exact, 0)->Name("grouping/saveAndLoad/exact")->Apply(one<36000>);
BENCHMARK_CAPTURE(saveAndLoad, quantised, 14)->Name("grouping/saveAndLoad/quantised")->Apply(one<36000>);
BENCHMARK(compression)->Name("grouping/compression")->Apply(one<36000>);

}  // namespace
}  // namespace sheaf::grouping
