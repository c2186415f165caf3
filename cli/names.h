// cli/names: how options and reports call the values of an enumeration.
#pragma once

#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "core/error.h"

namespace sheaf::cli {

template <typename Value, std::size_t Count>
using Names = std::array<std::pair<std::string_view, Value>, Count>;

/// Empty for a value without a name.
template <typename Value, std::size_t Count>
std::string_view nameOf(Value value, const Names<Value, Count>& names) {
  for (const auto& [name, named] : names)
    if (named == value) return name;
  return {};
}

/// Throws Error(kUsage), which names the option and the choices, for another text.
template <typename Value, std::size_t Count>
Value choose(std::string_view option, std::string_view text, const Names<Value, Count>& choices) {
  std::string names;
  for (const auto& [name, value] : choices) {
    if (name == text) return value;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", name);
  }
  throw Error(ErrorCode::kUsage, fmt::format("{} {}: expected one of {}", option, text, names));
}

}  // namespace sheaf::cli
