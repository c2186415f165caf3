// cli/group_options: what `sheaf group` was asked to do.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "cli/grouping_options.h"
#include "cli/names.h"
#include "grouping/linear_groups.h"
#include "grouping/planar_groups.h"

namespace CLI {
class App;
}

namespace sheaf::cli {

inline constexpr Names<grouping::GroupKind, 2> kMethodNames = {
    {{"linear", grouping::GroupKind::kLine}, {"planar", grouping::GroupKind::kPlane}}};
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

/// The same, understood and checked. Of `planar` and `linear` the one counts that `kind` says.
struct GroupRequest {
  std::string input;
  grouping::GroupKind kind = grouping::GroupKind::kPlane;
  grouping::PlanarOptions planar;
  grouping::LinearOptions linear;
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
