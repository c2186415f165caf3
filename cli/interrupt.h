// cli/interrupt: Ctrl-C while work is under way that writes files in the end.
#pragma once

namespace sheaf::cli {

/// While one is alive, SIGINT and SIGTERM are only noted, so that no file is left half-made; endIfInterrupted() then
/// ends the program as the signal would have. A signal that was ignored before (nohup) stays ignored. One at a time.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  bool interrupted() const;
  /// Does not return if interrupted().
  void endIfInterrupted() const;
};

}  // namespace sheaf::cli
