#include "cli/html_page.h"

#include <doctest/doctest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "raster/image_compare.h"

namespace sheaf::cli {
namespace {

std::size_t countOf(const std::string& text, std::string_view word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

std::string between(const std::string& text, std::string_view from, std::string_view to) {
  const std::size_t begin = text.find(from);
  if (begin == std::string::npos) return {};
  const std::size_t start = begin + from.size();
  return text.substr(start, text.find(to, start) - start);
}

}  // namespace

TEST_CASE("cli/html_page: text stays text, wherever it stands") {
  const std::string evil = "<script>alert('1')</script> & \"quotes\"";
  TaskPool pool(1);
  HtmlPage page(evil);
  page.heading(2, evil);
  page.paragraph(evil);
  page.cards({{evil, evil}});
  page.facts({{evil, evil}});
  page.table({{evil}, {{evil}}, {}});
  page.foldedTable(evil, {{evil}, {{evil}}, {}});
  page.bars({evil, {evil}, {{evil, {1.0}}}});
  page.lines({evil, evil, {evil}, {{evil, {1.0}}}});
  const Image8 image(1, 1);
  page.pictures({{&image, evil}}, pool);
  const std::string html = std::move(page).finish();
  CHECK(html.find("<script>alert") == std::string::npos);
  CHECK(html.find("&lt;script&gt;alert") != std::string::npos);
  // The data of the chart, and the scripts of the page.
  CHECK(countOf(html, "</script>") == 2);
}

TEST_CASE("cli/html_page: nothing is to be loaded: no address in the page but what uPlot says of itself") {
  HtmlPage page("t");
  const std::string html = std::move(page).finish();
  CHECK(html.find("default-src 'none'") != std::string::npos);
  CHECK(countOf(html, "http://") == 0);
  CHECK(countOf(html, "https://") == countOf(html, "https://github.com/leeoniya/uPlot"));
  CHECK(html.find("src=\"http") == std::string::npos);
}

TEST_CASE("cli/html_page: the data of a line chart is JSON, with gaps for what is not finite") {
  HtmlPage page("t");
  page.lines({"view", "px", {"a", "b"}, {{"<max>", {1.5, std::numeric_limits<double>::infinity()}, 1, true}}});
  const std::string html = std::move(page).finish();
  const auto json = nlohmann::json::parse(between(html, "<script type=\"application/json\">", "</script>"));
  CHECK(json["x"] == nlohmann::json::array({1, 2}));
  CHECK(json["x_names"][1] == "b");
  CHECK(json["series"][0]["name"] == "<max>");
  CHECK(json["series"][0]["values"] == nlohmann::json::array({1.5, nullptr}));
  CHECK(json["series"][0]["dashed"] == true);
}

TEST_CASE("cli/html_page: the longest bar is the whole width, the others to the same scale") {
  HtmlPage page("t");
  page.bars({"ms", {"a", "b"}, {{"long", {3.0, 1.0}}, {"short", {1.0, 0.0}}}});
  const std::string html = std::move(page).finish();
  CHECK(html.find("x=\"0.000%\" width=\"75.000%\"") != std::string::npos);
  CHECK(html.find("x=\"75.000%\" width=\"25.000%\"") != std::string::npos);
  CHECK(html.find("x=\"0.000%\" width=\"25.000%\"") != std::string::npos);
  CHECK(html.find("4.00 ms") != std::string::npos);
  HtmlPage empty("t");
  empty.bars({"ms", {"a"}, {{"none", {0.0}}}});
  CHECK(std::move(empty).finish().find("nan") == std::string::npos);
}

TEST_CASE("cli/html_page: pictures are within the page, as PNG in base 64, with their size") {
  TaskPool pool(1);
  for (const int width : {1, 2, 3, 17}) {
    CAPTURE(width);
    HtmlPage page("t");
    const Image8 image(width, 2, {1, 2, 3, 255});
    page.pictures({{&image, "c"}}, pool);
    const std::string html = std::move(page).finish();
    const std::string data = between(html, "src=\"data:image/png;base64,", "\"");
    CHECK(data.starts_with("iVBORw0KGgo"));  // the signature of PNG
    CHECK(data.size() % 4 == 0);
    // Its end is the fixed chunk IEND, whose last bytes are AE 42 60 82.
    const std::string_view ends[] = {"rkJggg==", "5CYII=", "uQmCC"};
    CHECK(std::any_of(std::begin(ends), std::end(ends), [&](std::string_view end) { return data.ends_with(end); }));
    CHECK(html.find("<img width=\"" + std::to_string(width) + "\" height=\"2\"") != std::string::npos);
  }
}

TEST_CASE("cli/html_page: a small picture has means; one that is small enough stays as it is") {
  Image8 image(5, 4, {10, 20, 30, 255});
  image.at(1, 1) = {50, 20, 30, 255};
  CHECK(smallPicture(image, 5) == image);
  const Image8 small = smallPicture(image, 3);
  CHECK(small.width() == 3);
  CHECK(small.height() == 2);
  CHECK(small.at(0, 0) == Rgba8{20, 20, 30, 255});
  CHECK(small.at(2, 1) == Rgba8{10, 20, 30, 255});
}

TEST_CASE("cli/html_page: a single differing pixel is not lost in a small heat map") {
  const Image8 a(64, 64, {10, 20, 30, 255});
  Image8 b = a;
  b.at(37, 21).g = 220;
  const Image8 small = smallHeatMap(a, b, 8);
  REQUIRE(small.width() == 8);
  const Image8 full = raster::heatMap(a, b);
  CHECK(small.at(37 / 8, 21 / 8) == full.at(37, 21));
  CHECK(small.at(0, 0) == full.at(0, 0));
  CHECK(smallHeatMap(a, b, 64) == full);
}

TEST_CASE("cli/html_page: --report takes names that end in .html") {
  CHECK(understandReport("a.html") == "a.html");
  CHECK(understandReport(std::nullopt).empty());
  CHECK_THROWS_AS(understandReport("a.txt"), Error);
  CHECK_THROWS_AS(understandReport(""), Error);
}

}  // namespace sheaf::cli
