// cli/compare_limits: how far apart pictures may be, as the options of compare say.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/values.h"
#include "raster/image_compare.h"

namespace CLI {
class App;
}

namespace sheaf::cli {

/// The options as they were written; absent ones are empty.
struct LimitArguments {
  std::optional<std::string> max_differing;
  std::optional<std::string> max_error;
  std::optional<std::string> min_psnr;
};

/// What pictures have to keep to; a limit that is not set does not count.
struct Limits {
  std::optional<PixelLimit> differing;
  std::optional<double> max_error;
  std::optional<double> min_psnr_db;

  bool none() const { return !differing && !max_error && !min_psnr_db; }
};

void addLimitOptions(CLI::App& command, LimitArguments& arguments);

/// Throws Error(kUsage) that names the option and the reason.
Limits understandLimits(const LimitArguments& arguments);

/// The options whose limit is passed.
std::vector<std::string> beyond(const Limits& limits, const raster::ImageDifference& difference);

}  // namespace sheaf::cli
