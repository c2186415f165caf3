#include "cli/values.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "raster/screen.h"

namespace sheaf::cli {
namespace {

[[noreturn]] void refuse(std::string_view option, std::string_view text, std::string_view expected) {
  throw Error(ErrorCode::kUsage, fmt::format("{} {}: expected {}", option, text, expected));
}

/// The whole text as a number, or nothing.
template <typename Number>
std::optional<Number> toNumber(std::string_view text) {
  Number value{};
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (ec != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// `Count` finite numbers with commas between.
template <std::size_t Count>
std::optional<std::array<double, Count>> toNumbers(std::string_view text) {
  std::array<double, Count> values{};
  for (std::size_t i = 0; i < Count; ++i) {
    const std::size_t comma = text.find(',');
    if ((comma == std::string_view::npos) != (i + 1 == Count)) return std::nullopt;
    const auto value = toNumber<double>(text.substr(0, comma));
    if (!value || !std::isfinite(*value)) return std::nullopt;
    values[i] = *value;
    text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
  }
  return values;
}

constexpr std::array<std::pair<std::string_view, Rgba8>, 19> kColorNames = {{
    {"transparent", {0, 0, 0, 0}}, {"black", {0, 0, 0}},        {"white", {255, 255, 255}},   {"gray", {128, 128, 128}},
    {"grey", {128, 128, 128}},     {"silver", {192, 192, 192}}, {"red", {255, 0, 0}},         {"lime", {0, 255, 0}},
    {"green", {0, 128, 0}},        {"blue", {0, 0, 255}},       {"yellow", {255, 255, 0}},    {"cyan", {0, 255, 255}},
    {"magenta", {255, 0, 255}},    {"navy", {0, 0, 128}},       {"teal", {0, 128, 128}},      {"maroon", {128, 0, 0}},
    {"purple", {128, 0, 128}},     {"orange", {255, 165, 0}},   {"skyblue", {135, 206, 235}},
}};

std::optional<Rgba8> toHexColor(std::string_view digits) {
  const bool short_form = digits.size() == 3 || digits.size() == 4;
  if (!short_form && digits.size() != 6 && digits.size() != 8) return std::nullopt;
  std::uint32_t bits = 0;
  const auto [end, ec] = std::from_chars(digits.data(), digits.data() + digits.size(), bits, 16);
  if (ec != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  const int per_channel = short_form ? 4 : 8;
  const bool has_alpha = digits.size() == 4 || digits.size() == 8;
  if (!has_alpha) bits = bits << per_channel | ((1U << per_channel) - 1);
  const auto channel = [&](int from_the_right) {
    const std::uint32_t value = (bits >> (from_the_right * per_channel)) & ((1U << per_channel) - 1);
    return static_cast<std::uint8_t>(short_form ? value * 17 : value);
  };
  return Rgba8{channel(3), channel(2), channel(1), channel(0)};
}

}  // namespace

Size parseSize(std::string_view option, std::string_view text) {
  const std::size_t x = text.find('x');
  if (x != std::string_view::npos) {
    const auto width = toNumber<std::int64_t>(text.substr(0, x));
    const auto height = toNumber<std::int64_t>(text.substr(x + 1));
    constexpr std::int64_t kMax = raster::kMaxTargetSize;
    if (width && height && *width >= 1 && *width <= kMax && *height >= 1 && *height <= kMax)
      return {static_cast<int>(*width), static_cast<int>(*height)};
  }
  refuse(option, text, fmt::format("WIDTHxHEIGHT, each 1 to {} pixels", raster::kMaxTargetSize));
}

double parseNumber(std::string_view option, std::string_view text, double min, double max) {
  const auto value = toNumber<double>(text);
  if (!value || !(*value >= min && *value <= max))
    refuse(option, text, fmt::format("a number from {} to {}", min, max));
  return *value;
}

std::vector<double> parseList(std::string_view option, std::string_view text, std::size_t least, std::size_t most,
                              double min, double max) {
  std::vector<double> values;
  bool valid = true;
  for (std::size_t begin = 0; valid && begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const auto value = toNumber<double>(text.substr(begin, end - begin));
    valid = value && *value >= min && *value <= max;
    values.push_back(value.value_or(0.0));
    begin = end + 1;
  }
  if (!valid || values.size() < least || values.size() > most)
    refuse(option, text, fmt::format("{} to {} numbers from {} to {}, with commas between", least, most, min, max));
  return values;
}

DVec3 parseVector(std::string_view option, std::string_view text) {
  const auto v = toNumbers<3>(text);
  if (!v) refuse(option, text, "X,Y,Z");
  return {(*v)[0], (*v)[1], (*v)[2]};
}

Orbit parseOrbit(std::string_view option, std::string_view text) {
  const auto v = toNumbers<2>(text);
  if (!v || !(std::abs((*v)[1]) < 90.0))
    refuse(option, text, "AZIMUTH,ELEVATION in degrees, the elevation between -90 and 90");
  return {radians((*v)[0]), radians((*v)[1])};
}

Rgba8 parseColor(std::string_view option, std::string_view text) {
  for (const auto& [name, color] : kColorNames)
    if (name == text) return color;
  if (text.starts_with('#'))
    if (const auto color = toHexColor(text.substr(1))) return *color;
  std::string names;
  for (const auto& named : kColorNames) names += fmt::format(" {}", named.first);
  refuse(option, text, fmt::format("#rgb, #rgba, #rrggbb, #rrggbbaa or one of{}", names));
}

Up parseUp(std::string_view option, std::string_view text) {
  if (text == "y") return {};
  if (text == "z") return {true, std::nullopt};
  const auto v = toNumbers<3>(text);
  if (!v) refuse(option, text, "y or z (the file's up axis) or X,Y,Z (the camera's up direction)");
  const DVec3 direction((*v)[0], (*v)[1], (*v)[2]);
  if (direction == DVec3(0.0)) refuse(option, text, "a direction that is not zero");
  return {false, direction};
}

PixelLimit parsePixelLimit(std::string_view option, std::string_view text) {
  const bool percent = text.ends_with('%');
  const auto value = toNumber<double>(percent ? text.substr(0, text.size() - 1) : text);
  const bool valid =
      value && *value >= 0.0 && (percent ? *value <= 100.0 : *value == std::floor(*value) && std::isfinite(*value));
  if (!valid) refuse(option, text, "a number of pixels or a percentage (0.02%)");
  return {*value, percent};
}

double parseFraction(std::string_view option, std::string_view text) {
  const bool percent = text.ends_with('%');
  const auto value = toNumber<double>(percent ? text.substr(0, text.size() - 1) : text);
  if (!value || !(*value >= 0.0 && *value <= (percent ? 100.0 : 1.0)))
    refuse(option, text, "a percentage (0.5%) or a fraction (0.005), at most 100%");
  return percent ? *value / 100.0 : *value;
}

std::int64_t parseWhole(std::string_view option, std::string_view text, std::int64_t min, std::int64_t max) {
  const auto value = toNumber<std::int64_t>(text);
  if (!value || *value < min || *value > max)
    refuse(option, text, fmt::format("a whole number from {} to {}", min, max));
  return *value;
}

}  // namespace sheaf::cli
