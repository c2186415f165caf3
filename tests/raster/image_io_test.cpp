#include "raster/image_io.h"

#include <doctest/doctest.h>
#include <zlib.h>

#include <cstring>
#include <random>

#include "core/error.h"
#include "raster/image_compare.h"
#include "raster/srgb.h"
#include "tests/temp_folder.h"

namespace sheaf::raster {
namespace {

Image8 randomImage(int width, int height, bool opaque, unsigned seed) {
  std::mt19937 rng(seed);
  Image8 image(width, height);
  for (Rgba8& p : image.pixels()) {
    const auto bits = static_cast<std::uint32_t>(rng());
    p = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8), static_cast<std::uint8_t>(bits >> 16),
         opaque ? std::uint8_t{255} : static_cast<std::uint8_t>(bits >> 24)};
  }
  return image;
}

std::string encoded(const Image8& image, TaskPool& pool) {
  std::string bytes;
  encodePng(image, pool, [&](std::string_view piece) { bytes += piece; });
  return bytes;
}

template <typename Call>
ErrorCode codeOf(const Call& call) {
  try {
    call();
  } catch (const Error& e) {
    INFO(e.what());
    CHECK(std::string(e.what()).find('\n') == std::string::npos);
    return e.code();
  }
  FAIL("no error");
  return ErrorCode::kInternal;
}

std::uint32_t bigEndian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

bool moduleBuilt() {
#ifdef SHEAF_TEST_MODULE_DIR
  setenv("SHEAF_MODULE_DIR", SHEAF_TEST_MODULE_DIR, 1);
  return true;
#else
  return false;
#endif
}

}  // namespace

TEST_CASE("raster/image_io: a PNG gives back every pixel, opaque or not, whatever its size") {
  const TempFolder folder;
  TaskPool pool(2);
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 300}, {300, 1}, {131, 97}, {640, 700}})
    for (const bool opaque : {true, false}) {
      CAPTURE(width);
      CAPTURE(height);
      CAPTURE(opaque);
      const Image8 image = randomImage(width, height, opaque, 0x5eed);
      writePng(folder.file("a.png"), image, pool);
      CHECK(readImage(folder.file("a.png")) == image);
    }
}

TEST_CASE("raster/image_io: a row longer than a strip is written whole") {
  TaskPool pool(3);
  const TempFolder folder;
  const Image8 image(16384, 40, {1, 2, 3, 4});
  writePng(folder.file("wide.png"), image, pool);
  CHECK(readImage(folder.file("wide.png")) == image);
}

TEST_CASE("raster/image_io: PNG bytes are the same for any number of threads") {
  const Image8 image = randomImage(700, 900, true, 7);
  TaskPool one(1);
  const std::string expected = encoded(image, one);
  for (const int threads : {2, 7}) {
    TaskPool pool(threads);
    CHECK(encoded(image, pool) == expected);
  }
}

TEST_CASE("raster/image_io: every chunk of a PNG has the right checksum, and the file ends with IEND") {
  TaskPool pool(2);
  const std::string bytes = encoded(randomImage(600, 700, false, 3), pool);
  REQUIRE(bytes.starts_with("\x89PNG\r\n\x1a\n"));
  std::size_t at = 8;
  std::string last;
  while (at < bytes.size()) {
    REQUIRE(at + 12 <= bytes.size());
    const std::uint32_t length = bigEndian(bytes, at);
    REQUIRE(at + 12 + length <= bytes.size());
    last = bytes.substr(at + 4, 4);
    const auto* data = reinterpret_cast<const Bytef*>(bytes.data() + at + 4);
    CHECK(bigEndian(bytes, at + 8 + length) == crc32(crc32(0, nullptr, 0), data, length + 4));
    at += 12 + length;
  }
  CHECK(last == "IEND");
}

TEST_CASE("raster/image_io: an opaque picture is written without alpha") {
  TaskPool pool(1);
  constexpr std::size_t kColorType = 8 + 8 + 9;
  CHECK(encoded(Image8(3, 3, {1, 2, 3, 255}), pool)[kColorType] == 2);
  CHECK(encoded(Image8(3, 3, {1, 2, 3, 254}), pool)[kColorType] == 6);
}

TEST_CASE("raster/image_io: a JPEG is close to what was written") {
  const TempFolder folder;
  TaskPool pool(1);
  Image8 image(64, 48);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x)
      image.at(x, y) = {static_cast<std::uint8_t>(4 * x), static_cast<std::uint8_t>(5 * y), 90, 255};
  writePicture(folder.file("a.jpg"), {.srgb = &image}, pool);
  CHECK(compareImages(readImage(folder.file("a.jpg")), image).psnr_db > 35.0);
}

TEST_CASE("raster/image_io: an extension that is not known is refused, with those that are") {
  CHECK(codeOf([] { formatOf("a.xyz"); }) == ErrorCode::kUsage);
  CHECK(codeOf([] { formatOf("noextension"); }) == ErrorCode::kUsage);
  CHECK(formatOf("A.PNG").name == "PNG");
  CHECK(!formatOf("a.jpeg").alpha);
  CHECK(formatOf("a.exr").linear);
}

TEST_CASE("raster/image_io: what is not a picture is refused: missing, empty, a folder, text, cut off") {
  const TempFolder folder;
  TaskPool pool(1);
  CHECK(codeOf([&] { readImage(folder.file("missing.png")); }) == ErrorCode::kBadInput);
  CHECK(codeOf([&] { readImage(folder.path()); }) == ErrorCode::kBadInput);
  folder.write("empty.png", "");
  CHECK(codeOf([&] { readImage(folder.file("empty.png")); }) == ErrorCode::kBadInput);
  folder.write("text.png", "this is not a picture");
  CHECK(codeOf([&] { readImage(folder.file("text.png")); }) == ErrorCode::kBadInput);
  const std::string whole = encoded(randomImage(40, 40, true, 1), pool);
  for (const std::size_t keep : {9UL, 20UL, 60UL, whole.size() / 2, whole.size() - 14}) {
    CAPTURE(keep);
    folder.write("cut.png", whole.substr(0, keep));
    CHECK(codeOf([&] { readImage(folder.file("cut.png")); }) == ErrorCode::kBadInput);
  }
}

TEST_CASE("raster/image_io: a PNG that claims to be huge is refused before memory is taken for it") {
  const TempFolder folder;
  TaskPool pool(1);
  std::string bytes = encoded(Image8(4, 4), pool);
  bytes[16] = 0x00;
  bytes[17] = 0x01;  // 65540 pixels wide
  folder.write("huge.png", bytes);
  CHECK_THROWS_WITH_AS(readImage(folder.file("huge.png")), doctest::Contains("too large: 65540x4"), Error);
}

TEST_CASE("raster/image_io: a file that cannot be written leaves nothing behind") {
  const TempFolder folder;
  TaskPool pool(1);
  const Image8 image(4, 4);
  CHECK(codeOf([&] { writePng(folder.file("no/such/a.png"), image, pool); }) == ErrorCode::kBadInput);
  CHECK(codeOf([&] { writePng(folder.path(), image, pool); }) == ErrorCode::kBadInput);
  CHECK(folder.fileCount() == 0);
}

TEST_CASE("raster/image_io: a full disk is noticed") {
  if (!std::filesystem::exists("/dev/full")) return;
  const TempFolder folder;
  TaskPool pool(1);
  std::filesystem::create_symlink("/dev/full", folder.file("a.png"));
  CHECK(codeOf([&] { writePng(folder.file("a.png"), randomImage(200, 200, true, 2), pool); }) == ErrorCode::kBadInput);
}

TEST_CASE("raster/image_io: an existing file is replaced as a whole") {
  const TempFolder folder;
  TaskPool pool(1);
  folder.write("a.png", std::string(100000, 'x'));
  const Image8 image(4, 4, {9, 8, 7, 255});
  writePng(folder.file("a.png"), image, pool);
  CHECK(readImage(folder.file("a.png")) == image);
  CHECK(folder.fileCount() == 1);
}

TEST_CASE("raster/image_io: an EXR keeps linear colours and further channels") {
  if (!moduleBuilt()) return;
  const TempFolder folder;
  TaskPool pool(1);
  ImageF4 linear(5, 3);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 5; ++x)
      linear.at(x, y) = Vec4(0.1F * static_cast<float>(x), 0.2F * static_cast<float>(y), 0.5F, 1.0F);
  linear.at(4, 2) = Vec4(0.25F, 0.0F, 0.5F, 0.5F);  // premultiplied: straight (0.5, 0, 1)
  const ImageF depth(5, 3, 2.5F);
  const ImageU32 ids(5, 3, 0xFFFFFFFFU);
  writePicture(folder.file("a.exr"), {.linear = &linear, .depth = &depth, .instance_id = &ids, .triangle_id = &ids},
               pool);
  const std::string bytes = folder.read("a.exr");
  for (const char* channel : {"instance_id", "triangle_id"}) CHECK(bytes.find(channel) != std::string::npos);
  const Image8 back = readImage(folder.file("a.exr"));
  REQUIRE(back.width() == 5);
  REQUIRE(back.height() == 3);
  CHECK(back.at(2, 1) == Rgba8{encodeSrgb(0.2F), encodeSrgb(0.2F), encodeSrgb(0.5F), 255});
  CHECK(back.at(4, 2) == Rgba8{encodeSrgb(0.5F), 0, 255, 128});
}

TEST_CASE("raster/image_io: TIFF and Targa keep 8-bit pixels with straight alpha") {
  if (!moduleBuilt()) return;
  const TempFolder folder;
  TaskPool pool(1);
  const Image8 image = randomImage(33, 17, false, 11);
  for (const char* name : {"a.tif", "a.tga"}) {
    CAPTURE(name);
    writePicture(folder.file(name), {.srgb = &image}, pool);
    CHECK(readImage(folder.file(name)) == image);
  }
}

TEST_CASE("raster/image_io: formats without alpha keep the colours") {
  if (!moduleBuilt()) return;
  const TempFolder folder;
  TaskPool pool(1);
  const Image8 image = randomImage(33, 17, true, 12);
  for (const char* name : {"a.bmp", "a.ppm"}) {
    CAPTURE(name);
    writePicture(folder.file(name), {.srgb = &image}, pool);
    CHECK(readImage(folder.file(name)) == image);
  }
}

TEST_CASE("raster/image_io: the module reports what is wrong with a file, and leaves nothing behind") {
  if (!moduleBuilt()) return;
  const TempFolder folder;
  TaskPool pool(1);
  folder.write("text.exr", "not an EXR");
  CHECK(codeOf([&] { readImage(folder.file("text.exr")); }) == ErrorCode::kBadInput);
  CHECK(codeOf([&] { readImage(folder.file("missing.exr")); }) == ErrorCode::kBadInput);
  const ImageF4 linear(2, 2);
  CHECK(codeOf([&] { writePicture(folder.file("no/a.exr"), {.linear = &linear}, pool); }) == ErrorCode::kBadInput);
  CHECK(folder.fileCount() == 1);
}

}  // namespace sheaf::raster
