#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/output.h"
#include "cli/values.h"
#include "core/error.h"
#include "raster/image_compare.h"
#include "raster/image_io.h"

namespace sheaf::cli {
namespace {

using Json = nlohmann::ordered_json;
using raster::ImageDifference;

struct CompareOptions {
  std::string a;
  std::string b;
  std::optional<std::string> heat_map;
  std::optional<std::string> max_differing;
  std::optional<std::string> max_error;
  std::optional<std::string> min_psnr;
  bool json = false;
};

/// What the pictures have to keep to; a limit that is not set does not count.
struct Limits {
  std::optional<PixelLimit> differing;
  std::optional<double> max_error;
  std::optional<double> min_psnr_db;
};

Limits limitsOf(const CompareOptions& options) {
  Limits limits;
  if (options.max_differing) limits.differing = parsePixelLimit("--max-differing", *options.max_differing);
  if (options.max_error) limits.max_error = parseNumber("--max-error", *options.max_error, 0.0, 255.0);
  if (options.min_psnr) limits.min_psnr_db = parseNumber("--min-psnr", *options.min_psnr, 0.0, 1000.0);
  if (!limits.differing && !limits.max_error && !limits.min_psnr_db) limits.differing = PixelLimit{};
  return limits;
}

/// The options whose limit is passed.
std::vector<std::string> beyond(const Limits& limits, const ImageDifference& difference) {
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

std::string reportText(const ImageDifference& d, const std::vector<std::string>& passed) {
  std::string text = fmt::format("differing pixels  {} of {} ({:.4g} %)\n", d.differing_pixels,
                                 static_cast<std::int64_t>(d.width) * d.height, 100.0 * d.differingFraction());
  const auto& e = d.max_error_channel;
  text += fmt::format("max error         {} of 255 (r {}, g {}, b {}, a {})\n", d.max_error, e[0], e[1], e[2], e[3]);
  text += fmt::format("RMS error         {:.4g} of 255\n", d.rms);
  text +=
      std::isinf(d.psnr_db) ? "PSNR              infinite\n" : fmt::format("PSNR              {:.2f} dB\n", d.psnr_db);
  if (d.first) {
    text += fmt::format("first             pixel ({}, {})\n", d.first->x, d.first->y);
    text += fmt::format("within            ({}, {}) to ({}, {})\n", d.box_min.x, d.box_min.y, d.box_max.x - 1,
                        d.box_max.y - 1);
  }
  text += "verdict           ";
  if (passed.empty()) return text + (d.differing_pixels == 0 ? "equal\n" : "within the limits\n");
  text += "beyond";
  for (const std::string& option : passed) text += " " + option;
  return text + "\n";
}

std::string reportJson(const ImageDifference& d, const std::vector<std::string>& passed) {
  Json json = {{"width", d.width},
               {"height", d.height},
               {"equal", d.differing_pixels == 0},
               {"within_limits", passed.empty()},
               {"beyond", passed},
               {"differing_pixels", d.differing_pixels},
               {"differing_fraction", d.differingFraction()},
               {"max_error", d.max_error},
               {"max_error_rgba", d.max_error_channel},
               {"rms", d.rms},
               {"psnr_db", nullptr},
               {"first", nullptr},
               {"box", nullptr}};
  if (!std::isinf(d.psnr_db)) json["psnr_db"] = d.psnr_db;  // JSON knows no infinity: null when equal
  if (d.first) {
    json["first"] = {d.first->x, d.first->y};
    json["box"] = {{"min", {d.box_min.x, d.box_min.y}}, {"max", {d.box_max.x, d.box_max.y}}};
  }
  return json.dump(2) + "\n";
}

void checkHeatMap(const CompareOptions& options) {
  const std::string& path = *options.heat_map;
  if (raster::formatOf(path).linear)
    throw Error(ErrorCode::kUsage, fmt::format("-o {}: a heat map has 8-bit colours; write it as .png", path));
  raster::checkFormatAvailable(path);
  checkOutputs({{"-o", path}}, {options.a, options.b});
}

int runCompare(const CompareOptions& options) {
  const Limits limits = limitsOf(options);
  if (options.heat_map) checkHeatMap(options);
  const Image8 a = raster::readImage(options.a);
  const Image8 b = raster::readImage(options.b);
  if (a.width() != b.width() || a.height() != b.height())
    throw Error(ErrorCode::kBadInput, fmt::format("{}: is {}x{} pixels, {} is {}x{}", options.a, a.width(), a.height(),
                                                  options.b, b.width(), b.height()));
  const ImageDifference difference = raster::compareImages(a, b);
  if (options.heat_map) {
    const Image8 map = raster::heatMap(a, b);
    TaskPool pool;
    raster::writePicture(*options.heat_map, {.srgb = &map}, pool);
  }
  const std::vector<std::string> passed = beyond(limits, difference);
  writeStdout(options.json ? reportJson(difference, passed) : reportText(difference, passed));
  return passed.empty() ? 0 : 1;
}

}  // namespace

void addCompareCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("compare", "Compare two images of the same size");
  const auto options = std::make_shared<CompareOptions>();
  command->add_option("A", options->a, "An image: PNG, JPEG, EXR, TIFF, HDR ...")->required();
  command->add_option("B", options->b, "Another image")->required();
  command
      ->add_option("-o,--output", options->heat_map,
                   "Write a heat map: equal pixels dark grey, differing ones blue (1) to yellow (255)")
      ->type_name("FILE");
  command->add_option("--max-differing", options->max_differing, "So many pixels may differ")->type_name("N|P%");
  command->add_option("--max-error", options->max_error, "So far may a channel be off, 0 to 255")->type_name("E");
  command->add_option("--min-psnr", options->min_psnr, "The peak signal-to-noise ratio must be at least this")
      ->type_name("DB");
  command->add_flag("--json", options->json, "Report as JSON");
  command->footer(std::string("Without a limit, images must be equal. With limits, only those given count. Linear\n"
                              "floating-point images are compared as 8-bit sRGB.\n\n"
                              "Examples:\n"
                              "  sheaf compare expected.png actual.png\n"
                              "  sheaf compare a.png b.png -o heat.png --max-differing 0.02% --max-error 3\n\n") +
                  kExitCodes);
  command->callback([options, &run] { run = [options] { return runCompare(*options); }; });
}

}  // namespace sheaf::cli
