// grouping/byte_stream: plain values into bytes and, distrustfully, back.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace sheaf::grouping {

static_assert(std::endian::native == std::endian::little, "files are little-endian, and written as they lie in memory");

class ByteWriter {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  template <class T>
  void putAll(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }
  /// 7 bits to a byte, low ones first; the top bit says that more follow.
  void putVariable(std::uint32_t value) {
    for (; value >= 0x80U; value >>= 7U) bytes_.push_back(static_cast<char>(value | 0x80U));
    bytes_.push_back(static_cast<char>(value));
  }
  void putText(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    bytes_.append(text);
  }
  /// `count` bits, packed without gaps until alignBits().
  void putBits(std::uint32_t value, int count) {
    pending_ |= std::uint64_t{value} << pending_count_;
    for (pending_count_ += count; pending_count_ >= 8; pending_count_ -= 8, pending_ >>= 8U)
      bytes_.push_back(static_cast<char>(pending_ & 0xFFU));
  }
  void alignBits() {
    if (pending_count_ > 0) bytes_.push_back(static_cast<char>(pending_));
    pending_ = 0, pending_count_ = 0;
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  std::uint64_t pending_ = 0;
  int pending_count_ = 0;
};

/// Reads past the end give 0 and set failed().
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <class T>
  T get() {
    static_assert(std::is_trivially_copyable_v<T>);
    T value{};
    if (const std::string_view raw = take(sizeof(T)); !raw.empty()) std::memcpy(&value, raw.data(), sizeof(T));
    return value;
  }
  template <class T>
  void getAll(std::span<T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (const std::string_view raw = take(values.size_bytes()); !raw.empty())
      std::memcpy(values.data(), raw.data(), raw.size());
  }
  std::uint32_t getVariable() {
    std::uint32_t value = 0;
    for (int shift = 0; shift < 35; shift += 7) {
      const auto byte = get<std::uint8_t>();
      value |= (byte & 0x7FU) << shift;
      if (byte < 0x80U) return value;
    }
    failed_ = true;  // no number of 32 bits is that long
    return 0;
  }
  std::string getText() { return std::string(take(get<std::uint32_t>())); }
  std::uint32_t getBits(int count) {
    while (pending_count_ < count) {
      pending_ |= std::uint64_t{get<std::uint8_t>()} << pending_count_;
      pending_count_ += 8;
    }
    const auto value = static_cast<std::uint32_t>(pending_ & ((std::uint64_t{1} << count) - 1));
    pending_ >>= count;
    pending_count_ -= count;
    return value;
  }
  void alignBits() { pending_ = 0, pending_count_ = 0; }

  std::size_t left() const { return bytes_.size(); }
  bool failed() const { return failed_; }

 private:
  std::string_view take(std::size_t count) {
    if (count > bytes_.size()) failed_ = true, bytes_ = {};
    const std::string_view raw = bytes_.substr(0, std::min(count, bytes_.size()));
    bytes_.remove_prefix(raw.size());
    return raw;
  }

  std::string_view bytes_;
  std::uint64_t pending_ = 0;
  int pending_count_ = 0;
  bool failed_ = false;
};

}  // namespace sheaf::grouping
