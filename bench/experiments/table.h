// bench/experiments/table: Markdown tables.
#pragma once

#include <string>
#include <vector>

namespace sheaf::experiments {

/// The first column is text, the others numbers, to the right.
class Table {
 public:
  explicit Table(std::vector<std::string> head);
  /// As many cells as the head has.
  void add(const std::vector<std::string>& cells);
  /// With an empty line behind it.
  std::string text() const { return text_ + "\n"; }

 private:
  std::size_t columns_;
  std::string text_;
};

/// `97.4` of 0.9741
std::string percent(double fraction, int digits = 1);
/// Three significant digits at most, no exponent: times and rates.
std::string rounded(double value);

}  // namespace sheaf::experiments
