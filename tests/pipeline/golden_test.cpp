// Small pictures of every built-in scene, kept in tests/golden. SHEAF_UPDATE_GOLDEN=1 in the environment writes them
// anew.
#include <doctest/doctest.h>

#include <bit>
#include <cstdlib>
#include <filesystem>

#include "raster/image_compare.h"
#include "raster/image_io.h"
#include "tests/pipeline/scene_fixture.h"

namespace sheaf::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 131;
constexpr int kHeight = 97;

// A 32-bit word per pixel as the four bytes of a picture.
template <typename Pixel>
Image8 asBytes(const Image<Pixel>& words) {
  Image8 bytes(words.width(), words.height());
  for (std::size_t i = 0; i < words.pixels().size(); ++i)
    bytes.pixels()[i] = std::bit_cast<Rgba8>(std::bit_cast<std::uint32_t>(words.pixels()[i]));
  return bytes;
}

// Instance and triangle in one word; no golden scene has more than 2^16 of each.
ImageU32 idWords(const Frame& frame) {
  ImageU32 words(frame.instance_id.width(), frame.instance_id.height());
  for (std::size_t i = 0; i < words.pixels().size(); ++i) {
    const std::uint32_t instance = frame.instance_id.pixels()[i];
    words.pixels()[i] = instance == raster::kNoTriangle ? instance : instance << 16 | frame.triangle_id.pixels()[i];
  }
  return words;
}

// max_error and max_fraction bound how many pixels may be off and by how much; 0 for what must be equal.
void compareWithGolden(const std::string& name, const Image8& actual, int max_error, double max_fraction,
                       TaskPool& pool) {
  const fs::path golden = fs::path(SHEAF_GOLDEN_DIR) / name;
  if (std::getenv("SHEAF_UPDATE_GOLDEN") != nullptr) {
    fs::create_directories(golden.parent_path());
    raster::writePng(golden, actual, pool);
    MESSAGE("wrote " << golden.string());
    return;
  }
  const Image8 expected = raster::readImage(golden);
  REQUIRE(expected.width() == actual.width());
  REQUIRE(expected.height() == actual.height());
  const raster::ImageDifference difference = raster::compareImages(expected, actual);
  const bool good = difference.max_error <= max_error && difference.differingFraction() <= max_fraction;
  if (!good) {
    const fs::path folder = fs::path(SHEAF_GOLDEN_FAILURE_DIR) / fs::path(name).parent_path();
    fs::create_directories(folder);
    raster::writePng(folder / ("actual-" + fs::path(name).filename().string()), actual, pool);
    raster::writePng(folder / ("heat-" + fs::path(name).filename().string()), raster::heatMap(expected, actual), pool);
    MESSAGE("actual and heat map are in " << folder.string());
  }
  CAPTURE(name);
  CAPTURE(difference.differing_pixels);
  CAPTURE(difference.max_error);
  if (difference.first) {
    CAPTURE(difference.first->x);
    CAPTURE(difference.first->y);
    CHECK(good);
  }
  CHECK(good);
}

}  // namespace

TEST_CASE("pipeline/golden: built-in scenes look as they did") {
  struct Golden {
    const char* name;
    const char* spec;
    bool inside;
  };
  TaskPool pool(2);
  for (const Golden& golden :
       {Golden{"gallery", "gallery", false}, Golden{"teapot", "teapot?n=8", false},
        Golden{"sphere", "sphere?n=16", false}, Golden{"torusknot", "torusknot?u=128&v=16", false},
        Golden{"terrain", "terrain?n=97", false}, Golden{"terrain-inside", "terrain?n=97", true},
        Golden{"city", "city?blocks=4", false}, Golden{"city-inside", "city?blocks=4", true},
        Golden{"cornell", "cornell", false}, Golden{"fill", "fill?layers=3", false}}) {
    CAPTURE(golden.name);
    scenes::Scene scene = scenes::buildBuiltin(golden.spec);
    const scenes::Camera camera =
        golden.inside ? insideCamera(scene) : usualCamera(scene, static_cast<double>(kWidth) / kHeight);
    const ReadyScene ready = makeReady(std::move(scene), camera, pool);
    Frame frame;
    Renderer(pool).render(ready.prepared, camera, allChannels(kWidth, kHeight), frame);
    const std::string folder = golden.name;
    compareWithGolden(folder + "/id.png", asBytes(idWords(frame)), 0, 0.0, pool);
    compareWithGolden(folder + "/depth.png", asBytes(frame.depth), 0, 0.0, pool);
    compareWithGolden(folder + "/color.png", frame.color, 3, 0.0002, pool);
  }
}

}  // namespace sheaf::pipeline
