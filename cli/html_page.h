// cli/html_page: reports as one self-contained HTML file: style, scripts, charts and pictures are within it, and it may
// load nothing else. Light or dark as the reader's system is; made for screens from a phone's width up.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/image.h"
#include "core/task_pool.h"
#include "pipeline/timing_report.h"

namespace CLI {
class App;
}

namespace sheaf::cli {

/// A figure that should be seen first.
struct Card {
  std::string value;
  std::string meaning;
};

/// The first column is text, the others are figures. A cell `12.3 ±0.4` has its second part set back.
struct HtmlTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::size_t> totals;  ///< rows that are sums of those above, by index
};

struct StackedBar {
  std::string name;
  std::vector<double> parts;  ///< as many as the chart has part names, none below 0
};

/// Bars from one zero, to one scale.
struct StackedBars {
  std::string unit;
  std::vector<std::string> part_names;  ///< at most 7
  std::vector<StackedBar> bars;
};

struct Line {
  std::string name;
  std::vector<double> values;  ///< one for each x; what is not finite is a gap
  int color = 0;               ///< 0 to 2
  bool dashed = false;
};

/// Over 1, 2, 3 ...
struct LineChart {
  std::string x_label;
  std::string y_label;
  std::vector<std::string> x_names;  ///< instead of the numbers, where the pointer is; may be empty
  std::vector<Line> lines;
};

struct Picture {
  const Image8* image;
  std::string caption;
};

/// Puts a page together from top to bottom. All text is taken as text, whatever characters it has.
class HtmlPage {
 public:
  explicit HtmlPage(std::string_view title);

  enum class Tone { kPlain, kFaint, kGood, kBad };
  void heading(int level, std::string_view text);  ///< 2 or 3
  void paragraph(std::string_view text, Tone tone = Tone::kPlain);
  void cards(const std::vector<Card>& cards);
  void facts(const std::vector<std::pair<std::string, std::string>>& facts);
  void table(const HtmlTable& table);
  void foldedTable(std::string_view summary, const HtmlTable& table);
  void bars(const StackedBars& chart);
  void lines(const LineChart& chart);
  void pictures(const std::vector<Picture>& pictures, TaskPool& pool);

  std::string finish() &&;

 private:
  std::string text_;
};

/// Adds `--report FILE.html`.
void addReportOption(CLI::App& command, std::optional<std::string>& file);

/// Empty if it was not given. Throws Error(kUsage) for a name that does not end in .html.
std::string understandReport(const std::optional<std::string>& file);

/// On what a report was made, for HtmlPage::facts().
std::vector<std::pair<std::string, std::string>> contextFacts(const pipeline::RunContext& context);

/// A picture of at most `max_side` pixels per side: each pixel the mean, in coded values, of a square of the larger
/// one.
Image8 smallPicture(const Image8& image, int max_side);

/// The heat map of two pictures of the same size, as small: of each square the pixel that differs most is shown, so
/// that a single one is not lost.
Image8 smallHeatMap(const Image8& a, const Image8& b, int max_side);

}  // namespace sheaf::cli
