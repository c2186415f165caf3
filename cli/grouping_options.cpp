#include "cli/grouping_options.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cli/values.h"

namespace sheaf::cli {

namespace {

void understandForm(const GroupingArguments& arguments, const UsualGrouping& usual,
                    pipeline::GroupingOptions& options) {
  options.form = choose("--parameters", arguments.parameters.value_or("16bit"), kParameterNames);
  options.prefer = arguments.prefer ? choose("--prefer", *arguments.prefer, kPreferNames) : usual.prefer;
}

std::string savedText(pipeline::Grouping method) {
  switch (method) {
    case pipeline::Grouping::kLinear:
      return "saved groups on lines";
    case pipeline::Grouping::kPlanar:
      return "saved groups on planes across an axis";
    default:
      return "saved groups on planes across any direction";
  }
}

}  // namespace

std::array<CLI::Option*, 2> addMetricOptions(CLI::App& command, MetricArguments& a) {
  return {command
              .add_option("--metric", a.metric,
                          "What epsilon holds: how far a vertex moves, or the error of its\nquadric (default distance)")
              ->type_name("distance|quadric"),
          command
              .add_option("--limit", a.limit,
                          "Of the quadric metric: so that no face can fold over, or as\npublished (default safe)")
              ->type_name("safe|paper")};
}

MetricChoice understandMetric(const MetricArguments& arguments) {
  const MetricChoice choice{choose("--metric", arguments.metric.value_or("distance"), kMetricNames),
                            choose("--limit", arguments.limit.value_or("safe"), kLimitNames)};
  if (arguments.limit && choice.metric == grouping::Metric::kDistance)
    throw Error(ErrorCode::kUsage, "--limit is for the quadric metric: by distance no vertex moves beyond epsilon");
  return choice;
}

void addGroupingOptions(CLI::App& command, GroupingArguments& a, const UsualGrouping& usual) {
  const auto add = [&](const char* name, auto& value, const std::string& meaning, const char* type) {
    command.add_option(name, value, meaning)->type_name(type)->group("Groups");
  };
  const bool may_be_none = usual.method == pipeline::Grouping::kNone;
  add("--grouping", a.grouping,
      may_be_none ? "Move vertices onto common lines or planes, by up to epsilon, and\ntransform them together: lossy "
                    "(default none)"
                  : "Lines through two vertices, planes across an axis, or planes of\npatches that are made of face "
                    "clusters (default planar)",
      may_be_none ? "none|linear|planar|cluster" : "linear|planar|cluster");
  for (CLI::Option* option : addMetricOptions(command, a.metric)) option->group("Groups");
  add("--epsilon", a.epsilon, "0.5% or 0.005 of the longest edge of each mesh's box (default 0.5%)", "E");
  add("--parameters", a.parameters, "How parameters on lines and planes are stored (default 16bit)", "16bit|float");
  add("--prefer", a.prefer,
      fmt::format("Draw by planes where that is faster (of planar groups: in meshes of\n900,000 vertices and more), or "
                  "wherever it saves memory\n(default {})",
                  nameOf(usual.prefer, kPreferNames)),
      "speed|memory");
}

void addSavedGroupsOption(CLI::App& command, GroupingArguments& a) {
  command.add_option("--from", a.from, "Take the groups from a file that sheaf group -o has saved of the same mesh")
      ->type_name("FILE.sheaf")
      ->group("Groups");
}

pipeline::GroupingOptions understandGrouping(const GroupingArguments& arguments, const UsualGrouping& usual) {
  pipeline::GroupingOptions options;
  if (arguments.from) {
    if (arguments.from->empty()) throw Error(ErrorCode::kUsage, "--from: the name of the file is empty");
    for (const auto& [given, option] : {std::pair{arguments.grouping.has_value(), "--grouping"},
                                        {arguments.metric.metric.has_value(), "--metric"},
                                        {arguments.metric.limit.has_value(), "--limit"},
                                        {arguments.epsilon.has_value(), "--epsilon"}})
      if (given)
        throw Error(ErrorCode::kUsage, fmt::format("{} decides how groups are found, and --from takes groups that "
                                                   "have been found",
                                                   option));
    understandForm(arguments, usual, options);
    return options;
  }
  options.method = arguments.grouping ? choose("--grouping", *arguments.grouping, kGroupingNames) : usual.method;
  if (options.method == pipeline::Grouping::kNone) {
    if (usual.method != pipeline::Grouping::kNone)
      throw Error(ErrorCode::kUsage, "--grouping none: without groups there is nothing to compare");
    for (const auto& [given, option] : {std::pair{arguments.metric.metric.has_value(), "--metric"},
                                        {arguments.metric.limit.has_value(), "--limit"},
                                        {arguments.epsilon.has_value(), "--epsilon"},
                                        {arguments.parameters.has_value(), "--parameters"},
                                        {arguments.prefer.has_value(), "--prefer"}})
      if (given) throw Error(ErrorCode::kUsage, fmt::format("{} is for grouped drawing: add --grouping", option));
    return options;
  }
  const MetricChoice choice = understandMetric(arguments.metric);
  options.metric = choice.metric;
  options.limit = choice.limit;
  options.epsilon = parseFraction("--epsilon", arguments.epsilon.value_or("0.5%"));
  understandForm(arguments, usual, options);
  return options;
}

std::string groupingText(const pipeline::GroupingOptions& options) {
  std::string text = fmt::format(
      "{}, {} metric",
      options.saved ? savedText(options.method) : fmt::format("{} groups", nameOf(options.method, kGroupingNames)),
      nameOf(options.metric, kMetricNames));
  if (options.metric == grouping::Metric::kQuadric)
    text += fmt::format(" with {} limit", nameOf(options.limit, kLimitNames));
  return text +
         fmt::format(", epsilon {:.4g} %, {} parameters", 100.0 * options.epsilon,
                     options.form == pipeline::ParameterForm::k16Bit ? "16-bit" : "float") +
         (options.prefer == pipeline::Prefer::kMemory ? ", to save memory" : "");
}

std::string drawnByGroupsText(double share, const pipeline::GroupingOptions& options) {
  if (share > 0.0) return fmt::format("{:.1f} % of the patch vertices", 100.0 * share);
  const bool chosen = options.method != pipeline::Grouping::kLinear && options.prefer == pipeline::Prefer::kSpeed;
  return chosen ? "no vertex, in full is faster here; --prefer memory draws by groups"
                : "no vertex, no group has enough of a patch";
}

nlohmann::ordered_json groupingJson(const pipeline::GroupingOptions& options) {
  nlohmann::ordered_json json = {{"method", nameOf(options.method, kGroupingNames)},
                                 {"saved", options.saved != nullptr},
                                 {"metric", nameOf(options.metric, kMetricNames)},
                                 {"limit", nullptr},
                                 {"epsilon", options.epsilon},
                                 {"parameters", nameOf(options.form, kParameterNames)},
                                 {"prefer", nameOf(options.prefer, kPreferNames)}};
  if (options.metric == grouping::Metric::kQuadric) json["limit"] = nameOf(options.limit, kLimitNames);
  return json;
}

}  // namespace sheaf::cli
