// scenes/text_scanner: words and numbers of a text file, with the line they stand on. Line ends are LF, CR LF or CR.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace sheaf::scenes {

class TextScanner {
 public:
  /// text     must outlive the scanner, as must file_name
  /// comment  starts a comment that ends with the line; '\0' = there are none
  TextScanner(std::string_view text, std::string_view file_name, char comment, int first_line = 1)
      : text_(text), file_name_(file_name), comment_(comment), line_(first_line) {}

  bool atEnd();      ///< skips white space and comments over line ends; true if nothing follows
  bool atLineEnd();  ///< skips white space within the line; true before a line end, a comment or the end of the file
  void skipLine();   ///< to the start of the next line
  std::string_view restOfLine();  ///< without white space at both ends; comments count as text

  /// The next word, on this line or a later one. Error at the end of the file: "file ends where WHAT is expected".
  std::string_view word(std::string_view what);
  float number(std::string_view what);
  std::int64_t integer(std::string_view what);

  int line() const { return line_; }  ///< counted from 1; of what was read last
  std::size_t remaining() const { return text_.size() - at_; }
  [[noreturn]] void fail(std::string_view reason) const;  ///< throws Error(kBadInput) "file:line: reason"

 private:
  bool skipLineEnd();

  std::string_view text_;
  std::string_view file_name_;
  std::size_t at_ = 0;
  char comment_;
  int line_;
};

/// The whole word as a number; inf and nan are numbers, what is too large becomes inf. False if it is none.
bool parseFloat(std::string_view word, float& value);
bool parseInteger(std::string_view word, std::int64_t& value);

/// Equal but for the case of ASCII letters.
bool equalNoCase(std::string_view a, std::string_view b);

}  // namespace sheaf::scenes
