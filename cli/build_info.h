// cli/build_info: what this program is and what it runs on.
#pragma once

#include <string>
#include <vector>

namespace sheaf::cli {

/// `sheaf 0.1.0, GCC 12.2.0, Release`
std::string buildText();

/// What `git describe` says of the sources, `-dirty` if they were changed; "unknown" without git.
std::string revisionText();

/// The compiler's flags.
std::string flagsText();

/// The model name that the system gives, or "unknown".
std::string cpuModel();

/// SIMD targets that were compiled in and that this machine has, best first.
std::vector<std::string> simdTargets();

/// Makes all kernels run for this target only. Call before any kernel runs. Throws Error(kUsage) for a name that is not
/// among simdTargets(), whatever its case.
void forceSimdTarget(const std::string& name);

/// Several lines for `--version`.
std::string versionText();

}  // namespace sheaf::cli
