#include "tests/cli/run.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <stdexcept>

namespace sheaf::cli {
namespace {

void redirect(const std::string& path, int to) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (file < 0 || dup2(file, to) < 0) _exit(126);
  close(file);
}

/// A pseudo terminal: what is written to `path` can be read from `main`.
struct Terminal {
  int main = -1;
  std::string path;

  Terminal() : main(posix_openpt(O_RDWR | O_NOCTTY)) {
    if (main < 0 || grantpt(main) != 0 || unlockpt(main) != 0) throw std::runtime_error("no pseudo terminal");
    path = ptsname(main);
  }
  ~Terminal() { close(main); }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Until the other side is closed.
  std::string readAll() const {
    std::string text;
    for (char block[256];;) {
      const ssize_t n = read(main, block, sizeof block);
      if (n <= 0) return text;
      text.append(block, static_cast<std::size_t>(n));
    }
  }
};

/// The program may not have reached what is to be interrupted when the first signal comes.
int waitWhileSignalling(pid_t child, int signal) {
  for (;;) {
    usleep(100'000);
    int status = 0;
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) return status;
    if (ended < 0) throw std::runtime_error("waitpid failed");
    kill(child, signal);
  }
}

[[noreturn]] void runChild(const TempFolder& folder, std::vector<char*>& argv, const RunSettings& settings,
                           const std::string& out_path, const std::string& err_path) {
  redirect(out_path, STDOUT_FILENO);
  redirect(err_path, STDERR_FILENO);
  if (chdir(folder.path().c_str()) != 0) _exit(126);
  for (const auto& [name, value] : settings.environment) setenv(name.c_str(), value.c_str(), 1);
  if (settings.max_memory > 0) {
    const rlimit limit{settings.max_memory, settings.max_memory};
    if (setrlimit(RLIMIT_AS, &limit) != 0) _exit(126);
  }
  execv(argv.front(), argv.data());
  _exit(127);
}

}  // namespace

RunResult runSheaf(const TempFolder& folder, const std::vector<std::string>& arguments, const RunSettings& settings) {
  const TempFolder streams;  // apart from `folder`, whose files the tests count
  const std::string out_path = settings.out_path.empty() ? streams.file("out") : settings.out_path;
  std::vector<std::string> words = {SHEAF_COMMAND};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const std::optional<Terminal> terminal = settings.err_is_terminal ? std::make_optional<Terminal>() : std::nullopt;
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) runChild(folder, argv, settings, out_path, terminal ? terminal->path : streams.file("err"));
  const std::string terminal_text = terminal ? terminal->readAll() : std::string();
  int status = 0;
  if (settings.signal)
    status = waitWhileSignalling(child, *settings.signal);
  else if (waitpid(child, &status, 0) != child)
    throw std::runtime_error("waitpid failed");
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), streams.read("out"),
          terminal ? terminal_text : streams.read("err")};
}

bool isOneErrorLine(const std::string& err) {
  return err.starts_with("sheaf: ") && err.ends_with('\n') && std::count(err.begin(), err.end(), '\n') == 1;
}

}  // namespace sheaf::cli
