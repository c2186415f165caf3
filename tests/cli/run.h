// Runs the built command and catches what it says.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/temp_folder.h"

namespace sheaf::cli {

struct RunResult {
  int code = -1;  ///< exit code; 128 + signal when it was killed by one
  std::string out;
  std::string err;
};

struct RunSettings {
  std::vector<std::pair<std::string, std::string>> environment;  ///< added to ours
  std::size_t max_memory = 0;                                    ///< address space in bytes, 0 = as much as there is
  std::string out_path;                                          ///< where stdout goes instead of RunResult::out
  bool err_is_terminal = false;                                  ///< stderr is a (pseudo) terminal
  std::optional<int> signal = std::nullopt;                      ///< sent again and again until the program ends
};

/// Runs `sheaf` with `arguments` in `folder`.
RunResult runSheaf(const TempFolder& folder, const std::vector<std::string>& arguments,
                   const RunSettings& settings = {});

/// Exactly one line, which starts with "sheaf: ".
bool isOneErrorLine(const std::string& err);

}  // namespace sheaf::cli
