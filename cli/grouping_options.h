// cli/grouping_options: with which vertex groups a scene is drawn: the options that render, compare and bench share.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "cli/names.h"
#include "pipeline/prepare.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace sheaf::cli {

inline constexpr Names<pipeline::Grouping, 4> kGroupingNames = {{{"none", pipeline::Grouping::kNone},
                                                                 {"linear", pipeline::Grouping::kLinear},
                                                                 {"planar", pipeline::Grouping::kPlanar},
                                                                 {"cluster", pipeline::Grouping::kCluster}}};
inline constexpr Names<grouping::Metric, 2> kMetricNames = {
    {{"distance", grouping::Metric::kDistance}, {"quadric", grouping::Metric::kQuadric}}};
inline constexpr Names<grouping::Limit, 2> kLimitNames = {
    {{"safe", grouping::Limit::kSafe}, {"paper", grouping::Limit::kPaper}}};
inline constexpr Names<pipeline::ParameterForm, 2> kParameterNames = {
    {{"16bit", pipeline::ParameterForm::k16Bit}, {"float", pipeline::ParameterForm::kFloat}}};

inline constexpr Names<pipeline::Prefer, 2> kPreferNames = {
    {{"speed", pipeline::Prefer::kSpeed}, {"memory", pipeline::Prefer::kMemory}}};

/// What epsilon holds, as it was written: of every command that groups, `sheaf group` too.
struct MetricArguments {
  std::optional<std::string> metric;
  std::optional<std::string> limit;
};

struct MetricChoice {
  grouping::Metric metric = grouping::Metric::kDistance;
  grouping::Limit limit = grouping::Limit::kSafe;
};

/// --metric and --limit
std::array<CLI::Option*, 2> addMetricOptions(CLI::App& command, MetricArguments& arguments);

/// By distance unless asked otherwise. Throws Error(kUsage) that names the option.
MetricChoice understandMetric(const MetricArguments& arguments);

/// The options as they were written; absent ones are empty.
struct GroupingArguments {
  std::optional<std::string> grouping;
  MetricArguments metric;
  std::optional<std::string> epsilon;
  std::optional<std::string> parameters;
  std::optional<std::string> prefer;
  std::optional<std::string> from;  ///< saved groups, in place of a search
};

/// What counts where nothing is asked for.
struct UsualGrouping {
  pipeline::Grouping method = pipeline::Grouping::kNone;
  pipeline::Prefer prefer = pipeline::Prefer::kSpeed;
};

/// All but --from.
void addGroupingOptions(CLI::App& command, GroupingArguments& arguments, const UsualGrouping& usual);

/// --from, of commands that take nothing but groups from a file.
void addSavedGroupsOption(CLI::App& command, GroupingArguments& arguments);

/// By distance, epsilon 0.5 %, unless asked otherwise. Throws Error(kUsage) that names the option; also for kNone where
/// it is not `usual`: without groups there is nothing to compare. With --from only form and preference are understood:
/// the rest says the file (groupsToDrawWith()).
pipeline::GroupingOptions understandGrouping(const GroupingArguments& arguments, const UsualGrouping& usual);

/// `planar groups, distance metric, epsilon 0.5 %, 16-bit parameters`
std::string groupingText(const pipeline::GroupingOptions& options);

/// `63.1 % of the patch vertices`, or why there are none.
std::string drawnByGroupsText(double share, const pipeline::GroupingOptions& options);

nlohmann::ordered_json groupingJson(const pipeline::GroupingOptions& options);

}  // namespace sheaf::cli
