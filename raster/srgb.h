// raster/srgb: the sRGB transfer curve [IEC61966], exactly rounded.
#pragma once

#include <array>
#include <cstdint>

namespace sheaf::raster {

/// The curve itself, [0, 1] to [0, 1].
double linearFromSrgb(double coded);
double srgbFromLinear(double linear);

/// Linear value of each of the 256 codes.
const std::array<float, 256>& srgbDecodeTable();

// The encoder looks at the bits of a float. In each bucket of equal upper 16 bits (7 of them mantissa) the nearest code
// changes at most once, so that a bucket's entry is
//   (code at its start) << 16 | (0x10000 - lower 16 bits of the first float with the next code, or 0 if there is none)
// and adding the float's lower 16 bits carries into the code exactly when it is due.
inline constexpr std::uint32_t kSrgbEncodeFirstBits = 0x39000000U;  ///< 2^-13, below the first float that codes as 1
inline constexpr std::uint32_t kSrgbEncodeLastBits = 0x3F7FFFFFU;   ///< the last float below 1, which codes as 255
inline constexpr std::size_t kSrgbEncodeBuckets = ((kSrgbEncodeLastBits - kSrgbEncodeFirstBits) >> 16) + 1;
const std::array<std::uint32_t, kSrgbEncodeBuckets>& srgbEncodeTable();

/// The code nearest to the curve; values outside [0, 1] are clamped, NaN codes as 0.
std::uint8_t encodeSrgb(float linear);

}  // namespace sheaf::raster
