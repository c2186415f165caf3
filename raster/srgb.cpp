#include "raster/srgb.h"

#include <bit>
#include <cassert>
#include <cmath>

namespace sheaf::raster {
namespace {

/// The first float that codes as `code`: the curve there is at least code - 1/2. The doubles that decide this are far
/// more exact than the distance of any threshold to the next float, so any maths library gives the same table.
std::uint32_t firstFloatBits(int code) {
  const double threshold = linearFromSrgb((code - 0.5) / 255.0);
  const auto nearest = static_cast<float>(threshold);
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(nearest);
  return static_cast<double>(nearest) < threshold ? bits + 1 : bits;
}

std::array<std::uint32_t, kSrgbEncodeBuckets> makeEncodeTable() {
  std::array<std::uint32_t, kSrgbEncodeBuckets> table{};
  std::uint32_t code = 0;
  std::uint32_t next_bits = firstFloatBits(1);
  for (std::uint32_t bucket = 0; bucket < kSrgbEncodeBuckets; ++bucket) {
    const std::uint32_t begin_bits = kSrgbEncodeFirstBits + (bucket << 16);
    assert(code == 255 || next_bits >= begin_bits);
    table[bucket] = code << 16;
    if (code == 255 || next_bits - begin_bits > 0xFFFFU) continue;
    table[bucket] += 0x10000U - (next_bits - begin_bits);
    if (++code < 255) next_bits = firstFloatBits(static_cast<int>(code) + 1);
  }
  return table;
}

}  // namespace

double linearFromSrgb(double coded) {
  return coded <= 0.04045 ? coded / 12.92 : std::pow((coded + 0.055) / 1.055, 2.4);
}

double srgbFromLinear(double linear) {
  return linear <= 0.0031308 ? linear * 12.92 : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

const std::array<float, 256>& srgbDecodeTable() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> made{};
    for (std::size_t code = 0; code < 256; ++code)
      made[code] = static_cast<float>(linearFromSrgb(static_cast<double>(code) / 255.0));
    return made;
  }();
  return table;
}

const std::array<std::uint32_t, kSrgbEncodeBuckets>& srgbEncodeTable() {
  static const std::array<std::uint32_t, kSrgbEncodeBuckets> table = makeEncodeTable();
  return table;
}

std::uint8_t encodeSrgb(float linear) {
  float clamped =
      linear > std::bit_cast<float>(kSrgbEncodeFirstBits) ? linear : std::bit_cast<float>(kSrgbEncodeFirstBits);
  if (clamped > std::bit_cast<float>(kSrgbEncodeLastBits)) clamped = std::bit_cast<float>(kSrgbEncodeLastBits);
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(clamped);
  const std::uint32_t entry = srgbEncodeTable()[(bits - kSrgbEncodeFirstBits) >> 16];
  return static_cast<std::uint8_t>((entry + (bits & 0xFFFFU)) >> 16);
}

}  // namespace sheaf::raster
