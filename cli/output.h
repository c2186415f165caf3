// cli/output: files that the command is going to write, looked at before any work is done for them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sheaf::cli {

/// A file named by an option, "-" being stdout.
struct OutputFile {
  std::string_view option;
  std::string path;
};

/// Throws Error for what can be known beforehand: kBadInput when a folder is missing or not writable or the path is a
/// folder; kUsage when two outputs, or an output and one of the inputs, are the same file. Empty paths are skipped.
void checkOutputs(const std::vector<OutputFile>& outputs, const std::vector<std::string>& inputs);

}  // namespace sheaf::cli
