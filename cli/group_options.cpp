#include "cli/group_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "cli/commands.h"
#include "cli/values.h"
#include "core/error.h"

namespace sheaf::cli {
namespace {

using grouping::Limit;
using grouping::Metric;

constexpr int kMaxSavedBits = 16;

constexpr const char* kFooter =
    "A file or scene of several meshes is grouped as one: every instance where it stands, vertices that are equal in\n"
    "everything joined. Lengths are fractions of the longest edge of the mesh's box. Lines and planes across given\n"
    "directions are those of Dinerstein et al., Planar Grouping for Fast Affine Transformation and Clipping. By "
    "cluster\n"
    "each patch of up to 256 vertices has planes that follow it; vertices where patches meet stay where they are.\n"
    "\n"
    "Linear grouping looks at every pair of vertices: 3000 take a second or so, larger meshes are cut into cells of\n"
    "3000. Ctrl-C ends it and leaves no files.\n"
    "\n"
    "A plane file has a normal, three numbers, on each line; # begins a comment.\n"
    "\n"
    "Examples:\n"
    "  sheaf group cow.off\n"
    "  sheaf group bunny.ply --metric quadric --epsilon 1% -o bunny.sheaf --snapped snapped.ply\n"
    "  sheaf render bunny.ply --from bunny.sheaf --color-by group -o groups.png\n"
    "  sheaf group cow.off --method linear --segment-only --json\n"
    "  sheaf group builtin:teapot --planes dodecahedron --key dynamic\n"
    "\n";

[[noreturn]] void refuse(const std::string& reason) {
  throw Error(ErrorCode::kUsage, reason);
}

/// What only one method or metric knows.
void refuseMismatches(const GroupArguments& arguments, GroupMethod method, const MetricChoice& choice) {
  if (method == GroupMethod::kLinear) {
    if (arguments.planes) refuse("--planes is for planar groups: lines go through any two vertices");
    if (arguments.key) refuse("--key is for planar groups: the table of linear ones is sorted once, by its counts");
  } else if (arguments.segment_only) {
    refuse("--segment-only is for linear groups (--method linear)");
  }
  if (method == GroupMethod::kCluster) {
    if (arguments.planes) refuse("--planes is for planar groups: patches of clusters have planes of their own");
    if (arguments.key) refuse("--key is for planar groups: of a patch always that plane is next that takes most");
  }
  if (arguments.no_flips && choice.metric == Metric::kQuadric && choice.limit == Limit::kSafe)
    refuse("--no-flips: the safe limit of the quadric metric lets no face flip anyway");
  if (arguments.bits && !arguments.output) refuse("--bits is about the saved groups: add -o FILE.sheaf");
}

void understandPlanes(const std::string& text, GroupRequest& request) {
  request.plane_set = "3 axis planes";
  if (text == "axis") return;
  if (text == "dodecahedron") {
    request.planar.planes = grouping::dodecahedronPlanes();
    request.plane_set = "6 dodecahedron planes";
  } else if (text == "both") {
    request.planar.planes = grouping::axisAndDodecahedronPlanes();
    request.plane_set = "3 axis and 6 dodecahedron planes";
  } else if (text.empty()) {
    refuse("--planes: expected axis, dodecahedron, both or a file");
  } else {
    request.plane_file = text;
  }
}

std::string outputName(std::string_view option, const std::optional<std::string>& text, std::string_view extension) {
  if (text && !text->ends_with(extension))
    refuse(fmt::format("{} {}: expected a name that ends in {}", option, *text, extension));
  return text.value_or("");
}

void addSearchOptions(CLI::App& command, GroupArguments& a) {
  command
      .add_option("--method", a.method,
                  "Lines through two vertices, planes through one across given\ndirections, or planes of patches that "
                  "are made of face clusters\n(default planar)")
      ->type_name("linear|planar|cluster");
  addMetricOptions(command, a.metric);
  command.add_option("--epsilon", a.epsilon, "0.5% or 0.005 of the longest edge of the box (default 0.5%)")
      ->type_name("E");
  command
      .add_option("--planes", a.planes,
                  "Directions of planar groups: axis, dodecahedron, both, or a file\n(default axis)")
      ->type_name("SET|FILE");
  command
      .add_option("--key", a.key,
                  "How planar groups are ranked: by the vertices that the planes of a\nvertex take (union), counted "
                  "for each plane (sum), or counted anew\n(dynamic). auto: union up to 20000 vertices, then sum")
      ->type_name("auto|union|sum|dynamic");
  command.add_flag("--segment-only", a.segment_only, "Linear groups take no vertex beyond the two that define them");
  command.add_flag("--no-flips", a.no_flips, "Set vertices free again until no face is flipped or collapsed");
}

}  // namespace

void addGroupOptions(CLI::App& command, const std::shared_ptr<GroupArguments>& arguments) {
  GroupArguments& a = *arguments;
  command.add_option("INPUT", a.input, "A mesh file or builtin:NAME")->required();
  addSearchOptions(command, a);
  command
      .add_option("-o,--output", a.output,
                  "Save the groups, as sheaf's own .sheaf file: for info, and for --from of\nrender, compare and bench")
      ->type_name("FILE");
  command.add_option("--bits", a.bits, "Quantise the saved parameters, 1 to 16 bits (default: exact floats)")
      ->type_name("N");
  command.add_option("--snapped", a.snapped, "Write the mesh with its vertices on their lines or planes, as .ply")
      ->type_name("FILE");
  command.add_flag("--json", a.json, "Report as JSON, warnings included");
  command.add_flag("-q,--quiet", a.quiet, "No warnings and no progress on stderr");
  command.footer(std::string(kFooter) + kExitCodes);
}

GroupRequest understand(const GroupArguments& arguments) {
  GroupRequest request;
  request.input = arguments.input;
  request.method = choose("--method", arguments.method.value_or("planar"), kMethodNames);
  const MetricChoice choice = understandMetric(arguments.metric);
  request.planar.key = choose("--key", arguments.key.value_or("auto"), kKeyNames);
  refuseMismatches(arguments, request.method, choice);
  understandPlanes(arguments.planes.value_or("axis"), request);
  if (request.method == GroupMethod::kCluster) request.plane_set = "a frame for each patch";
  const double epsilon = parseFraction("--epsilon", arguments.epsilon.value_or("0.5%"));
  request.planar.metric = request.linear.metric = request.cluster.metric = choice.metric;
  request.planar.limit = request.linear.limit = request.cluster.limit = choice.limit;
  request.planar.epsilon = request.linear.epsilon = request.cluster.epsilon = epsilon;
  request.planar.restore_flipped = request.linear.restore_flipped = request.cluster.restore_flipped =
      arguments.no_flips;
  request.linear.segment_only = arguments.segment_only;
  request.output = outputName("-o", arguments.output, ".sheaf");
  request.snapped = outputName("--snapped", arguments.snapped, ".ply");
  if (arguments.bits) request.saved_bits = static_cast<int>(parseWhole("--bits", *arguments.bits, 1, kMaxSavedBits));
  request.json = arguments.json;
  request.quiet = arguments.quiet;
  return request;
}

}  // namespace sheaf::cli
