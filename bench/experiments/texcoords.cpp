// Groups for texture coordinates: [PG] 6.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bench/experiments/experiment.h"
#include "bench/experiments/rounds.h"
#include "bench/experiments/scalar_mesh.h"
#include "bench/experiments/table.h"
#include "bench/experiments/texcoord_kernels.h"
#include "grouping/linear_groups.h"
#include "grouping/planar_groups.h"

namespace sheaf::experiments {
namespace {

constexpr const char* kTexcoordVerdict =
    "Without vectors groups pay: 1.4 to 1.5 times as fast by a matrix, 1.3 to 1.4 times for generated "
    "coordinates. With vectors they pay only where groups are long against a vector: on the whole bunny and the "
    "dragon, 1.4 times. In short groups the start of the loop and its last, partly filled vector cost more than "
    "the whole computation: a third to three quarters of the speed.\n\n";

using grouping::VertexGroups;

/// Structure of arrays.
struct Columns {
  std::vector<float> x, y, z;

  explicit Columns(const std::vector<Float3>& points) {
    for (const Float3& p : points) x.push_back(p.x), y.push_back(p.y), z.push_back(p.z);
  }
};

struct Texcoords {
  std::vector<float> u, v;

  explicit Texcoords(std::size_t count) : u(count), v(count) {}
  TexcoordsOut out() { return {u.data(), v.data()}; }
};

void checkEqual(const Texcoords& full, const Texcoords& grouped) {
  for (std::size_t i = 0; i < full.u.size(); ++i)
    if (!(std::abs(full.u[i] - grouped.u[i]) < 1e-4F && std::abs(full.v[i] - grouped.v[i]) < 1e-4F))
      throw std::runtime_error(fmt::format("texture coordinate {} is wrong", i));
}

void addRow(Table& table, const std::string& name, const VertexGroups& groups, const std::vector<Spread>& times,
            std::size_t vertices) {
  const double n = static_cast<double>(vertices);
  const auto cell = [&](const Spread& s) {
    return fmt::format("{:.3f} [{:.3f}, {:.3f}]", s.median / n, s.lower / n, s.upper / n);
  };
  table.add({name, percent(groups.stats.eliminated),
             fmt::format("{:.1f}", groups.stats.grouped / static_cast<double>(groups.groups.size())), cell(times[0]),
             cell(times[1]), fmt::format("{:.2f}", times[0].median / times[1].median)});
}

// Both ways are compared after they have been timed.
std::vector<Spread> timeBoth(const std::function<void()>& full, const std::function<void()>& grouped,
                             std::size_t vertices) {
  const int calls = std::max(3, static_cast<int>(100'000 / vertices));
  return timeInTurns({full, grouped}, 51, calls, calls);
}

void addTransform(Table& table, const std::string& name, const VertexGroups& groups, const TexcoordKernels& kernels) {
  constexpr TextureMatrix kMatrix = {1.9F, -0.4F, 0.25F, 0.3F, 2.1F, -0.5F};
  const Columns all(ungroupedArrays(groups).retained3);
  const ScalarArrays arrays = groupedArrays(groups);
  const Columns retained(arrays.retained3);
  const auto count = static_cast<std::uint32_t>(all.x.size()), kept = static_cast<std::uint32_t>(retained.x.size());
  Texcoords full(count), grouped(count);
  const std::vector<Spread> times =
      timeBoth([&] { kernels.transform(all.x.data(), all.y.data(), count, kMatrix, full.out()); },
               [&] {
                 kernels.transform(retained.x.data(), retained.y.data(), kept, kMatrix, grouped.out());
                 kernels.transformLines(arrays.lines.data(), static_cast<std::uint32_t>(arrays.lines.size()),
                                        arrays.line_parameters.data(), kept, grouped.out());
               },
               count);
  checkEqual(full, grouped);
  addRow(table, name, groups, times, count);
}

void addGeneration(Table& table, const std::string& name, const VertexGroups& groups, const TexcoordKernels& kernels) {
  const auto scale = static_cast<float>(1.0 / groups.extent);
  const TextureRows rows = {scale, 0.3F * scale, -0.2F * scale, 0.1F, -0.1F * scale, 0.4F * scale, scale, 0.2F};
  const Columns all(ungroupedArrays(groups).retained3);
  const ScalarArrays arrays = groupedArrays(groups);
  const Columns retained(arrays.retained3);
  std::vector<float> s, t;
  for (const Float2& p : arrays.plane_parameters) s.push_back(p.s), t.push_back(p.t);
  const auto count = static_cast<std::uint32_t>(all.x.size()), kept = static_cast<std::uint32_t>(retained.x.size());
  Texcoords full(count), grouped(count);
  const std::vector<Spread> times = timeBoth(
      [&] {
        kernels.generate({all.x.data(), all.y.data(), all.z.data()}, count, rows, full.out());
      },
      [&] {
        kernels.generate({retained.x.data(), retained.y.data(), retained.z.data()}, kept, rows, grouped.out());
        kernels.generatePlanes(arrays.planes.data(), static_cast<std::uint32_t>(arrays.planes.size()), s.data(),
                               t.data(), kept, rows, grouped.out());
      },
      count);
  checkEqual(full, grouped);
  addRow(table, name, groups, times, count);
}

/// A square grid of texture coordinates, as of a height field: the best that lines can find.
mesh::Mesh gridOfTexcoords(int side) {
  mesh::Mesh mesh;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      mesh.positions.emplace_back(static_cast<float>(x) / float(side - 1), static_cast<float>(y) / float(side - 1),
                                  0.0F);
  return mesh;
}

}  // namespace

std::string writeTexcoordTransforms(Context& context) {
  const std::vector<std::string> head = {"what",        "eliminated %", "members per group",
                                         "in full, ns", "grouped, ns",  "times as fast"};
  grouping::LinearOptions flat;
  flat.dimensions = 2;
  const VertexGroups lantern = grouping::groupLinear(grouping::texcoordMesh(context.models.whole("lantern")), flat);
  const VertexGroups grid = grouping::groupLinear(gridOfTexcoords(50), flat);
  struct Model {
    std::string name;
    VertexGroups groups;
  };
  std::vector<Model> models;
  for (const auto& [name, count] :
       std::vector<std::pair<std::string, std::size_t>>{{"cow", 1000}, {"bunny", 3000}, {"bunny", 0}, {"dragon", 0}}) {
    const mesh::Mesh& mesh = count == 0 ? context.models.whole(name) : context.models.lod(name, count);
    models.push_back({fmt::format("{}, {}", name, mesh.vertexCount()), grouping::groupPlanar(mesh, {})});
  }
  Table transformed(head), generated(head);
  const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
  for (const bool vectorised : {false, true}) {
    if (vectorised && !has_avx2) continue;
    const TexcoordKernels& kernels = vectorised ? vectors::kTexcoords : plain::kTexcoords;
    const std::string suffix = vectorised ? ", AVX2" : ", scalar";
    addTransform(transformed, fmt::format("lantern, {}{}", lantern.positions.size(), suffix), lantern, kernels);
    addTransform(transformed, fmt::format("grid of 50 x 50{}", suffix), grid, kernels);
    for (const Model& model : models) addGeneration(generated, model.name + suffix, model.groups, kernels);
  }
  return fmt::format(
             "Times per vertex, medians and quartiles of 51 rounds in turns; results are checked against the full "
             "computation. Machine: {}. sheaf itself applies a texture matrix to each shaded pixel and never to "
             "vertices, so its frames gain nothing here.\n\n"
             "**An affine texture matrix**: in full 4 multiplications and 4 additions, on a line 2 and 2; linear "
             "groups in "
             "two dimensions, epsilon 0.5 %.\n\n",
             machineText()) +
         transformed.text() +
         "**Generated from positions** by two rows of a matrix: in full 6 and 6, on a plane 4 and 4; the planar groups "
         "of the positions serve again.\n\n" +
         generated.text() + kTexcoordVerdict;
}

}  // namespace sheaf::experiments
