#include "grouping/sealed_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <cassert>

#include "core/error.h"
#include "grouping/byte_stream.h"

namespace sheaf::grouping {
namespace {

constexpr std::size_t kMagicBytes = 8;
constexpr std::size_t kHeaderBytes = kMagicBytes + 4 + 8 + 4;  // magic, version, size of the rest, checksum

// Header, with the checksum last: it covers the bytes before and after it.
std::uint32_t checksum(std::string_view before, std::string_view after) {
  const auto add = [](uLong crc, std::string_view bytes) {
    for (std::size_t i = 0; i < bytes.size(); i += 1U << 30U) {
      const std::string_view part = bytes.substr(i, 1U << 30U);
      crc = crc32(crc, reinterpret_cast<const Bytef*>(part.data()), static_cast<uInt>(part.size()));
    }
    return crc;
  };
  return static_cast<std::uint32_t>(add(add(crc32(0, nullptr, 0), before), after));
}

}  // namespace

std::string sealed(const FileKind& kind, std::string_view content) {
  assert(kind.magic.size() == kMagicBytes);
  std::string bytes(kind.magic);
  ByteWriter header;
  header.put(kind.version);
  header.put(static_cast<std::uint64_t>(content.size()));
  bytes += header.take();
  ByteWriter sum;
  sum.put(checksum(bytes, content));
  bytes += sum.take();
  return bytes.append(content);
}

std::string_view unsealed(const FileKind& kind, std::string_view bytes, std::string_view name) {
  const auto refuse = [&](ErrorCode code, std::string_view reason) {
    throw Error(code, fmt::format("{}: {}", name, reason));
  };
  if (!bytes.starts_with(kind.magic)) refuse(ErrorCode::kBadInput, fmt::format("is not a file of {}", kind.what));
  if (bytes.size() < kHeaderBytes) refuse(ErrorCode::kBadInput, "ends within its header");
  ByteReader header(bytes.substr(kMagicBytes));
  const auto version = header.get<std::uint32_t>();
  const auto size = header.get<std::uint64_t>();
  const auto expected = header.get<std::uint32_t>();
  if (version != kind.version)
    refuse(ErrorCode::kUnsupported,
           fmt::format("has version {} of {}, this reads version {}", version, kind.what, kind.version));
  const std::string_view content = bytes.substr(kHeaderBytes);
  if (size != content.size())
    refuse(ErrorCode::kBadInput, fmt::format("has {} bytes of {} in place of {}", content.size(), kind.what, size));
  const std::uint32_t found = checksum(bytes.substr(0, kHeaderBytes - sizeof expected), content);
  if (found != expected)
    refuse(ErrorCode::kBadInput, fmt::format("is damaged: checksum {:08x} in place of {:08x}", found, expected));
  return content;
}

}  // namespace sheaf::grouping
