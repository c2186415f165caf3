// cli/console: what the command says. Results go to stdout, everything else to stderr.
#pragma once

#include <cstdint>
#include <functional>
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

/// How far long work has got, as one line on stderr that is written over and gone in the end; nothing at all if stderr
/// is no terminal.
class ProgressLine {
 public:
  /// what  `grouping`
  ProgressLine(std::string_view what, bool quiet);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// done  [0, 1]. Writes at most ten times a second.
  void show(double done);

 private:
  std::string what_;
  bool wanted_;
  bool shown_ = false;
  std::int64_t next_ns_;
};

/// For work that can be stopped, but is not. line  must live as long as the work
std::function<bool(double done)> shownOn(ProgressLine& line);

}  // namespace sheaf::cli
