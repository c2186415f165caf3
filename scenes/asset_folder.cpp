#include "scenes/asset_folder.h"

#include <fmt/format.h>

// Of the formats that stb_image reads, only these two are compiled in: other decoders of it have open memory-safety
// reports. Static, since raster has a copy of its own.
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>

#include <algorithm>
#include <climits>
#include <cstring>
#include <memory>

#include "core/file.h"
#include "scenes/import.h"

namespace sheaf::scenes {
namespace fs = std::filesystem;
namespace {

constexpr int kLargestImageSide = 16384;

// "http:", "file:", and drive letters as well.
bool hasScheme(std::string_view reference) {
  const std::size_t colon = reference.find(':');
  return colon != std::string_view::npos && reference.find('/') > colon;
}

bool leadsOut(const fs::path& relative) {
  return relative.empty() || relative.is_absolute() || *relative.begin() == "..";
}

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

AssetFolder::AssetFolder(const fs::path& scene_file) : folder_(scene_file.parent_path()) {
  if (folder_.empty()) folder_ = ".";
}

std::string AssetFolder::read(std::string_view reference) const {
  const std::string shown = printable(reference);
  if (reference.empty()) refuse("(no name)", "is not a file name");
  if (reference.find('\0') != std::string_view::npos) refuse(shown, "is not a file name");
  if (hasScheme(reference)) refuse(shown, "only files in the folder of the scene are read");
  std::string text(reference);
  std::replace(text.begin(), text.end(), '\\', '/');
  const fs::path relative = fs::path(text).lexically_normal();
  if (leadsOut(relative)) refuse(shown, "lies outside the folder of the scene");
  const fs::path path = folder_ / relative;
  std::error_code ec;
  const fs::file_status status = fs::status(path, ec);
  if (!fs::exists(status)) refuse(shown, "does not exist");
  if (!fs::is_regular_file(status)) refuse(shown, "is not a file");
  const fs::path real_folder = fs::canonical(folder_, ec);
  if (ec) refuse(shown, "cannot be read");
  const fs::path real_path = fs::canonical(path, ec);
  if (ec) refuse(shown, "cannot be read");
  if (leadsOut(real_path.lexically_relative(real_folder))) refuse(shown, "lies outside the folder of the scene");
  return readFile(real_path, false);
}

std::string percentDecoded(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && hexDigit(text[i + 1]) >= 0 && hexDigit(text[i + 2]) >= 0) {
      out += static_cast<char>(hexDigit(text[i + 1]) * 16 + hexDigit(text[i + 2]));
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

Image8 decodeImage(std::string_view bytes, std::string_view name) {
  const bool png = bytes.starts_with("\x89PNG");
  const bool jpeg = bytes.starts_with("\xFF\xD8\xFF");
  if (!png && !jpeg) refuse(name, bytes.empty() ? "image is empty" : "image is neither PNG nor JPEG");
  if (bytes.size() > INT_MAX) refuse(name, "image file is too large");
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(data, size, &width, &height, &channels) == 0)
    refuse(name, fmt::format("image cannot be decoded: {}", stbi_failure_reason()));
  if (width > kLargestImageSide || height > kLargestImageSide)
    refuse(name,
           fmt::format("image of {}x{} pixels is too large (at most {} a side)", width, height, kLargestImageSide));
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(data, size, &width, &height, &channels, 4), &stbi_image_free);
  if (!pixels) refuse(name, fmt::format("image cannot be decoded: {}", stbi_failure_reason()));
  Image8 image(width, height);
  std::memcpy(image.pixels().data(), pixels.get(), image.pixels().size_bytes());
  return image;
}

}  // namespace sheaf::scenes
