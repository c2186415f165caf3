#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>
#include <vector>

#include "cli/commands.h"
#include "cli/compare_limits.h"
#include "cli/compare_scene.h"
#include "cli/console.h"
#include "cli/difference_report.h"
#include "cli/output.h"
#include "cli/saved_file.h"
#include "core/error.h"
#include "raster/image_compare.h"
#include "raster/image_io.h"

namespace sheaf::cli {
namespace {

using Json = nlohmann::ordered_json;
using raster::ImageDifference;

constexpr const char* kFooter =
    "One INPUT, a mesh file or builtin:NAME, is drawn with vertex groups and answers two questions: is grouped "
    "drawing\n"
    "right (against the snapped mesh drawn ungrouped: with planar groups not a pixel may differ, with linear and\n"
    "cluster groups 1 %), and what does grouping cost in quality (against the original mesh). The limits are about\n"
    "quality, in every view; without one, only drawing decides. The output has original, grouped and heat map side by\n"
    "side, of the view with the greatest RMS error.\n"
    "\n"
    "Two images are compared with each other: without a limit they must be equal, and the output is the heat map.\n"
    "Linear floating-point images are compared as 8-bit sRGB. In heat maps equal pixels are dark grey, differing ones\n"
    "go from blue (1) to yellow (255).\n"
    "\n"
    "Exit code 1: a limit is passed, or grouped drawing is not right.\n"
    "\n"
    "Examples:\n"
    "  sheaf compare bunny.ply -o bunny.png\n"
    "  sheaf compare model.glb --views orbit:12 --epsilon 1% --metric quadric --max-differing 2% --json\n"
    "  sheaf compare expected.png actual.png\n"
    "  sheaf compare a.png b.png -o heat.png --max-differing 0.02% --max-error 3\n"
    "\n";

struct CompareArguments {
  SceneCompareArguments scene;
  std::optional<std::string> second;
  std::optional<std::string> output;
  LimitArguments limits;
  bool json = false;
};

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
  Json json = {{"width", d.width}, {"height", d.height}, {"within_limits", passed.empty()}, {"beyond", passed}};
  json.update(toJson(d));
  return json.dump(2) + "\n";
}

void checkPictureOutput(const std::string& path) {
  if (raster::formatOf(path).linear)
    throw Error(ErrorCode::kUsage, fmt::format("-o {}: a heat map has 8-bit colours; write it as .png", path));
}

int compareImages(const std::string& path_a, const std::string& path_b, const std::string& output, Limits limits,
                  bool json) {
  if (limits.none()) limits.differing = PixelLimit{};
  checkOutputs({{"-o", output}}, {path_a, path_b});
  if (!output.empty()) raster::checkFormatAvailable(output);
  const Image8 a = raster::readImage(path_a);
  const Image8 b = raster::readImage(path_b);
  if (a.width() != b.width() || a.height() != b.height())
    throw Error(ErrorCode::kBadInput, fmt::format("{}: is {}x{} pixels, {} is {}x{}", path_a, a.width(), a.height(),
                                                  path_b, b.width(), b.height()));
  const ImageDifference difference = raster::compareImages(a, b);
  if (!output.empty()) {
    const Image8 map = raster::heatMap(a, b);
    TaskPool pool;
    raster::writePicture(output, {.srgb = &map}, pool);
  }
  const std::vector<std::string> passed = beyond(limits, difference);
  writeStdout(json ? reportJson(difference, passed) : reportText(difference, passed));
  return passed.empty() ? 0 : 1;
}

/// Two images are not drawn: options about drawing would be without effect.
void refuseSceneOptions(const CLI::App& command) {
  constexpr std::string_view kForImages[] = {"INPUT",       "IMAGE",      "--output", "--max-differing",
                                             "--max-error", "--min-psnr", "--json"};
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_positional() ? option->get_name(true) : "--" + option->get_lnames().front();
    if (option->count() > 0 && std::find(std::begin(kForImages), std::end(kForImages), name) == std::end(kForImages))
      throw Error(ErrorCode::kUsage, fmt::format("{} is for comparing one INPUT, not two images", name));
  }
}

int runCompare(const CompareArguments& arguments, const CLI::App& command) {
  if (arguments.output && arguments.output->empty())
    throw Error(ErrorCode::kUsage, "-o: the name of the file is empty");
  const std::string output = arguments.output.value_or("");
  if (!output.empty()) checkPictureOutput(output);
  const Limits limits = understandLimits(arguments.limits);
  if (arguments.second) {
    refuseAsScene(*arguments.second);
    refuseSceneOptions(command);
    return compareImages(arguments.scene.input, *arguments.second, output, limits, arguments.json);
  }
  if (raster::hasPictureExtension(arguments.scene.input))
    throw Error(ErrorCode::kUsage, fmt::format("{}: the image to compare it with is missing", arguments.scene.input));
  SceneCompareRequest request;
  understandSceneCompare(arguments.scene, request);
  request.limits = limits;
  request.output = output;
  request.json = arguments.json;
  return compareScene(request);
}

}  // namespace

void addCompareCommand(CLI::App& app, Run& run) {
  CLI::App* command =
      app.add_subcommand("compare", "Compare a scene drawn with vertex groups and without, or two images");
  const auto arguments = std::make_shared<CompareArguments>();
  CompareArguments& a = *arguments;
  command->add_option("INPUT", a.scene.input, "A mesh file or builtin:NAME; or an image: PNG, JPEG, EXR, TIFF, HDR ...")
      ->required();
  command->add_option("IMAGE", a.second, "The image to compare it with");
  command
      ->add_option("-o,--output", a.output,
                   "Write a picture: original, grouped and heat map side by side, or\nthe heat map of two images")
      ->type_name("FILE");
  addLimitOptions(*command, a.limits);
  command->add_flag("--json", a.json, "Report as JSON");
  addSceneCompareOptions(*command, a.scene);
  command->footer(std::string(kFooter) + kExitCodes);
  command->callback(
      [arguments, command, &run] { run = [arguments, command] { return runCompare(*arguments, *command); }; });
}

}  // namespace sheaf::cli
