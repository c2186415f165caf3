// cli/group_options: what `sheaf group` was asked to do.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "cli/grouping_options.h"
#include "cli/names.h"
#include "grouping/linear_groups.h"
#include "grouping/patch_groups.h"
#include "grouping/planar_groups.h"

namespace CLI {
class App;
}

namespace sheaf::cli {

enum class GroupMethod { kLinear, kPlanar, kCluster };
inline constexpr Names<GroupMethod, 3> kMethodNames = {
    {{"linear", GroupMethod::kLinear}, {"planar", GroupMethod::kPlanar}, {"cluster", GroupMethod::kCluster}}};
inline constexpr Names<grouping::TableKey, 4> kKeyNames = {{{"auto", grouping::TableKey::kAuto},
                                                            {"union", grouping::TableKey::kUnion},
                                                            {"sum", grouping::TableKey::kSum},
                                                            {"dynamic", grouping::TableKey::kDynamic}}};

/// The options as they were written; absent ones are empty.
struct GroupArguments {
  using Text = std::optional<std::string>;
  std::string input;
  Text method;
  MetricArguments metric;
  Text epsilon;
  Text planes;
  Text key;
  bool segment_only = false;
  bool no_flips = false;
  Text output;
  Text bits;
  Text snapped;
  bool json = false;
  bool quiet = false;
};

/// The same, understood and checked. Of `planar`, `linear` and `cluster` the one counts that `method` says.
struct GroupRequest {
  std::string input;
  GroupMethod method = GroupMethod::kPlanar;
  grouping::PlanarOptions planar;
  grouping::LinearOptions linear;
  grouping::PatchGroupOptions cluster;
  std::string plane_set;   ///< for the report: "3 axis planes"
  std::string plane_file;  ///< from which planar.planes are to be read
  std::string output;
  int saved_bits = 0;  ///< of each saved parameter; 0 = exact
  std::string snapped;
  bool json = false;
  bool quiet = false;
};

void addGroupOptions(CLI::App& command, const std::shared_ptr<GroupArguments>& arguments);

/// Throws Error(kUsage) that names the option and the reason.
GroupRequest understand(const GroupArguments& arguments);

}  // namespace sheaf::cli
