#include "cli/console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "core/error.h"
#include "core/stage_timer.h"

namespace sheaf::cli {
namespace {

constexpr std::size_t kMaxWarnings = 20;
constexpr std::int64_t kProgressPeriodNs = 100'000'000;

/// no-color.org: any value but the empty one switches colours off.
bool colorWanted() {
  const char* no_color = std::getenv("NO_COLOR");
  return isatty(STDERR_FILENO) && !(no_color && *no_color);
}

void printLine(std::string_view head, int ansi_color, std::string_view text) {
  std::string line(text);
  std::replace(line.begin(), line.end(), '\n', ' ');
  if (colorWanted())
    fmt::print(stderr, "\x1b[{}m{}\x1b[0m {}\n", ansi_color, head, line);
  else
    fmt::print(stderr, "{} {}\n", head, line);
}

}  // namespace

void writeStdout(std::string_view text) {
  const bool written =
      (text.empty() || std::fwrite(text.data(), 1, text.size(), stdout) == text.size()) && std::fflush(stdout) == 0;
  if (!written)
    throw Error(ErrorCode::kBadInput, fmt::format("standard output: cannot be written: {}", std::strerror(errno)));
}

void printError(std::string_view message) {
  printLine("sheaf:", 31, message);
}

void printWarnings(const std::vector<std::string>& warnings) {
  const std::size_t shown = std::min(warnings.size(), kMaxWarnings);
  for (std::size_t i = 0; i < shown; ++i) printLine("warning:", 33, warnings[i]);
  if (shown < warnings.size()) printLine("warning:", 33, fmt::format("and {} more", warnings.size() - shown));
}

ProgressLine::ProgressLine(std::string_view what, bool quiet)
    : what_(what), wanted_(!quiet && isatty(STDERR_FILENO) != 0), next_ns_(nowNs() + kProgressPeriodNs) {}

ProgressLine::~ProgressLine() {
  if (!shown_) return;
  fmt::print(stderr, "\r{:{}}\r", "", what_.size() + 6);
  std::fflush(stderr);
}

void ProgressLine::show(double done) {
  if (!wanted_ || nowNs() < next_ns_) return;
  fmt::print(stderr, "\r{} {:3.0f} %", what_, 100.0 * done);
  std::fflush(stderr);
  shown_ = true;
  next_ns_ = nowNs() + kProgressPeriodNs;
}

std::function<bool(double done)> shownOn(ProgressLine& line) {
  return [&line](double done) {
    line.show(done);
    return true;
  };
}

}  // namespace sheaf::cli
