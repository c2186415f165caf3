// Runs a test body once for every SIMD target that this build has and this machine can run.
#pragma once

#include <doctest/doctest.h>
#include <hwy/targets.h>

#include <cstdint>

namespace sheaf {

/// The setting is global: the choice is the usual one again afterwards. Under ThreadSanitizer only the best target
/// runs: races do not depend on it, and the portable one takes minutes there.
template <typename Body>
void forEachTarget(const Body& body) {
  struct Restore {
    ~Restore() { hwy::SetSupportedTargetsForTest(0); }
  } restore;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    const char* const simd_target = hwy::TargetName(target);
    CAPTURE(simd_target);
    hwy::SetSupportedTargetsForTest(target);
    body();
#if defined(__SANITIZE_THREAD__)
    break;
#endif
  }
}

}  // namespace sheaf
