// grouping/sealed_file: what sheaf's own binary files begin with: magic, version, size of the content and CRC-32 of all
// other bytes; little-endian.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace sheaf::grouping {

struct FileKind {
  std::string_view magic;  ///< 8 bytes
  std::uint32_t version = 0;
  std::string_view what;  ///< "vertex groups", for messages
};

/// The whole file.
std::string sealed(const FileKind& kind, std::string_view content);

/// The content, part of `bytes`. Throws Error: kBadInput "name: reason" for another kind of file and for one of which
/// any byte was changed, left out or added; kUnsupported for another version.
std::string_view unsealed(const FileKind& kind, std::string_view bytes, std::string_view name);

}  // namespace sheaf::grouping
