// raster/oiio_module: the interface between the library and the module sheaf_oiio.so. Plain pointers in, plain vectors
// out; failures are text, so that no exception crosses from one shared object to the other.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sheaf::raster {

inline constexpr int kOiioModuleVersion = 1;
inline constexpr const char* kOiioModuleFile = "sheaf_oiio.so";
inline constexpr const char* kOiioModuleEntry = "sheafOiioModule";

/// Images of width * height pixels, row by row; exactly one colour is not null.
struct OiioPicture {
  int width = 0;
  int height = 0;
  const std::uint8_t* srgb = nullptr;  ///< 4 per pixel, straight alpha
  const float* linear = nullptr;       ///< 4 per pixel, premultiplied
  int color_channels = 4;              ///< 3: alpha is dropped
  const float* depth = nullptr;
  const std::uint32_t* instance_id = nullptr;
  const std::uint32_t* triangle_id = nullptr;
};

/// What was read: one of the two vectors is filled, 4 values per pixel.
struct OiioLoaded {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> srgb;  ///< straight alpha
  std::vector<float> linear;       ///< premultiplied
};

struct OiioModule {
  int version;
  /// Both return an empty text when all went well, else the reason.
  std::string (*write)(const std::string& path, const OiioPicture& picture);
  std::string (*read)(const std::string& path, int max_side, std::int64_t max_pixels, OiioLoaded& loaded);
};

using OiioModuleEntry = const OiioModule* (*)();

}  // namespace sheaf::raster
