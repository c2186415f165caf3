#include "cli/values.h"

#include <doctest/doctest.h>

#include "core/error.h"

namespace sheaf::cli {

TEST_CASE("cli/values: sizes from 1x1 to 16384x16384 are understood, all else is refused with the range") {
  CHECK(parseSize("--size", "1x1").width == 1);
  CHECK(parseSize("--size", "16384x16384").height == 16384);
  CHECK(parseSize("--size", "131x97").height == 97);
  for (const char* text : {"0x0", "0x5", "5x0", "99999x1", "16385x1", "-3x4", "3", "x", "3x", "x3", "3x4x5", "3.5x4",
                           "3 x 4", "", "3X4", "99999999999999999999x1"}) {
    CAPTURE(text);
    CHECK_THROWS_WITH_AS(parseSize("--size", text), doctest::Contains("1 to 16384"), Error);
  }
}

TEST_CASE("cli/values: numbers keep to their range") {
  CHECK(parseNumber("--fov", "40", 1, 170) == 40.0);
  CHECK(parseNumber("--fov", "+4.5e1", 1, 170) == 45.0);
  for (const char* text : {"0", "171", "nan", "inf", "", "4o", "40 "}) {
    CAPTURE(text);
    CHECK_THROWS_AS(parseNumber("--fov", text, 1, 170), Error);
  }
}

TEST_CASE("cli/values: vectors have three finite numbers") {
  CHECK(parseVector("--eye", "-1,2.5,3e2") == DVec3(-1.0, 2.5, 300.0));
  for (const char* text : {"1,2", "1,2,3,4", "1,,3", "1,2,", "a,b,c", "nan,0,0", "inf,0,0", ""}) {
    CAPTURE(text);
    CHECK_THROWS_AS(parseVector("--eye", text), Error);
  }
}

TEST_CASE("cli/values: an orbit is in degrees, its elevation below 90 on either side") {
  const Orbit orbit = parseOrbit("--orbit", "-180,45");
  CHECK(orbit.azimuth_rad == doctest::Approx(-kPi));
  CHECK(orbit.elevation_rad == doctest::Approx(kPi / 4));
  for (const char* text : {"0,90", "0,-90", "0", "0,0,0", "x,1"}) {
    CAPTURE(text);
    CHECK_THROWS_AS(parseOrbit("--orbit", text), Error);
  }
}

TEST_CASE("cli/values: colours are names or hexadecimal digits") {
  CHECK(parseColor("--background", "white") == Rgba8{255, 255, 255, 255});
  CHECK(parseColor("--background", "transparent") == Rgba8{0, 0, 0, 0});
  CHECK(parseColor("--background", "#f80") == Rgba8{255, 136, 0, 255});
  CHECK(parseColor("--background", "#f808") == Rgba8{255, 136, 0, 136});
  CHECK(parseColor("--background", "#0A141e") == Rgba8{10, 20, 30, 255});
  CHECK(parseColor("--background", "#0a141e28") == Rgba8{10, 20, 30, 40});
  for (const char* text : {"#", "#12", "#12345", "#1234567", "#123456789", "#xyz", "ffffff", "mauve-ish", "#-12"}) {
    CAPTURE(text);
    CHECK_THROWS_AS(parseColor("--background", text), Error);
  }
}

TEST_CASE("cli/values: --up is the file's axis or the camera's direction") {
  CHECK(!parseUp("--up", "y").z_axis);
  CHECK(parseUp("--up", "z").z_axis);
  CHECK(parseUp("--up", "0,0,1").direction == DVec3(0.0, 0.0, 1.0));
  for (const char* text : {"x", "Z", "0,0,0", "1,2", ""}) {
    CAPTURE(text);
    CHECK_THROWS_AS(parseUp("--up", text), Error);
  }
}

TEST_CASE("cli/values: a limit is a whole number of pixels or a percentage") {
  CHECK(parsePixelLimit("--max-differing", "12").value == 12.0);
  CHECK(!parsePixelLimit("--max-differing", "12").percent);
  CHECK(parsePixelLimit("--max-differing", "0.02%").value == doctest::Approx(0.02));
  CHECK(parsePixelLimit("--max-differing", "0.02%").percent);
  for (const char* text : {"-1", "1.5", "101%", "-1%", "%", "many", "inf", ""}) {
    CAPTURE(text);
    CHECK_THROWS_AS(parsePixelLimit("--max-differing", text), Error);
  }
}

TEST_CASE("cli/values: a fraction is written as such or as a percentage, and is at most 1") {
  CHECK(parseFraction("--epsilon", "0.5%") == 0.005);
  CHECK(parseFraction("--epsilon", "0.005") == 0.005);
  CHECK(parseFraction("--epsilon", "0") == 0.0);
  CHECK(parseFraction("--epsilon", "100%") == 1.0);
  CHECK(parseFraction("--epsilon", "1") == 1.0);
  for (const char* text : {"", "%", "-1%", "-0.1", "1.5", "101%", "nan", "inf%", "0.5 %", "0,5%", "half"}) {
    CAPTURE(text);
    CHECK_THROWS_WITH_AS(parseFraction("--epsilon", text), doctest::Contains("0.5%"), Error);
  }
}

TEST_CASE("cli/values: a list has as many numbers as are wanted, each in its range") {
  CHECK(parseList("--weights", "1,0.5,+2", 3, 4, 0.0, 10.0) == std::vector<double>{1.0, 0.5, 2.0});
  CHECK(parseList("--weights", "1,1,0,10", 3, 4, 0.0, 10.0).size() == 4);
  for (const char* text :
       {"", "1,1", "1,1,1,1,1", "1,1,1,", ",1,1,1", "1,,1,1", "1,1,-1", "1,1,11", "1,1,nan", "1, 1,1"}) {
    CAPTURE(text);
    CHECK_THROWS_WITH_AS(parseList("--weights", text, 3, 4, 0.0, 10.0),
                         doctest::Contains("3 to 4 numbers from 0 to 10"), Error);
  }
}

TEST_CASE("cli/values: whole numbers keep to their range") {
  CHECK(parseWhole("--vertices", "3000", 1, 5000) == 3000);
  CHECK(parseWhole("--vertices", "+1", 1, 5000) == 1);
  for (const char* text : {"0", "5001", "-1", "3.0", "3e3", "", "99999999999999999999", "3 "}) {
    CAPTURE(text);
    CHECK_THROWS_WITH_AS(parseWhole("--vertices", text, 1, 5000), doctest::Contains("1 to 5000"), Error);
  }
}

}  // namespace sheaf::cli
