// Small files for the importers' tests, made by the tests themselves.
#pragma once

#include <doctest/doctest.h>
#include <unistd.h>

#include <bit>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/file.h"
#include "scenes/scene.h"

namespace sheaf::scenes {

/// A folder of its own, removed at the end of the test.
class TestFolder {
 public:
  TestFolder() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("sheaf_import_" + std::to_string(getpid()) + "_" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~TestFolder() {
    std::error_code ec;
    std::filesystem::remove_all(path_, ec);
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  std::string write(const std::string& name, std::string_view bytes) const {
    const std::filesystem::path path = path_ / name;
    std::filesystem::create_directories(path.parent_path());
    writeFile(path, bytes);
    return path.string();
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline Scene loadText(const std::string& name, std::string_view bytes, const ImportOptions& options = {}) {
  const TestFolder folder;
  return loadScene(folder.write(name, bytes), options);
}

/// The text of the Error that loading ends with, without the folder; the code is checked.
inline std::string refusal(const std::string& name, std::string_view bytes, ErrorCode code = ErrorCode::kBadInput) {
  const TestFolder folder;
  const std::string path = folder.write(name, bytes);
  try {
    loadScene(path);
  } catch (const Error& e) {
    CHECK(e.code() == code);
    std::string text = e.what();
    CHECK(text.find('\n') == std::string::npos);
    CHECK(text.starts_with(path));
    return text.substr(std::min(text.size(), folder.path().string().size() + 1));
  }
  return "(loaded)";
}

inline bool anyContains(const std::vector<std::string>& lines, std::string_view part) {
  for (const std::string& line : lines)
    if (line.find(part) != std::string::npos) return true;
  return false;
}

/// Appends numbers as a binary file has them.
class ByteWriter {
 public:
  explicit ByteWriter(bool big_endian = false) : big_endian_(big_endian) {}

  ByteWriter& u8(std::uint32_t v) { return put(v, 1); }
  ByteWriter& u16(std::uint32_t v) { return put(v, 2); }
  ByteWriter& u32(std::uint32_t v) { return put(v, 4); }
  ByteWriter& f32(float v) { return put(std::bit_cast<std::uint32_t>(v), 4); }
  ByteWriter& vec(const Vec3& v) { return f32(v.x).f32(v.y).f32(v.z); }
  ByteWriter& text(std::string_view t) {
    bytes_ += t;
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  ByteWriter& put(std::uint32_t v, int size) {
    for (int i = 0; i < size; ++i) bytes_ += static_cast<char>(v >> 8 * (big_endian_ ? size - 1 - i : i));
    return *this;
  }

  std::string bytes_;
  bool big_endian_;
};

/// Wraps JSON and a binary chunk into a GLB.
inline std::string glb(std::string json, std::string bin) {
  while (json.size() % 4 != 0) json += ' ';
  while (bin.size() % 4 != 0) bin += '\0';
  ByteWriter out;
  const auto size = static_cast<std::uint32_t>(12 + 8 + json.size() + (bin.empty() ? 0 : 8 + bin.size()));
  out.text("glTF").u32(2).u32(size).u32(static_cast<std::uint32_t>(json.size())).text("JSON").text(json);
  if (!bin.empty()) out.u32(static_cast<std::uint32_t>(bin.size())).text(std::string_view("BIN\0", 4)).text(bin);
  return out.bytes();
}

inline std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = (group << 8) | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : kDigits[(group >> (18 - 6 * k)) & 63];
  }
  return out;
}

/// A 2x1 PNG: red, green.
inline std::string tinyPng() {
  // Stored (not deflated) scan line: filter 0, 3 + 3 bytes.
  const std::string raw("\x00\xFF\x00\x00\x00\xFF\x00", 7);
  const auto crc = [](std::string_view data) {
    std::uint32_t c = 0xFFFFFFFF;
    for (const char byte : data) {
      c ^= static_cast<unsigned char>(byte);
      for (int k = 0; k < 8; ++k) c = (c & 1) != 0 ? 0xEDB88320 ^ (c >> 1) : c >> 1;
    }
    return ~c;
  };
  std::uint32_t a = 1, b = 0;
  for (const char byte : raw) {
    a = (a + static_cast<unsigned char>(byte)) % 65521;
    b = (b + a) % 65521;
  }
  ByteWriter data(true);
  data.text(std::string_view("\x78\x01\x01\x07\x00\xF8\xFF", 7)).text(raw).u32(b << 16 | a);
  ByteWriter out(true);
  const auto chunk = [&](std::string_view type, const std::string& content) {
    out.u32(static_cast<std::uint32_t>(content.size())).text(type).text(content).u32(crc(std::string(type) + content));
  };
  out.text(std::string_view("\x89PNG\r\n\x1A\n", 8));
  ByteWriter header(true);
  header.u32(2).u32(1).u8(8).u8(2).u8(0).u8(0).u8(0);
  chunk("IHDR", header.bytes());
  chunk("IDAT", data.bytes());
  chunk("IEND", "");
  return out.bytes();
}

}  // namespace sheaf::scenes
