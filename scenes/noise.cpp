#include "scenes/noise.h"

#include <cmath>

namespace sheaf::scenes {
namespace {

// Finalizer with full avalanche (constants of "lowbias32", Wellons 2018).
std::uint32_t mix(std::uint32_t h) {
  h ^= h >> 16;
  h *= 0x7feb352dU;
  h ^= h >> 15;
  h *= 0x846ca68bU;
  h ^= h >> 16;
  return h;
}

double smooth(double t) {
  return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

double lerp(double a, double b, double t) {
  return a + t * (b - a);
}

}  // namespace

std::uint32_t hashOf(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t seed) {
  // Odd factors far from each other's multiples keep neighbouring lattice points apart; the mixing does the rest.
  return mix(static_cast<std::uint32_t>(x) * 0x9e3779b1U + static_cast<std::uint32_t>(y) * 0x85ebca77U +
             static_cast<std::uint32_t>(z) * 0xc2b2ae3dU + seed * 0x27d4eb2fU);
}

double hashFraction(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t seed) {
  return hashOf(x, y, z, seed) * 0x1p-32;
}

double valueNoise(double x, double y, double z, std::uint32_t seed) {
  const double fx = std::floor(x);
  const double fy = std::floor(y);
  const double fz = std::floor(z);
  const auto ix = static_cast<std::int32_t>(fx);
  const auto iy = static_cast<std::int32_t>(fy);
  const auto iz = static_cast<std::int32_t>(fz);
  const double tx = smooth(x - fx);
  const double ty = smooth(y - fy);
  const auto row = [&](int dy, int dz) {
    return lerp(hashFraction(ix, iy + dy, iz + dz, seed), hashFraction(ix + 1, iy + dy, iz + dz, seed), tx);
  };
  const auto slice = [&](int dz) { return lerp(row(0, dz), row(1, dz), ty); };
  // Plane noise is asked for with z = 0: half of the lattice is not needed then.
  return z == fz ? slice(0) : lerp(slice(0), slice(1), smooth(z - fz));
}

double fractalNoise(double x, double y, double z, int octaves, double gain, std::uint32_t seed) {
  double sum = 0.0;
  double weight = 1.0;
  double weights = 0.0;
  double frequency = 1.0;
  for (int i = 0; i < octaves; ++i) {
    sum += weight * valueNoise(x * frequency, y * frequency, z * frequency, seed + static_cast<std::uint32_t>(i));
    weights += weight;
    weight *= gain;
    frequency *= 2.0;
  }
  return sum / weights;
}

}  // namespace sheaf::scenes
