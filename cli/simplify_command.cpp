#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/output.h"
#include "cli/saved_file.h"
#include "cli/values.h"
#include "core/error.h"
#include "core/stage_timer.h"
#include "mesh/distance.h"
#include "mesh/simplify.h"
#include "scenes/join.h"
#include "scenes/ply_writer.h"
#include "scenes/scene.h"

namespace sheaf::cli {
namespace {

constexpr std::size_t kDistanceSamples = 100'000;

constexpr const char* kFooter =
    "Writes a binary PLY. A file or scene of several meshes becomes one: every instance where it stands, vertices "
    "that\n"
    "are equal in everything joined; materials and textures are not kept. Without --attributes only positions are.\n"
    "With them, vertices are counted as positions: one on a seam is written once for each side.\n"
    "\n"
    "Examples:\n"
    "  sheaf simplify bunny.ply --vertices 3000 -o bunny3000.ply\n"
    "  sheaf simplify model.glb --faces 20000 --attributes -o model.ply --json\n"
    "\n";

struct SimplifyArguments {
  std::string input;
  std::optional<std::string> output;
  std::optional<std::string> vertices;
  std::optional<std::string> faces;
  bool attributes = false;
  bool json = false;
  bool quiet = false;
};

struct SimplifyRequest {
  std::string input;
  std::string output;
  mesh::SimplifyOptions options;
  bool json = false;
  bool quiet = false;
};

[[noreturn]] void refuse(const std::string& reason) {
  throw Error(ErrorCode::kUsage, reason);
}

SimplifyRequest understand(const SimplifyArguments& arguments) {
  constexpr std::int64_t kMost = std::numeric_limits<std::uint32_t>::max();
  SimplifyRequest request;
  request.input = arguments.input;
  if (!arguments.output) refuse("-o FILE.ply is missing");
  request.output = *arguments.output;
  if (!request.output.ends_with(".ply"))
    refuse(fmt::format("-o {}: expected a name that ends in .ply", request.output));
  if (arguments.vertices.has_value() == arguments.faces.has_value())
    refuse(arguments.vertices ? "--vertices and --faces: give one of them"
                              : "--vertices N or --faces N is missing: how small shall it become?");
  const auto count = [&](std::string_view option, const std::string& text) {
    return static_cast<std::size_t>(parseWhole(option, text, 1, kMost));
  };
  if (arguments.vertices) request.options.target_vertices = count("--vertices", *arguments.vertices);
  if (arguments.faces) request.options.target_triangles = count("--faces", *arguments.faces);
  request.options.attributes = arguments.attributes;
  request.json = arguments.json;
  request.quiet = arguments.quiet;
  return request;
}

/// Vertices in use, at whatever number of places.
std::size_t usedVertices(const mesh::Mesh& mesh) {
  std::vector<bool> used(mesh.vertexCount(), false);
  for (const mesh::Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) used[v] = true;
  return static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
}

struct SimplifyReport {
  std::string name;
  std::size_t vertices_before = 0;
  std::size_t triangles_before = 0;
  const mesh::SimplifyResult& result;
  mesh::SurfaceDistance distance;  ///< fractions of the extent: forward from the input to the result
  double ms = 0.0;
  std::vector<std::string> warnings;
};

mesh::DistanceStats scaled(mesh::DistanceStats stats, double factor) {
  stats.max *= factor;
  stats.mean *= factor;
  stats.rms *= factor;
  return stats;
}

mesh::SurfaceDistance relativeDistance(const mesh::Mesh& before, const mesh::Mesh& after) {
  TaskPool pool;
  const double extent = mesh::boundsOf(before).longestEdge();
  const mesh::SurfaceDistance d = mesh::distanceBetween(before, after, kDistanceSamples, pool);
  const double factor = extent > 0.0 ? 1.0 / extent : 0.0;
  return {scaled(d.forward, factor), scaled(d.backward, factor)};
}

std::string simplifyText(const SimplifyReport& report) {
  const mesh::Mesh& after = report.result.mesh;
  const auto line = [](std::string_view head, const std::string& text) {
    return fmt::format("{:<12}{}\n", head, text);
  };
  std::string text = line("mesh", report.name);
  text += line("vertices", fmt::format("{} joined vertices in use to {}", report.vertices_before, after.vertexCount()) +
                               (report.result.positions != after.vertexCount()
                                    ? fmt::format(" at {} places", report.result.positions)
                                    : ""));
  text += line("triangles", fmt::format("{} to {}", report.triangles_before, after.triangleCount()));
  text += line("distance", fmt::format("max {:.4f} %, RMS {:.4f} % of the extent", 100.0 * report.distance.hausdorff(),
                                       100.0 * report.distance.rms()));
  return text + line("time", fmt::format("{:.1f} ms", report.ms));
}

std::string simplifyJson(const SimplifyReport& report) {
  using Json = nlohmann::ordered_json;
  const auto stats = [](const mesh::DistanceStats& s) {
    return Json{{"max", s.max}, {"mean", s.mean}, {"rms", s.rms}};
  };
  const mesh::SimplifyResult& result = report.result;
  const Json json = {
      {"name", report.name},
      {"vertices_before", report.vertices_before},
      {"triangles_before", report.triangles_before},
      {"dropped_triangles", result.dropped_triangles},
      {"vertices", result.mesh.vertexCount()},
      {"positions", result.positions},
      {"triangles", result.mesh.triangleCount()},
      {"target_reached", result.stop == mesh::SimplifyStop::kTargetReached},
      {"distance_fraction",
       {{"to_result", stats(report.distance.forward)}, {"from_result", stats(report.distance.backward)}}},
      {"simplify_ms", report.ms},
      {"warnings", report.warnings}};
  // Names come from files and need not be UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

int runSimplify(const SimplifyRequest& request) {
  const bool is_file = !request.input.starts_with("builtin:");
  checkOutputs({{"-o", request.output}}, is_file ? std::vector{request.input} : std::vector<std::string>{});
  refuseAsScene(request.input);
  scenes::ImportOptions import;
  import.for_drawing = false;
  const scenes::Scene scene = scenes::loadScene(request.input, import);
  const mesh::Mesh mesh = scenes::joinedMesh(scene);
  if (mesh.triangles.empty())
    throw Error(ErrorCode::kBadInput, fmt::format("{}: has no triangles to simplify", request.input));

  const std::int64_t begin_ns = nowNs();
  const mesh::SimplifyResult result = mesh::simplify(mesh, request.options);
  const double ms = 1e-6 * static_cast<double>(nowNs() - begin_ns);
  SimplifyReport report{.name = scene.name,
                        .vertices_before = usedVertices(mesh),
                        .triangles_before = mesh.triangleCount(),
                        .result = result,
                        .distance = relativeDistance(mesh, result.mesh),
                        .ms = ms,
                        .warnings = scene.warnings};
  if (result.dropped_triangles > 0)
    report.warnings.push_back(fmt::format("{}: {} triangles left out: they repeat another or have no area",
                                          request.input, result.dropped_triangles));
  if (result.stop == mesh::SimplifyStop::kTopology)
    report.warnings.push_back(fmt::format(
        "{}: the target was not reached: anything further would tear the surface or fold it over", request.input));
  if (!request.quiet && !request.json) printWarnings(report.warnings);
  scenes::writePly(request.output, result.mesh);
  writeStdout(request.json ? simplifyJson(report) : simplifyText(report));
  return 0;
}

}  // namespace

void addSimplifyCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("simplify", "Make a mesh of fewer triangles for nearly the same surface");
  const auto arguments = std::make_shared<SimplifyArguments>();
  command->add_option("INPUT", arguments->input, "A mesh file or builtin:NAME")->required();
  command->add_option("-o,--output", arguments->output, "A PLY file")->type_name("FILE.ply");
  command->add_option("--vertices", arguments->vertices, "Stop at so many vertices")->type_name("N");
  command->add_option("--faces", arguments->faces, "Stop at so many triangles")->type_name("N");
  command->add_flag("--attributes", arguments->attributes,
                    "Keep normals, texture coordinates and colours, and let them count in the error");
  command->add_flag("--json", arguments->json, "Report as JSON, warnings included");
  command->add_flag("-q,--quiet", arguments->quiet, "No warnings on stderr");
  command->footer(std::string(kFooter) + kExitCodes);
  command->callback([arguments, &run] { run = [arguments] { return runSimplify(understand(*arguments)); }; });
}

}  // namespace sheaf::cli
