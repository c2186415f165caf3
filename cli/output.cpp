#include "cli/output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "core/error.h"

namespace sheaf::cli {
namespace fs = std::filesystem;
namespace {

void checkWritable(const std::string& text) {
  const fs::path path = text;
  const auto fail = [&](std::string_view reason) {
    throw Error(ErrorCode::kBadInput, fmt::format("{}: {}", text, reason));
  };
  std::error_code ec;
  if (fs::is_directory(path, ec)) fail("is a directory");
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ec)) fail(fmt::format("cannot be written: {} is not a directory", folder.string()));
  // A device or a pipe is written in place, a file is replaced within its folder.
  const bool in_place = fs::exists(path, ec) && !fs::is_regular_file(path, ec);
  if (access(in_place ? path.c_str() : folder.c_str(), in_place ? W_OK : W_OK | X_OK) != 0)
    fail(fmt::format("cannot be written: {}", std::strerror(errno)));
}

bool sameFile(const std::string& a, const std::string& b) {
  std::error_code ec;
  if (fs::exists(a, ec) && !fs::is_regular_file(a, ec)) return false;  // /dev/null may be named twice
  if (fs::equivalent(a, b, ec)) return true;
  // A relative path that does not exist yet would stay relative.
  const fs::path whole_a = fs::weakly_canonical(fs::absolute(a, ec), ec);
  return !ec && whole_a == fs::weakly_canonical(fs::absolute(b, ec), ec);
}

}  // namespace

void checkOutputs(const std::vector<OutputFile>& outputs, const std::vector<std::string>& inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const OutputFile& output = outputs[i];
    if (output.path.empty() || output.path == "-") continue;
    checkWritable(output.path);
    for (const std::string& input : inputs)
      if (sameFile(output.path, input))
        throw Error(ErrorCode::kUsage, fmt::format("{} {}: would overwrite the input", output.option, output.path));
    for (std::size_t k = 0; k < i; ++k)
      if (!outputs[k].path.empty() && sameFile(output.path, outputs[k].path))
        throw Error(ErrorCode::kUsage,
                    fmt::format("{} and {} name the same file, {}", outputs[k].option, output.option, output.path));
  }
}

}  // namespace sheaf::cli
