// cli: the `sheaf` command. One file per subcommand; each adds its options and says what is to be run.
//   Out    results on stdout, everything else on stderr; the exit codes of kExitCodes
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace sheaf::cli {

inline constexpr const char* kExitCodes =
    "Exit codes: 0 done; 1 images differ (compare); 2 wrong usage; 3 bad input, or an output that\n"
    "cannot be written; 4 unsupported feature; 5 some of a batch failed; 70 internal error.";

/// Runs the chosen subcommand after all of the command line has been understood; returns the exit code.
using Run = std::function<int()>;

void addRenderCommand(CLI::App& app, Run& run);
void addCompareCommand(CLI::App& app, Run& run);
void addBenchCommand(CLI::App& app, Run& run);
void addInfoCommand(CLI::App& app, Run& run);
void addGroupCommand(CLI::App& app, Run& run);
void addClusterCommand(CLI::App& app, Run& run);
void addSimplifyCommand(CLI::App& app, Run& run);
void addScenesCommand(CLI::App& app, Run& run);

/// The whole program: parses, dispatches, turns exceptions into a line on stderr and an exit code.
int runApplication(int argc, char** argv);

}  // namespace sheaf::cli
