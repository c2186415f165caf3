// scenes/noise: repeatable randomness for generated scenes, from integer hashes alone.
#pragma once

#include <cstdint>

namespace sheaf::scenes {

/// Mixes three coordinates and a seed into 32 well-spread bits.
std::uint32_t hashOf(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t seed);

/// The same as a fraction in [0, 1).
double hashFraction(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t seed);

/// Value noise: hashes of the integer lattice, interpolated twice differentiably. Range [0, 1).
/// |x|, |y|, |z| below 2^30.
double valueNoise(double x, double y, double z, std::uint32_t seed);

/// Sum of `octaves` value noises, each of twice the frequency and `gain` times the weight of the one before, divided by
/// the sum of weights. Range [0, 1).
double fractalNoise(double x, double y, double z, int octaves, double gain, std::uint32_t seed);

}  // namespace sheaf::scenes
