#include "scenes/text_scanner.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string>
#include <system_error>

#include "scenes/import.h"

namespace sheaf::scenes {
namespace {

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\0';
}
bool isLineEnd(char c) {
  return c == '\n' || c == '\r';
}

}  // namespace

bool parseFloat(std::string_view word, float& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error == std::errc() && stop == end) return true;
  if (error != std::errc::result_out_of_range || stop != end) return false;
  // Too small or too large for a float: strtod says which.
  value = static_cast<float>(std::strtod(std::string(word).c_str(), nullptr));
  return true;
}

bool parseInteger(std::string_view word, std::int64_t& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && stop == word.data() + word.size();
}

bool equalNoCase(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return lower(x) == lower(y); });
}

bool TextScanner::skipLineEnd() {
  if (at_ == text_.size() || !isLineEnd(text_[at_])) return false;
  if (text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n') ++at_;
  ++at_;
  ++line_;
  return true;
}

bool TextScanner::atLineEnd() {
  while (at_ < text_.size() && isBlank(text_[at_])) ++at_;
  return at_ == text_.size() || isLineEnd(text_[at_]) || (comment_ != '\0' && text_[at_] == comment_);
}

void TextScanner::skipLine() {
  while (at_ < text_.size() && !isLineEnd(text_[at_])) ++at_;
  skipLineEnd();
}

bool TextScanner::atEnd() {
  while (atLineEnd()) {
    if (at_ == text_.size()) return true;
    skipLine();
  }
  return false;
}

std::string_view TextScanner::restOfLine() {
  while (at_ < text_.size() && isBlank(text_[at_])) ++at_;
  const std::size_t begin = at_;
  while (at_ < text_.size() && !isLineEnd(text_[at_])) ++at_;
  std::size_t end = at_;
  while (end > begin && isBlank(text_[end - 1])) --end;
  return text_.substr(begin, end - begin);
}

std::string_view TextScanner::word(std::string_view what) {
  if (atEnd()) fail(fmt::format("the file ends where {} is expected", what));
  const std::size_t begin = at_;
  while (at_ < text_.size() && !isBlank(text_[at_]) && !isLineEnd(text_[at_])) ++at_;
  return text_.substr(begin, at_ - begin);
}

float TextScanner::number(std::string_view what) {
  const std::string_view w = word(what);
  float value = 0.0F;
  if (!parseFloat(w, value)) fail(fmt::format("'{}' is not a number ({} is expected)", printable(w), what));
  return value;
}

std::int64_t TextScanner::integer(std::string_view what) {
  const std::string_view w = word(what);
  std::int64_t value = 0;
  if (!parseInteger(w, value)) fail(fmt::format("'{}' is not a whole number ({} is expected)", printable(w), what));
  return value;
}

void TextScanner::fail(std::string_view reason) const {
  refuse(fmt::format("{}:{}", file_name_, line_), reason);
}

}  // namespace sheaf::scenes
