// cli/console: what the command says. Results go to stdout, everything else to stderr.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sheaf::cli {

/// Throws Error(kBadInput) when stdout cannot take it (a full disk).
void writeStdout(std::string_view text);

/// `sheaf: message` on stderr, as one line.
void printError(std::string_view message);

/// `warning: ...` on stderr, one line each; beyond 20 only their number.
void printWarnings(const std::vector<std::string>& warnings);

}  // namespace sheaf::cli
