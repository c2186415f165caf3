#include "tests/cli/run.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

namespace sheaf::cli {
namespace {

void redirect(const std::string& path, int to) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (file < 0 || dup2(file, to) < 0) _exit(126);
  close(file);
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

  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) runChild(folder, argv, settings, out_path, streams.file("err"));
  int status = 0;
  if (waitpid(child, &status, 0) != child) throw std::runtime_error("waitpid failed");
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), streams.read("out"), streams.read("err")};
}

bool isOneErrorLine(const std::string& err) {
  return err.starts_with("sheaf: ") && err.ends_with('\n') && std::count(err.begin(), err.end(), '\n') == 1;
}

}  // namespace sheaf::cli
