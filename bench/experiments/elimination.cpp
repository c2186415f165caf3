// How many vertices grouping eliminates: [PG] Table 1, Figure 7, the averages in its text, other planes, other
// searches.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>

#include "bench/experiments/chart.h"
#include "bench/experiments/experiment.h"
#include "bench/experiments/table.h"
#include "core/stage_timer.h"
#include "grouping/linear_groups.h"
#include "grouping/optimal_groups.h"
#include "grouping/planar_groups.h"

namespace sheaf::experiments {
namespace {

using grouping::GroupingStats;
using grouping::TableKey;
using grouping::VertexGroups;

VertexGroups planar(const mesh::Mesh& mesh, TableKey key = TableKey::kUnion) {
  grouping::PlanarOptions options;
  options.key = key;
  return grouping::groupPlanar(mesh, options);
}

double planarShare(const mesh::Mesh& mesh, std::vector<grouping::PlaneFrame> planes) {
  grouping::PlanarOptions options;
  options.key = TableKey::kUnion;
  options.planes = std::move(planes);
  return grouping::groupPlanar(mesh, options).stats.eliminated;
}

double linearShare(const mesh::Mesh& mesh, bool segment_only, std::uint8_t dimensions = 3) {
  grouping::LinearOptions options;
  options.segment_only = segment_only;
  options.dimensions = dimensions;
  return grouping::groupLinear(mesh, options).stats.eliminated;
}

mesh::Mesh flattened(mesh::Mesh mesh) {
  for (Vec3& p : mesh.positions) p.z = 0.0F;
  return mesh;
}

/// Any two retained vertices that were processed differ by more than epsilon along the shortest edge of the box too.
double guaranteedShare(const mesh::Mesh& mesh, double vertices) {
  const Vec3 size = mesh::boundsOf(mesh).size();
  const double shortest = std::min({size.x, size.y, size.z}) / (0.005 * std::max({size.x, size.y, size.z}));
  return 1.0 - (std::floor(shortest) + 1.0) / vertices;
}

struct Lod {
  const char* model;
  std::size_t vertices;
  double expected;  ///< percent, by an independent program with a simplifier of its own
};

constexpr std::array<Lod, 10> kReferenceLods = {{{"cow", 150, 83.3},
                                                 {"cow", 300, 89.0},
                                                 {"cow", 600, 93.8},
                                                 {"cow", 1000, 96.0},
                                                 {"cow", 2000, 97.9},
                                                 {"bunny", 300, 84.0},
                                                 {"bunny", 600, 89.7},
                                                 {"bunny", 1000, 93.7},
                                                 {"bunny", 1500, 95.1},
                                                 {"bunny", 3000, 97.4}}};
constexpr double kReferenceTolerance = 1.5;       // points
constexpr std::size_t kFewestForReference = 300;  // with fewer vertices chance decides, see writeTable1()

struct Spread {
  double least = 1.0;
  double most = 0.0;
};

/// The share eliminated with the vertices numbered at random, a hundred times: what the order of equal keys matters.
Spread spreadOver(const mesh::Mesh& mesh) {
  std::mt19937 rng(0x7ab1e);
  std::vector<std::uint32_t> number(mesh.vertexCount());
  std::iota(number.begin(), number.end(), 0U);
  Spread spread;
  for (int i = 0; i < 100; ++i) {
    for (std::size_t k = number.size(); k > 1; --k) std::swap(number[k - 1], number[rng() % k]);
    mesh::Mesh renumbered = mesh;
    for (std::size_t v = 0; v < number.size(); ++v) renumbered.positions[number[v]] = mesh.positions[v];
    for (mesh::Triangle& t : renumbered.triangles)
      for (std::uint32_t& v : t) v = number[v];
    const double share = planar(renumbered).stats.eliminated;
    spread.least = std::min(spread.least, share);
    spread.most = std::max(spread.most, share);
  }
  return spread;
}

/// Throws if a share is not what the independent program found.
std::string checkReference(Context& context) {
  Table table({"model", "vertices", "independent program %", "ours %", "ours, renumbered %"});
  double largest = 0.0;
  for (const Lod& lod : kReferenceLods) {
    const mesh::Mesh& mesh = context.models.lod(lod.model, lod.vertices);
    const double share = planar(mesh).stats.eliminated;
    const Spread spread = spreadOver(mesh);
    if (lod.vertices >= kFewestForReference) largest = std::max(largest, std::abs(100.0 * share - lod.expected));
    table.add({lod.model, fmt::format("{}", lod.vertices), fmt::format("{:.1f}", lod.expected), percent(share),
               fmt::format("{} to {}", percent(spread.least), percent(spread.most))});
  }
  if (largest > kReferenceTolerance)
    throw std::runtime_error(fmt::format("elimination is {:.2f} points off the independent program's, {} are allowed",
                                         largest, kReferenceTolerance));
  return fmt::format(
             "The same algorithm by an independent program (numpy, a simplifier of its own) on the same two models. "
             "From "
             "{} vertices on the largest difference is {:.1f} points; {} are allowed. With fewer vertices chance "
             "decides: "
             "numbering them differently, which settles ties in the table, moves the share as the last column says (a "
             "hundred random orders). At 150 vertices, where one vertex is 0.7 points, the cow is beyond that.\n\n",
             kFewestForReference, largest, kReferenceTolerance) +
         table.text();
}

}  // namespace

std::string writeModels(Context& context) {
  Table table({"model", "vertices", "triangles", "box"});
  for (const char* name : {"cow", "bunny", "dragon", "armadillo", "jet"}) {
    const mesh::Mesh& mesh = context.models.whole(name);
    const Vec3 size = mesh::boundsOf(mesh).size() / mesh::boundsOf(mesh).longestEdge();
    table.add({name, fmt::format("{}", mesh.vertexCount()), fmt::format("{}", mesh.triangleCount()),
               fmt::format("{:.2f} x {:.2f} x {:.2f}", size.x, size.y, size.z)});
  }
  return "As `scripts/models` fetches them, vertices that no triangle uses left out; boxes in units of their longest "
         "edge. [PG] does not say where its models came from or how they were simplified; ours are simplified by "
         "`sheaf simplify --vertices N`. Epsilon is a fraction of the box's longest edge: [PG] says \"of the object "
         "coordinate space\", and of the readings tried this one comes closest to its Table 1.\n\n" +
         table.text();
}

std::string writeTable1(Context& context) {
  struct Row {
    const char* model;
    std::size_t vertices;
    double paper_percent, paper_ms;
  };
  constexpr std::array<Row, 4> kRows = {
      {{"dragon", 600, 95.4, 30}, {"bunny", 3000, 97.5, 317}, {"cow", 1000, 96.4, 60}, {"jet", 300, 89.0, 10}}};
  Table table({"model", "vertices", "eliminated, [PG] %", "ours %", "groups", "displacement mean %", "max %",
               "[PG] ms (800 MHz)", "ours ms"});
  double sum = 0.0;
  for (const Row& row : kRows) {
    const mesh::Mesh& mesh = context.models.lod(row.model, row.vertices);
    const VertexGroups groups = planar(mesh);
    const double ms = medianMs(15, [&] { planar(mesh); });
    sum += groups.stats.eliminated;
    table.add({row.model, fmt::format("{}", groups.stats.vertices), fmt::format("{:.1f}", row.paper_percent),
               percent(groups.stats.eliminated), fmt::format("{}", groups.groups.size()),
               percent(groups.stats.displacement_mean, 2), percent(groups.stats.displacement_max, 2),
               fmt::format("{:.0f}", row.paper_ms), rounded(ms)});
  }
  return "Planar groups, three axis planes, distance metric, epsilon 0.5 %.\n\n" + table.text() +
         fmt::format(
             "The mean of ours is {} %, of [PG]'s four {:.1f} %. The cow and the bunny reproduce. The dragon depends "
             "on "
             "what 600 vertices are: [PG]'s 95.4 % is no multiple of 1/600, so that its counts are rounded, and its "
             "dragon was another one. The jet is another aircraft (an F-16 of many flat pieces; [PG]'s is not "
             "published). Times are of the whole call, statistics included.\n\n",
             percent(sum / 4.0), (95.4 + 97.5 + 96.4 + 89.0) / 4.0) +
         checkReference(context);
}

std::string writeFigure7(Context& context) {
  constexpr std::array<std::size_t, 10> kCounts = {50, 100, 150, 300, 600, 1000, 1500, 2000, 2900, 5000};
  Chart chart{.title = "Vertices eliminated (%), planar, epsilon 0.5 %",
              .x = {"vertices", true, {50, 100, 200, 500, 1000, 2000, 5000, 10000, 40000}},
              .y = {"eliminated %", false, {50, 55, 60, 65, 70, 75, 80, 85, 90, 95, 100}},
              .series = {}};
  Table table({"vertices", "cow %", "bunny %", "dragon %", "armadillo %"});
  std::vector<std::vector<std::string>> cells;
  for (const std::size_t count : kCounts) cells.push_back({fmt::format("{}", count)});
  for (const std::string name : {"cow", "bunny", "dragon", "armadillo"}) {
    ChartSeries series{name, {}};
    for (std::size_t i = 0; i < kCounts.size(); ++i) {
      const mesh::Mesh& mesh = context.models.lod(name, kCounts[i]);
      if (mesh.vertexCount() != kCounts[i]) {  // the model has fewer, or its topology needs more
        cells[i].emplace_back();
        continue;
      }
      const GroupingStats stats = planar(mesh).stats;
      series.points.push_back({double(stats.vertices), 100.0 * stats.eliminated});
      cells[i].push_back(percent(stats.eliminated));
    }
    chart.series.push_back(series);
  }
  for (const auto& row : cells) table.add(row);
  for (const std::string name : {"cow", "bunny"}) {
    ChartSeries bound{"bound, " + name, {}, true, true};
    for (double n = 50.0; n < 40000.0; n *= 1.1)
      bound.points.push_back({n, 100.0 * guaranteedShare(context.models.whole(name), n)});
    chart.series.push_back(bound);
  }
  chart.series.push_back({"[PG] Table 1", {{600, 95.4}, {3000, 97.5}, {1000, 96.4}, {300, 89.0}}, false});
  return showChart(context, "figure7.svg", svgOf(chart),
                   "Dashed: what is eliminated at least. Retained vertices are more than epsilon apart in every "
                   "coordinate, so there are at most as many as epsilons in the shortest edge of the box, and one.") +
         table.text() +
         "As in [PG] the cow lies above the bunny, both rise with the number of vertices, and shapes differ little at "
         "equal counts. The bound says why: the number of retained vertices hardly depends on n, and the cow's box is "
         "the flatter one.\n\n";
}

std::string writeAverages(Context& context) {
  Table table({"model", "vertices", "planar %", "linear %", "linear, segments %", "2D linear %", "2D, segments %"});
  std::array<double, 5> sums{};
  int rows = 0;
  for (const auto& [name, counts] : std::vector<std::pair<std::string, std::vector<std::size_t>>>{
           {"cow", {150, 300, 600, 1000}}, {"bunny", {150, 300, 600, 1000}}, {"dragon", {600}}, {"jet", {300}}})
    for (const std::size_t count : counts) {
      const mesh::Mesh& mesh = context.models.lod(name, count);
      const mesh::Mesh flat = flattened(mesh);
      const std::array<double, 5> shares = {planar(mesh).stats.eliminated, linearShare(mesh, false),
                                            linearShare(mesh, true), linearShare(flat, false, 2),
                                            linearShare(flat, true, 2)};
      std::vector<std::string> cells = {name, fmt::format("{}", mesh.vertexCount())};
      for (std::size_t i = 0; i < shares.size(); ++i) {
        sums[i] += shares[i];
        cells.push_back(percent(shares[i]));
      }
      table.add(cells);
      ++rows;
    }
  std::vector<std::string> mean = {"mean", ""}, paper = {"[PG]", "", "93", "55", "", "76", ""};
  for (const double sum : sums) mean.push_back(percent(sum / rows));
  table.add(mean);
  table.add(paper);
  return "Epsilon 0.5 %, distance metric. Two dimensions: the same models with z dropped. Segments: no member beyond "
         "the "
         "two vertices that define the line, so that those two alone bound the group.\n\n" +
         table.text() +
         "[PG]'s averages are over a set that it does not name. Its 55 % for lines is what models of about 300 "
         "vertices "
         "have; with more vertices more of them lie near a line. Its 93 % for planes is the average of models between "
         "600 and 1000 vertices, not that of its Table 1 (94.6 %). [PG] tests only the segment between the defining "
         "vertices when it clips, which is right for segments alone; in three dimensions they eliminate a few points "
         "less. sheaf "
         "keeps "
         "the range of the parameter, which is right for both.\n\n";
}

std::string writePlanes(Context& context) {
  Table table({"model", "vertices", "3 axis planes %", "6 dodecahedron planes %", "both, 9 planes %"});
  for (const Lod& lod : kReferenceLods) {
    const mesh::Mesh& mesh = context.models.lod(lod.model, lod.vertices);
    table.add({lod.model, fmt::format("{}", lod.vertices), percent(planarShare(mesh, grouping::axisPlanes())),
               percent(planarShare(mesh, grouping::dodecahedronPlanes())),
               percent(planarShare(mesh, grouping::axisAndDodecahedronPlanes()))});
  }
  return table.text() +
         "[PG] 6: planes that are not aligned with the axes, among them those of a dodecahedron, eliminate \"very few "
         "additional vertices\" and have no tangible benefit. True of 1000 vertices and more. Up to 600 they eliminate "
         "a few points more; six planes cost twelve transformed vectors a frame in place of none, since the images of "
         "the axes are the columns of the matrix.\n\n";
}

std::string writeSearch(Context& context) {
  Table table({"model", "vertices", "sorted once %", "dynamic %", "best found %", "at most %", "sorted once ms",
               "dynamic ms", "better search s"});
  double largest = 0.0;
  for (const auto& [name, count] : std::vector<std::pair<std::string, std::size_t>>{
           {"cow", 150}, {"cow", 300}, {"cow", 600}, {"bunny", 300}, {"bunny", 600}, {"bunny", 1500}}) {
    const mesh::Mesh& mesh = context.models.lod(name, count);
    grouping::OptimalGroups found;
    const double n = static_cast<double>(mesh.vertexCount());
    const std::int64_t begin_ns = nowNs();
    found = grouping::groupOptimally(mesh, {});
    const double seconds = 1e-9 * static_cast<double>(nowNs() - begin_ns);
    const auto share = [&](std::uint32_t retained) { return 1.0 - retained / n; };
    largest = std::max(largest, share(found.best) - share(found.greedy));
    table.add({name, fmt::format("{}", count), percent(share(found.greedy)), percent(share(found.dynamic)),
               percent(share(found.best)) + (found.isOptimal() ? " (proved)" : ""), percent(share(found.at_least)),
               rounded(medianMs(15, [&] { planar(mesh); })),
               rounded(medianMs(15, [&] { planar(mesh, TableKey::kDynamic); })), rounded(seconds)});
  }
  return "Any grouping is a set of vertices that has every other vertex within epsilon of one of them along some axis: "
         "a "
         "dominating set of a graph. The better search improves the dynamic greedy one by weighted local search "
         "[Gao15] and proves what it can by branch and bound.\n\n" +
         table.text() +
         fmt::format(
             "[PG] 6 found branch and bound to bring \"little or no benefit\" and to be much slower. It brings up "
             "to {} points of elimination on small models, which is up to {:.1f} points of transform time; it is "
             "slower by more than four orders of magnitude. Re-sorting the table (dynamic) brings a part of it at "
             "a few times the greedy search's cost.\n\n",
             percent(largest), 70.0 * largest);
}

}  // namespace sheaf::experiments
