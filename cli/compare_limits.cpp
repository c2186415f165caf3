#include "cli/compare_limits.h"

#include <CLI/CLI.hpp>

namespace sheaf::cli {

void addLimitOptions(CLI::App& command, LimitArguments& a) {
  command.add_option("--max-differing", a.max_differing, "So many pixels may differ")->type_name("N|P%");
  command.add_option("--max-error", a.max_error, "So far may a channel be off, 0 to 255")->type_name("E");
  command.add_option("--min-psnr", a.min_psnr, "The peak signal-to-noise ratio must be at least this")->type_name("DB");
}

Limits understandLimits(const LimitArguments& arguments) {
  Limits limits;
  if (arguments.max_differing) limits.differing = parsePixelLimit("--max-differing", *arguments.max_differing);
  if (arguments.max_error) limits.max_error = parseNumber("--max-error", *arguments.max_error, 0.0, 255.0);
  if (arguments.min_psnr) limits.min_psnr_db = parseNumber("--min-psnr", *arguments.min_psnr, 0.0, 1000.0);
  return limits;
}

std::vector<std::string> beyond(const Limits& limits, const raster::ImageDifference& difference) {
  std::vector<std::string> options;
  if (limits.differing) {
    const double found = limits.differing->percent ? 100.0 * difference.differingFraction()
                                                   : static_cast<double>(difference.differing_pixels);
    if (found > limits.differing->value) options.emplace_back("--max-differing");
  }
  if (limits.max_error && difference.max_error > *limits.max_error) options.emplace_back("--max-error");
  if (limits.min_psnr_db && difference.psnr_db < *limits.min_psnr_db) options.emplace_back("--min-psnr");
  return options;
}

}  // namespace sheaf::cli
