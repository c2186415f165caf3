#include "pipeline/counters.h"

namespace sheaf::pipeline {

static_assert(sizeof(Counters) == kCounterNames.size() * sizeof(std::uint64_t), "each counter has a name");

Counters& Counters::operator+=(const Counters& other) {
  for (const auto& [name, field] : kCounterNames) this->*field += other.*field;
  return *this;
}

}  // namespace sheaf::pipeline
