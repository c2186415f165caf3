// tests/grouping/reseal: forged files of sheaf's own kinds.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <string>

namespace sheaf::grouping {

inline constexpr std::size_t kChecksumAt = 20, kContentAt = 24;

// A damaged file whose checksum has been put right.
inline std::string resealed(std::string bytes) {
  const auto* raw = reinterpret_cast<const Bytef*>(bytes.data());
  uLong crc = crc32(crc32(0, nullptr, 0), raw, kChecksumAt);
  crc = crc32(crc, raw + kContentAt, static_cast<uInt>(bytes.size() - kContentAt));
  const auto sum = static_cast<std::uint32_t>(crc);
  std::memcpy(bytes.data() + kChecksumAt, &sum, sizeof sum);
  return bytes;
}

}  // namespace sheaf::grouping
