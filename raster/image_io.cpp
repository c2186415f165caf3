#include "raster/image_io.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cctype>
#include <climits>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>

#include "core/error.h"
#include "core/file.h"
#include "raster/oiio_module.h"
#include "raster/srgb.h"

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image.h>
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace sheaf::raster {
namespace fs = std::filesystem;
namespace {

constexpr int kJpegQuality = 92;

struct KnownFormat {
  std::string_view extension;
  PictureFormat format;
};

constexpr std::array kFormats = {
    KnownFormat{".png", {.name = "PNG"}},
    KnownFormat{".jpg", {.name = "JPEG", .alpha = false}},
    KnownFormat{".jpeg", {.name = "JPEG", .alpha = false}},
    KnownFormat{".exr", {.name = "OpenEXR", .linear = true, .extra_channels = true, .module = true}},
    KnownFormat{".hdr", {.name = "Radiance HDR", .linear = true, .alpha = false, .module = true}},
    KnownFormat{".tif", {.name = "TIFF", .module = true}},
    KnownFormat{".tiff", {.name = "TIFF", .module = true}},
    KnownFormat{".tga", {.name = "Targa", .module = true}},
    KnownFormat{".bmp", {.name = "BMP", .alpha = false, .module = true}},
    KnownFormat{".webp", {.name = "WebP", .module = true}},
    KnownFormat{".ppm", {.name = "PPM", .alpha = false, .module = true}},
};

[[noreturn]] void fail(ErrorCode code, const fs::path& path, std::string_view reason) {
  throw Error(code, fmt::format("{}: {}", path.string(), reason));
}

std::optional<PictureFormat> findFormat(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const KnownFormat& known : kFormats)
    if (known.extension == extension) return known.format;
  return std::nullopt;
}

// Where the module may lie: a folder named by the user, beside the program, or where the library was installed.
std::vector<fs::path> moduleFolders() {
  std::vector<fs::path> folders;
  if (const char* named = std::getenv("SHEAF_MODULE_DIR"); named && *named) folders.emplace_back(named);
  std::error_code ec;
  if (const fs::path program = fs::read_symlink("/proc/self/exe", ec); !ec) {
    folders.push_back(program.parent_path());
    folders.push_back(program.parent_path().parent_path() / SHEAF_MODULE_INSTALL_SUBDIR);
  }
  folders.emplace_back(SHEAF_MODULE_INSTALL_DIR);
  return folders;
}

const OiioModule& loadModule(const fs::path& file_in_need) {
  static const OiioModule* module = nullptr;  // never unloaded: OpenImageIO keeps threads and caches
  if (module) return *module;
  std::string tried;
  for (const fs::path& folder : moduleFolders()) {
    const fs::path path = folder / kOiioModuleFile;
    std::error_code ec;
    if (!fs::exists(path, ec)) {
      tried += fmt::format("{}{}", tried.empty() ? "" : ", ", folder.string());
      continue;
    }
    void* const handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle) fail(ErrorCode::kUnsupported, path, fmt::format("cannot be loaded: {}", dlerror()));
    const auto entry = reinterpret_cast<OiioModuleEntry>(dlsym(handle, kOiioModuleEntry));
    if (!entry || entry()->version != kOiioModuleVersion)
      fail(ErrorCode::kUnsupported, path, "is of another version of sheaf");
    module = entry();
    return *module;
  }
  fail(ErrorCode::kUnsupported, file_in_need,
       fmt::format("this format needs the module {}, which is not in {} (SHEAF_MODULE_DIR may name its folder)",
                   kOiioModuleFile, tried));
}

std::string oneLine(std::string text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text.empty() ? "unknown reason" : text;
}

void writeThroughModule(const fs::path& path, const PictureFormat& format, const Picture& picture) {
  const OiioModule& module = loadModule(path);
  OiioPicture plain;
  plain.color_channels = format.alpha ? 4 : 3;
  if (picture.linear && (format.linear || !picture.srgb)) {
    plain.width = picture.linear->width();
    plain.height = picture.linear->height();
    plain.linear = &picture.linear->pixels().data()->x;
  } else {
    plain.width = picture.srgb->width();
    plain.height = picture.srgb->height();
    plain.srgb = &picture.srgb->pixels().data()->r;
  }
  if (format.extra_channels) {
    if (picture.depth) plain.depth = picture.depth->pixels().data();
    if (picture.instance_id) plain.instance_id = picture.instance_id->pixels().data();
    if (picture.triangle_id) plain.triangle_id = picture.triangle_id->pixels().data();
  }
  replaceFile(path, [&](const fs::path& temporary) {
    const std::string reason = module.write(temporary.string(), plain);
    if (!reason.empty()) fail(ErrorCode::kBadInput, path, fmt::format("cannot be written: {}", oneLine(reason)));
  });
}

void writeJpeg(const fs::path& path, const Image8& image) {
  std::string bytes;
  const auto append = [](void* to, void* data, int size) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
  };
  if (!stbi_write_jpg_to_func(append, &bytes, image.width(), image.height(), 4, image.pixels().data(), kJpegQuality))
    fail(ErrorCode::kInternal, path, "could not be coded as JPEG");
  writeFile(path, bytes);
}

void checkReadSize(const fs::path& path, std::int64_t width, std::int64_t height) {
  if (width > kMaxReadSide || height > kMaxReadSide || width * height > kMaxReadPixels)
    fail(ErrorCode::kBadInput, path, fmt::format("is too large: {}x{} pixels", width, height));
}

Image8 decodeWithStb(const fs::path& path) {
  const std::string bytes = readFile(path, false, INT_MAX);
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  if (size == 0) fail(ErrorCode::kBadInput, path, "is empty");
  int width = 0;
  int height = 0;
  int channels = 0;
  if (!stbi_info_from_memory(data, size, &width, &height, &channels))
    fail(ErrorCode::kBadInput, path, "is not a PNG or JPEG picture");
  checkReadSize(path, width, height);
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(data, size, &width, &height, &channels, 4), &stbi_image_free);
  if (!pixels) fail(ErrorCode::kBadInput, path, fmt::format("cannot be decoded: {}", stbi_failure_reason()));
  Image8 image(width, height);
  std::copy_n(pixels.get(), image.pixels().size_bytes(), &image.pixels().data()->r);
  return image;
}

std::uint8_t codeUnit(float value) {
  return static_cast<std::uint8_t>(std::lround(255.0F * value));
}

Rgba8 codePremultiplied(const float* p) {
  const float alpha = p[3] > 0.0F ? std::min(p[3], 1.0F) : 0.0F;
  const float straight = alpha > 0.0F ? 1.0F / alpha : 0.0F;
  return {encodeSrgb(p[0] * straight), encodeSrgb(p[1] * straight), encodeSrgb(p[2] * straight), codeUnit(alpha)};
}

Image8 readThroughModule(const fs::path& path) {
  std::error_code ec;
  if (!fs::exists(path, ec)) fail(ErrorCode::kBadInput, path, "cannot be opened: No such file or directory");
  OiioLoaded loaded;
  const std::string reason = loadModule(path).read(path.string(), kMaxReadSide, kMaxReadPixels, loaded);
  if (!reason.empty()) fail(ErrorCode::kBadInput, path, oneLine(reason));
  Image8 image(loaded.width, loaded.height);
  const std::span<Rgba8> pixels = image.pixels();
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!loaded.linear.empty()) {
      pixels[i] = codePremultiplied(loaded.linear.data() + 4 * i);
    } else {
      const std::uint8_t* p = loaded.srgb.data() + 4 * i;
      pixels[i] = {p[0], p[1], p[2], p[3]};
    }
  }
  return image;
}

}  // namespace

PictureFormat formatOf(const fs::path& path) {
  if (const auto format = findFormat(path)) return *format;
  std::string extensions;
  for (const KnownFormat& known : kFormats) extensions += fmt::format(" {}", known.extension);
  fail(ErrorCode::kUsage, path, fmt::format("unknown picture format; known extensions:{}", extensions));
}

bool hasPictureExtension(const fs::path& path) {
  return findFormat(path).has_value();
}

void checkFormatAvailable(const fs::path& path) {
  if (formatOf(path).module) loadModule(path);
}

void writePicture(const fs::path& path, const Picture& picture, TaskPool& pool) {
  const PictureFormat format = formatOf(path);
  assert(picture.srgb || picture.linear);
  if (format.module) return writeThroughModule(path, format, picture);
  assert(picture.srgb);
  if (format.name == "PNG") return writePng(path, *picture.srgb, pool);
  writeJpeg(path, *picture.srgb);
}

Image8 readImage(const fs::path& path) {
  const auto format = findFormat(path);
  return format && format->module ? readThroughModule(path) : decodeWithStb(path);
}

}  // namespace sheaf::raster
