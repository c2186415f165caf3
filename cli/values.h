// cli/values: the values of options, from text. Every function names the option in its complaint and throws
// Error(kUsage).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/image.h"
#include "core/math.h"

namespace sheaf::cli {

struct Size {
  int width = 0;
  int height = 0;
};

/// `WIDTHxHEIGHT`, each 1 to 16384.
Size parseSize(std::string_view option, std::string_view text);

/// A finite number in [min, max].
double parseNumber(std::string_view option, std::string_view text, double min, double max);

/// `A,B,...`: at least `least` and at most `most` numbers in [min, max].
std::vector<double> parseList(std::string_view option, std::string_view text, std::size_t least, std::size_t most,
                              double min, double max);

/// `X,Y,Z`, finite.
DVec3 parseVector(std::string_view option, std::string_view text);

struct Orbit {
  double azimuth_rad = 0.0;
  double elevation_rad = 0.0;
};

/// `AZIMUTH,ELEVATION` in degrees; the elevation lies between -90 and 90, ends not included.
Orbit parseOrbit(std::string_view option, std::string_view text);

/// A name ("transparent", "white", ...), #rgb, #rgba, #rrggbb or #rrggbbaa: sRGB-coded, straight alpha.
Rgba8 parseColor(std::string_view option, std::string_view text);

/// `y`, `z`: the up axis of the file; or `X,Y,Z`: the up direction of the camera, not zero.
struct Up {
  bool z_axis = false;
  std::optional<DVec3> direction;
};
Up parseUp(std::string_view option, std::string_view text);

/// `N` pixels or `P%` of all pixels.
struct PixelLimit {
  double value = 0.0;
  bool percent = false;
};
PixelLimit parsePixelLimit(std::string_view option, std::string_view text);

/// `0.5%` or `0.005`, both 0.005; in [0, 1].
double parseFraction(std::string_view option, std::string_view text);

/// A whole number in [min, max].
std::int64_t parseWhole(std::string_view option, std::string_view text, std::int64_t min, std::int64_t max);

}  // namespace sheaf::cli
