#include "cli/build_info.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hwy/highway.h>
#include <strings.h>

#include <fstream>

#include "core/error.h"
#include "sheaf_revision.h"

namespace sheaf::cli {
namespace {

std::string compilerText() {
#if defined(__clang__)
  return fmt::format("Clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
  return fmt::format("GCC {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
}

}  // namespace

std::string buildText() {
  return fmt::format("sheaf {}, {}, {}", SHEAF_VERSION, compilerText(), SHEAF_BUILD_TYPE);
}

std::string revisionText() {
  return SHEAF_REVISION;
}

std::string flagsText() {
  return SHEAF_FLAGS;
}

std::string cpuModel() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name"))
      if (const std::size_t colon = line.find(": "); colon != std::string::npos) return line.substr(colon + 2);
  return "unknown";
}

std::vector<std::string> simdTargets() {
  std::vector<std::string> names;
  // Lower bits are better targets, and the list is in this order.
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) names.emplace_back(hwy::TargetName(target));
  return names;
}

void forceSimdTarget(const std::string& name) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
    if (strcasecmp(hwy::TargetName(target), name.c_str()) == 0) return hwy::SetSupportedTargetsForTest(target);
  throw Error(ErrorCode::kUsage, fmt::format("--simd {}: expected one of {}", name, fmt::join(simdTargets(), ", ")));
}

std::string versionText() {
  return fmt::format("sheaf {}, revision {}\ncompiler: {}, {}, {}\nSIMD targets here: {}\n", SHEAF_VERSION,
                     revisionText(), compilerText(), SHEAF_BUILD_TYPE, flagsText(), fmt::join(simdTargets(), ", "));
}

}  // namespace sheaf::cli
