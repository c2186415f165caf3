// core/file: whole files in and out. Every failure is an Error that names the file and the reason.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace sheaf {

/// The whole file. A file whose first two bytes are the gzip magic is unpacked (`unpack` true), to at most `max_bytes`.
/// Throws Error(kBadInput): missing, a directory, unreadable, too large, damaged gzip.
std::string readFile(const std::filesystem::path& path, bool unpack = true,
                     std::size_t max_bytes = std::size_t{16} << 30);

/// Writes through a temporary file in the same folder and renames it, so that a failure leaves nothing behind and an
/// existing file stays whole. Throws Error(kBadInput).
void writeFile(const std::filesystem::path& path, std::string_view bytes);

/// The same for a writer that wants a path: calls write(temporary path), then renames; on an exception the temporary
/// file is removed. The temporary name keeps the extension of `path`.
void replaceFile(const std::filesystem::path& path,
                 const std::function<void(const std::filesystem::path& temporary)>& write);

}  // namespace sheaf
