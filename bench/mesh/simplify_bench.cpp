// Preparation of a generated surface: normals, welding, simplification, and meshoptimizer's simplifier beside it. Rates
// are of the input's triangles. Each simplification is checked after it was timed: rms_ppm is the RMS distance between
// input and result in millionths of the longest edge, so that "faster" cannot hide "worse".
#include <benchmark/benchmark.h>
#include <meshoptimizer.h>

#include <cmath>

#include "mesh/distance.h"
#include "mesh/normals.h"
#include "mesh/simplify.h"
#include "mesh/weld.h"

namespace sheaf::mesh {
namespace {

// A torus with bumps at several scales, 2 n^2 triangles, closed.
Mesh makeBumpyTorus(std::uint32_t n) {
  Mesh m;
  for (std::uint32_t r = 0; r < n; ++r)
    for (std::uint32_t s = 0; s < n; ++s) {
      const double a = 2.0 * kPi * r / n, b = 2.0 * kPi * s / n;
      double tube = 0.4;
      for (const int k : {3, 7, 17, 41}) tube += 0.08 / k * std::sin(k * a + std::cos(k * b));
      const double radius = 1.0 + tube * std::cos(b);
      m.positions.emplace_back(radius * std::cos(a), radius * std::sin(a), tube * std::sin(b));
      const auto at = [n](std::uint32_t i, std::uint32_t k) { return i % n * n + k % n; };
      m.triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
      m.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    }
  return m;
}

void report(benchmark::State& state, const Mesh& input, const Mesh* result = nullptr) {
  state.counters["triangles_per_s"] =
      benchmark::Counter(static_cast<double>(input.triangleCount() * state.iterations()), benchmark::Counter::kIsRate);
  if (result == nullptr) return;
  TaskPool pool(1);
  const double unit = boundsOf(input).longestEdge();
  state.counters["triangles_out"] = static_cast<double>(result->triangleCount());
  state.counters["rms_ppm"] = 1e6 * distanceBetween(input, *result, 100'000, pool).rms() / unit;
}

std::size_t targetOf(const benchmark::State& state, const Mesh& input) {
  return input.triangleCount() * static_cast<std::size_t>(state.range(1)) / 100;
}

void simplifyPositions(benchmark::State& state) {
  const Mesh input = makeBumpyTorus(static_cast<std::uint32_t>(state.range(0)));
  SimplifyOptions options;
  options.target_triangles = targetOf(state, input);
  SimplifyResult result;
  for (auto _ : state) result = simplify(input, options);
  report(state, input, &result.mesh);
}

void simplifyNormals(benchmark::State& state) {
  Mesh input = makeBumpyTorus(static_cast<std::uint32_t>(state.range(0)));
  makeSmoothNormals(input, kPi);
  SimplifyOptions options;
  options.target_triangles = targetOf(state, input);
  options.attributes = true;
  SimplifyResult result;
  for (auto _ : state) result = simplify(input, options);
  report(state, input, &result.mesh);
}

void simplifyPeer(benchmark::State& state) {
  const Mesh input = makeBumpyTorus(static_cast<std::uint32_t>(state.range(0)));
  Mesh result = input;
  for (auto _ : state) {
    result.triangles.resize(input.triangleCount());
    const std::size_t indices = meshopt_simplify(&result.triangles[0][0], &input.triangles[0][0],
                                                 3 * input.triangleCount(), &input.positions[0].x, input.vertexCount(),
                                                 sizeof(Vec3), 3 * targetOf(state, input), 1.0F, 0, nullptr);
    result.triangles.resize(indices / 3);
  }
  report(state, input, &result);
}

void smoothNormals(benchmark::State& state) {
  const Mesh input = makeBumpyTorus(static_cast<std::uint32_t>(state.range(0)));
  const double crease = radians(static_cast<double>(state.range(1)));
  Mesh m = input;
  for (auto _ : state) {
    state.PauseTiming();
    m = input;
    state.ResumeTiming();
    makeSmoothNormals(m, crease);
  }
  report(state, input);
}

void weldSoup(benchmark::State& state) {
  Mesh input = makeBumpyTorus(static_cast<std::uint32_t>(state.range(0)));
  makeFlatNormals(input);
  input.normals.clear();
  Mesh m;
  for (auto _ : state) {
    state.PauseTiming();
    m = input;
    state.ResumeTiming();
    weldVertices(m);
  }
  report(state, input);
}

// n: 2 n^2 triangles; percent: of them, left in the end.
BENCHMARK(simplifyPositions)
    ->Name("mesh/simplify/positions")
    ->ArgNames({"n", "percent"})
    ->ArgsProduct({{100, 300, 700}, {50, 10, 1}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(simplifyNormals)
    ->Name("mesh/simplify/normals")
    ->ArgNames({"n", "percent"})
    ->ArgsProduct({{100, 300}, {50, 10}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(simplifyPeer)
    ->Name("mesh/simplify/meshoptimizer")
    ->ArgNames({"n", "percent"})
    ->ArgsProduct({{100, 300, 700}, {50, 10, 1}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(smoothNormals)
    ->Name("mesh/normals/smooth")
    ->ArgNames({"n", "crease_deg"})
    ->ArgsProduct({{100, 700}, {180, 60}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(weldSoup)->Name("mesh/weld/soup")->ArgNames({"n"})->Args({100})->Args({700})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sheaf::mesh
