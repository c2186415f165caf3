#include "cli/html_page.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "raster/image_compare.h"
#include "raster/image_io.h"
#include "report_files.h"

namespace sheaf::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  return out;
}

/// Within a script element: what could end it is written as an escape.
std::string scriptJson(const Json& json) {
  std::string out;
  for (const char c : json.dump(-1, ' ', true, Json::error_handler_t::replace)) {
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  }
  return out;
}

std::string base64(std::string_view bytes) {
  static constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? kDigits[three >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::string tableHtml(const HtmlTable& table) {
  std::string html = "<div class=\"scroll\"><table>\n<thead><tr>";
  for (const std::string& cell : table.head) html += fmt::format("<th scope=\"col\">{}</th>", escaped(cell));
  html += "</tr></thead>\n<tbody>\n";
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const bool total = std::find(table.totals.begin(), table.totals.end(), r) != table.totals.end();
    html += total ? "<tr class=\"total\">" : "<tr>";
    for (const std::string& cell : table.rows[r]) {
      const std::size_t spread = cell.find(" ±");
      html += spread == std::string::npos ? fmt::format("<td>{}</td>", escaped(cell))
                                          : fmt::format("<td>{}<span class=\"spread\">{}</span></td>",
                                                        escaped(cell.substr(0, spread)), escaped(cell.substr(spread)));
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

/// How many pixels of the larger picture, in each direction, make one of the smaller.
int squareSide(const Image8& image, int max_side) {
  const int longer = std::max(image.width(), image.height());
  return std::max(1, (longer + max_side - 1) / max_side);
}

/// A smaller picture of which pick(x0, y0, x1, y1) says each pixel, from the square [x0, x1) x [y0, y1).
template <typename Pick>
Image8 shrink(const Image8& image, int side, const Pick& pick) {
  Image8 small((image.width() + side - 1) / side, (image.height() + side - 1) / side);
  for (int y = 0; y < small.height(); ++y)
    for (int x = 0; x < small.width(); ++x)
      small.at(x, y) =
          pick(x * side, y * side, std::min(image.width(), (x + 1) * side), std::min(image.height(), (y + 1) * side));
  return small;
}

Rgba8 meanOf(const Image8& image, int x0, int y0, int x1, int y1) {
  std::array<int, 4> sum{};
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const Rgba8 p = image.at(x, y);
      sum[0] += p.r;
      sum[1] += p.g;
      sum[2] += p.b;
      sum[3] += p.a;
    }
  const int count = (x1 - x0) * (y1 - y0);
  const auto mean = [&](std::size_t k) { return static_cast<std::uint8_t>((sum[k] + count / 2) / count); };
  return {mean(0), mean(1), mean(2), mean(3)};
}

int errorOf(Rgba8 a, Rgba8 b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b), std::abs(a.a - b.a)});
}

}  // namespace

HtmlPage::HtmlPage(std::string_view title) {
  const std::string name = escaped(title);
  text_ = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
      "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n<title>{}</title>\n<style>\n{}{}</style>\n</head>\n<body>\n<h1>{}</h1>\n",
      name, embedded::kUPlotMinCss, embedded::kReportCss, name);
}

void HtmlPage::heading(int level, std::string_view text) {
  assert(level == 2 || level == 3);
  text_ += fmt::format("<h{}>{}</h{}>\n", level, escaped(text), level);
}

void HtmlPage::paragraph(std::string_view text, Tone tone) {
  static constexpr std::array<std::string_view, 4> kClasses = {"", " class=\"faint\"", " class=\"good\"",
                                                               " class=\"bad\""};
  text_ += fmt::format("<p{}>{}</p>\n", kClasses[static_cast<std::size_t>(tone)], escaped(text));
}

void HtmlPage::cards(const std::vector<Card>& cards) {
  text_ += "<div class=\"cards\">\n";
  for (const Card& card : cards)
    text_ +=
        fmt::format("<div class=\"card\"><b>{}</b><span>{}</span></div>\n", escaped(card.value), escaped(card.meaning));
  text_ += "</div>\n";
}

void HtmlPage::facts(const std::vector<std::pair<std::string, std::string>>& facts) {
  text_ += "<dl>\n";
  for (const auto& [name, value] : facts)
    text_ += fmt::format("<dt>{}</dt><dd>{}</dd>\n", escaped(name), escaped(value));
  text_ += "</dl>\n";
}

void HtmlPage::table(const HtmlTable& table) {
  text_ += tableHtml(table);
}

void HtmlPage::foldedTable(std::string_view summary, const HtmlTable& table) {
  text_ += fmt::format("<details><summary>{}</summary>\n{}</details>\n", escaped(summary), tableHtml(table));
}

void HtmlPage::bars(const StackedBars& chart) {
  double longest = 0.0;
  const auto lengthOf = [](const StackedBar& bar) {
    double sum = 0.0;
    for (const double part : bar.parts) sum += part;
    return sum;
  };
  for (const StackedBar& bar : chart.bars) longest = std::max(longest, lengthOf(bar));
  text_ += "<div class=\"legend\">";
  for (std::size_t i = 0; i < chart.part_names.size(); ++i)
    text_ +=
        fmt::format("<span><i style=\"background:var(--stage-{})\"></i>{}</span>", i, escaped(chart.part_names[i]));
  text_ += "</div>\n";
  for (const StackedBar& bar : chart.bars) {
    const std::string value = fmt::format("{:.2f} {}", lengthOf(bar), chart.unit);
    text_ += fmt::format("<div class=\"bar\"><span>{}</span><svg role=\"img\" aria-label=\"{}: {}\">",
                         escaped(bar.name), escaped(bar.name), escaped(value));
    double from = 0.0;
    for (std::size_t i = 0; i < bar.parts.size() && longest > 0.0; ++i) {
      const double width = 100.0 * bar.parts[i] / longest;
      text_ += fmt::format(
          "<rect x=\"{:.3f}%\" width=\"{:.3f}%\" height=\"100%\" style=\"fill:var(--stage-{})\"><title>{}: {:.3f} "
          "{}</title></rect>",
          from, width, i, escaped(chart.part_names[i]), bar.parts[i], escaped(chart.unit));
      from += width;
    }
    text_ += fmt::format("</svg><span class=\"value\">{}</span></div>\n", escaped(value));
  }
}

void HtmlPage::lines(const LineChart& chart) {
  Json series = Json::array();
  std::size_t count = 0;
  for (const Line& line : chart.lines) {
    Json values = Json::array();
    for (const double v : line.values) values.push_back(std::isfinite(v) ? Json(v) : Json(nullptr));
    count = std::max(count, line.values.size());
    series.push_back(
        {{"name", line.name}, {"color", line.color}, {"dashed", line.dashed}, {"values", std::move(values)}});
  }
  Json x = Json::array();
  for (std::size_t i = 1; i <= count; ++i) x.push_back(i);
  Json json = {
      {"x_label", chart.x_label}, {"y_label", chart.y_label}, {"x", std::move(x)}, {"series", std::move(series)}};
  if (!chart.x_names.empty()) json["x_names"] = chart.x_names;
  text_ += fmt::format("<div class=\"legend\"><span>{} <output></output></span>", escaped(chart.x_label));
  for (const Line& line : chart.lines)
    text_ += fmt::format("<span><i class=\"{}\" style=\"color:var(--line-{})\"></i>{} <output></output></span>",
                         line.dashed ? "dashed" : "line", line.color, escaped(line.name));
  text_ += "</div>\n";
  text_ += fmt::format("<div class=\"lines\"><script type=\"application/json\">{}</script></div>\n", scriptJson(json));
}

void HtmlPage::pictures(const std::vector<Picture>& pictures, TaskPool& pool) {
  text_ += "<div class=\"pictures\">\n";
  for (const Picture& picture : pictures) {
    std::string png;
    raster::encodePng(*picture.image, pool, [&](std::string_view bytes) { png += bytes; });
    const std::string caption = escaped(picture.caption);
    text_ += fmt::format(
        "<figure><img width=\"{}\" height=\"{}\" alt=\"{}\" "
        "src=\"data:image/png;base64,{}\"><figcaption>{}</figcaption>"
        "</figure>\n",
        picture.image->width(), picture.image->height(), caption, base64(png), caption);
  }
  text_ += "</div>\n";
}

std::string HtmlPage::finish() && {
  text_ += fmt::format("<script>\n{}\n{}</script>\n</body>\n</html>\n", embedded::kUPlotIifeMinJs, embedded::kReportJs);
  return std::move(text_);
}

void addReportOption(CLI::App& command, std::optional<std::string>& file) {
  command.add_option("--report", file, "Write a report with charts and pictures, one file, for a browser")
      ->type_name("FILE.html");
}

std::string understandReport(const std::optional<std::string>& file) {
  if (file && !file->ends_with(".html"))
    throw Error(ErrorCode::kUsage, fmt::format("--report {}: expected a name that ends in .html", *file));
  return file.value_or("");
}

std::vector<std::pair<std::string, std::string>> contextFacts(const pipeline::RunContext& context) {
  return {{"scene", context.input},
          {"pictures", fmt::format("{} x {} pixels", context.width, context.height)},
          {"processor", context.cpu},
          {"threads", fmt::format("{}", context.threads)},
          {"SIMD target", context.simd_target},
          {"build", context.build},
          {"revision", context.revision},
          {"flags", context.flags}};
}

Image8 smallPicture(const Image8& image, int max_side) {
  return shrink(image, squareSide(image, max_side),
                [&](int x0, int y0, int x1, int y1) { return meanOf(image, x0, y0, x1, y1); });
}

Image8 smallHeatMap(const Image8& a, const Image8& b, int max_side) {
  assert(a.width() == b.width() && a.height() == b.height());
  const auto worstOf = [&](const Image8& image) {
    return [&](int x0, int y0, int x1, int y1) {
      int worst_x = x0;
      int worst_y = y0;
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x)
          if (errorOf(a.at(x, y), b.at(x, y)) > errorOf(a.at(worst_x, worst_y), b.at(worst_x, worst_y))) {
            worst_x = x;
            worst_y = y;
          }
      return image.at(worst_x, worst_y);
    };
  };
  const int side = squareSide(a, max_side);
  return raster::heatMap(shrink(a, side, worstOf(a)), shrink(b, side, worstOf(b)));
}

}  // namespace sheaf::cli
