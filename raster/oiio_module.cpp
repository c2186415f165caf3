#include "raster/oiio_module.h"

#include <OpenImageIO/imageio.h>

#include <cstring>
#include <exception>

namespace sheaf::raster {
namespace {

using OIIO::ImageInput;
using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

void addChannel(ImageSpec& spec, const char* name, TypeDesc type) {
  spec.channelnames.emplace_back(name);
  spec.channelformats.push_back(type);
  ++spec.nchannels;
}

ImageSpec specOf(const OiioPicture& picture) {
  const TypeDesc color_type = picture.srgb ? TypeDesc::UINT8 : TypeDesc::FLOAT;
  ImageSpec spec(picture.width, picture.height, picture.color_channels, color_type);
  spec.attribute("oiio:ColorSpace", picture.srgb ? "sRGB" : "Linear");
  if (picture.srgb) spec.attribute("oiio:UnassociatedAlpha", 1);
  if (!picture.depth && !picture.instance_id && !picture.triangle_id) return spec;
  spec.channelformats.assign(static_cast<std::size_t>(spec.nchannels), color_type);
  if (picture.depth) {
    spec.z_channel = spec.nchannels;
    addChannel(spec, "Z", TypeDesc::FLOAT);
  }
  if (picture.instance_id) addChannel(spec, "instance_id", TypeDesc::UINT32);
  if (picture.triangle_id) addChannel(spec, "triangle_id", TypeDesc::UINT32);
  return spec;
}

/// Channels of different kinds are written row by row, packed: all of them take four bytes.
bool writeMixedRows(ImageOutput& out, const OiioPicture& picture) {
  const ImageSpec& spec = out.spec();
  const auto width = static_cast<std::size_t>(picture.width);
  std::vector<unsigned char> row(width * static_cast<std::size_t>(spec.nchannels) * 4);
  for (int y = 0; y < picture.height; ++y) {
    unsigned char* to = row.data();
    const auto put = [&](const void* from, std::size_t values) {
      std::memcpy(to, from, 4 * values);
      to += 4 * values;
    };
    for (std::size_t i = static_cast<std::size_t>(y) * width, end = i + width; i < end; ++i) {
      put(picture.linear + 4 * i, static_cast<std::size_t>(picture.color_channels));
      if (picture.depth) put(picture.depth + i, 1);
      if (picture.instance_id) put(picture.instance_id + i, 1);
      if (picture.triangle_id) put(picture.triangle_id + i, 1);
    }
    if (!out.write_scanline(y, 0, TypeDesc::UNKNOWN, row.data())) return false;
  }
  return true;
}

bool writeRows(ImageOutput& out, const OiioPicture& picture) {
  if (!out.spec().channelformats.empty()) return writeMixedRows(out, picture);
  // A stride of four values per pixel also where the file takes only three of them.
  if (picture.srgb) return out.write_image(TypeDesc::UINT8, picture.srgb, 4);
  return out.write_image(TypeDesc::FLOAT, picture.linear, 4 * sizeof(float));
}

std::string writeFile(const std::string& path, const OiioPicture& picture) try {
  const auto out = ImageOutput::create(path);
  if (!out) return OIIO::geterror();
  if (!out->open(path, specOf(picture)) || !writeRows(*out, picture) || !out->close()) return out->geterror();
  return {};
} catch (const std::exception& e) {
  return e.what();
}

template <typename T>
bool readPixels(ImageInput& in, TypeDesc type, T opaque, std::vector<T>& pixels) {
  const ImageSpec spec = in.spec();
  const std::size_t count = spec.image_pixels();
  const int channels = std::min(spec.nchannels, 4);
  pixels.assign(4 * count, opaque);
  if (!in.read_image(0, 0, 0, channels, type, pixels.data(), 4 * sizeof(T))) return false;
  if (channels > 2) return true;
  for (std::size_t i = 0; i < count; ++i) {  // grey, with or without alpha
    T* p = pixels.data() + 4 * i;
    if (channels == 2) p[3] = p[1];
    p[1] = p[2] = p[0];
  }
  return true;
}

std::string readFile(const std::string& path, int max_side, std::int64_t max_pixels, OiioLoaded& loaded) try {
  ImageSpec hints;
  hints.attribute("oiio:UnassociatedAlpha", 1);
  const auto in = ImageInput::open(path, &hints);
  if (!in) return OIIO::geterror();
  const ImageSpec& spec = in->spec();
  if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1) return "is not a flat picture";
  if (spec.width > max_side || spec.height > max_side || std::int64_t{spec.width} * spec.height > max_pixels)
    return "is too large: " + std::to_string(spec.width) + "x" + std::to_string(spec.height);
  loaded.width = spec.width;
  loaded.height = spec.height;
  const bool read = spec.format.is_floating_point() ? readPixels(*in, TypeDesc::FLOAT, 1.0F, loaded.linear)
                                                    : readPixels(*in, TypeDesc::UINT8, std::uint8_t{255}, loaded.srgb);
  return read ? std::string() : in->geterror();
} catch (const std::exception& e) {
  return e.what();
}

constexpr OiioModule kModule{kOiioModuleVersion, writeFile, readFile};

}  // namespace
}  // namespace sheaf::raster

extern "C" __attribute__((visibility("default"))) const sheaf::raster::OiioModule* sheafOiioModule() {
  return &sheaf::raster::kModule;
}
