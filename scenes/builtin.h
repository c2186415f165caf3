// scenes/builtin: scenes that sheaf generates itself, for pictures, tests and measurements without a file.
#pragma once

#include <string>
#include <vector>

#include "scenes/scene.h"

namespace sheaf::scenes {

struct BuiltinParameter {
  std::string name;
  double default_value = 0.0;
  double min = 0.0;  ///< inclusive
  double max = 0.0;  ///< inclusive
  std::string meaning;
  bool whole = true;                    ///< only whole numbers
  std::vector<std::string> words = {};  ///< names of the values 0, 1, 2 ...; empty for a plain number
};

struct BuiltinInfo {
  std::string name;
  std::string description;  ///< one line
  std::vector<BuiltinParameter> parameters;
};

/// All built-in scenes, in the order in which they are to be listed.
const std::vector<BuiltinInfo>& builtinScenes();

/// Builds the scene of `NAME?key=value&key=value` (what follows `builtin:`). The same text gives the same scene on
/// every machine. Throws Error(kUsage) that lists what exists for an unknown name, parameter or value.
Scene buildBuiltin(const std::string& spec);

}  // namespace sheaf::scenes
