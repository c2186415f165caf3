#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <new>

#include "cli/build_info.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "core/error.h"

namespace sheaf::cli {
namespace {

constexpr int kInternalError = static_cast<int>(ErrorCode::kInternal);

constexpr const char* kFooter =
    "INPUT is a file (glTF, GLB, OBJ, PLY, STL, OFF; .gz of the text formats) or builtin:NAME?key=value&...\n"
    "\n"
    "Examples:\n"
    "  sheaf render model.glb -o model.png\n"
    "  sheaf render builtin:gallery -o gallery.png --timings\n"
    "  sheaf compare expected.png actual.png -o difference.png\n"
    "  sheaf simplify scan.ply --vertices 3000 -o small.ply\n"
    "  sheaf group small.ply --epsilon 0.5% --snapped snapped.ply\n"
    "  sheaf cluster scan.ply --clusters 100 -o clusters.png\n"
    "\n";

/// `--size=`: the parser would take the next word as the value.
void refuseEmptyValues(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word.starts_with("--") && word.ends_with('='))
      throw Error(ErrorCode::kUsage, fmt::format("{}: the value is missing", word));
  }
}

const CLI::App& chosen(const CLI::App& app) {
  const auto subcommands = app.get_subcommands();
  return subcommands.empty() ? app : *subcommands.front();
}

int parseAndRun(int argc, char** argv) {
  refuseEmptyValues(argc, argv);
  CLI::App app("Renders meshes to images on the CPU, and finds vertex groups in them.", "sheaf");
  Run run;
  app.set_help_flag("-h,--help", "Print this help and exit");
  bool version = false;
  app.add_flag("--version", version, "Print version, compiler and SIMD targets and exit");
  app.footer(std::string(kFooter) + kExitCodes);
  app.require_subcommand(0, 1);
  addRenderCommand(app, run);
  addCompareCommand(app, run);
  addBenchCommand(app, run);
  addInfoCommand(app, run);
  addGroupCommand(app, run);
  addClusterCommand(app, run);
  addSimplifyCommand(app, run);
  addScenesCommand(app, run);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    const CLI::App& asked = chosen(app);
    writeStdout(asked.help(&asked == &app ? "" : "sheaf"));
    return 0;
  } catch (const CLI::ParseError& e) {
    const CLI::App& asked = chosen(app);
    throw Error(ErrorCode::kUsage,
                fmt::format("{} (see sheaf {}--help)", e.what(), &asked == &app ? "" : asked.get_name() + " "));
  }
  if (version) {
    writeStdout(versionText());
    return 0;
  }
  if (!run)
    throw Error(
        ErrorCode::kUsage,
        "a subcommand is missing: render, compare, bench, info, group, cluster, simplify or scenes (see sheaf --help)");
  return run();
}

}  // namespace

int runApplication(int argc, char** argv) {
  try {
    return parseAndRun(argc, argv);
  } catch (const Error& e) {
    printError(e.what());
    return static_cast<int>(e.code());
  } catch (const std::bad_alloc&) {
    printError("internal error: out of memory");
    return kInternalError;
  } catch (const std::exception& e) {
    printError(fmt::format("internal error: {}", e.what()));
    return kInternalError;
  }
}

}  // namespace sheaf::cli
