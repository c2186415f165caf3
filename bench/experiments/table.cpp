#include "bench/experiments/table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cassert>
#include <cmath>

namespace sheaf::experiments {

Table::Table(std::vector<std::string> head) : columns_(head.size()) {
  add(head);
  text_ += "| ---";
  for (std::size_t i = 1; i < columns_; ++i) text_ += " | ---:";
  text_ += " |\n";
}

void Table::add(const std::vector<std::string>& cells) {
  assert(cells.size() == columns_);
  text_ += fmt::format("| {} |\n", fmt::join(cells, " | "));
}

std::string percent(double fraction, int digits) {
  return fmt::format("{:.{}f}", 100.0 * fraction, digits);
}

std::string rounded(double value) {
  const double size = std::abs(value);
  return fmt::format("{:.{}f}", value, size >= 100.0 ? 0 : size >= 10.0 ? 1 : size >= 1.0 ? 2 : 3);
}

}  // namespace sheaf::experiments
