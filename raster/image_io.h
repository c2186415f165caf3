// raster/image_io: pictures in files. PNG and JPEG are always there; other formats (EXR, TIFF, HDR ...) go through
// OpenImageIO in a module that is loaded when the first such file is met, because linking it would cost every start of
// a program a quarter of a second.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "core/image.h"
#include "core/task_pool.h"

namespace sheaf::raster {

inline constexpr int kMaxReadSide = 32768;  ///< pixels; larger pictures are refused
inline constexpr std::int64_t kMaxReadPixels = std::int64_t{1} << 28;

/// What a picture file can hold, by its extension.
struct PictureFormat {
  std::string_view name;        ///< "PNG"
  bool linear = false;          ///< takes Picture::linear, else Picture::srgb
  bool alpha = true;            ///< has an alpha channel; without one alpha is dropped
  bool extra_channels = false;  ///< takes depth and ids beside the colour
  bool module = false;          ///< goes through OpenImageIO
};

/// Throws Error(kUsage), which lists the known extensions, for any other.
PictureFormat formatOf(const std::filesystem::path& path);

/// The extension is one of a picture format, as formatOf() knows them.
bool hasPictureExtension(const std::filesystem::path& path);

/// What is to be written: the colour image that the format takes, and for formats with extra channels whatever else is
/// not null. All images have the same size, at least 1x1.
struct Picture {
  const Image8* srgb = nullptr;           ///< sRGB-coded, straight alpha
  const ImageF4* linear = nullptr;        ///< linear, premultiplied
  const ImageF* depth = nullptr;          ///< channel Z
  const ImageU32* instance_id = nullptr;  ///< channel instance_id
  const ImageU32* triangle_id = nullptr;  ///< channel triangle_id
};

/// Writes in the format of the path's extension, through a temporary file (see replaceFile). TIFF takes either colour.
/// Throws Error: kUsage unknown extension, kBadInput unwritable, kUnsupported module not there.
void writePicture(const std::filesystem::path& path, const Picture& picture, TaskPool& pool);

/// Finds out before any work is done whether writePicture() has a chance: the extension is known, the module is there.
void checkFormatAvailable(const std::filesystem::path& path);

/// PNG, 8 bits, RGB when every pixel is opaque, else RGBA; compressed by all workers of `pool`, the same bytes for any
/// number of them. Beside the image about 2 MB per worker are used.
void writePng(const std::filesystem::path& path, const Image8& image, TaskPool& pool);

/// The same file in pieces, in order.
void encodePng(const Image8& image, TaskPool& pool, const std::function<void(std::string_view)>& sink);

/// Any readable format as 8 bits, sRGB-coded, straight alpha: 16-bit PNG is rounded down, linear floats are clamped and
/// coded. Throws Error: kBadInput missing, damaged, too large; kUnsupported module not there.
Image8 readImage(const std::filesystem::path& path);

}  // namespace sheaf::raster
