#include "scenes/paint.h"

#include <vector>

namespace sheaf::scenes {

std::uint8_t srgbByte(double linear) {
  // A byte changes at most once per step of this table, also in the dark where the code is steepest.
  static constexpr int kSteps = 4096;
  static const std::vector<std::uint8_t> codes = [] {
    std::vector<std::uint8_t> result;
    for (int i = 0; i <= kSteps; ++i) {
      const double c = static_cast<double>(i) / kSteps;
      const double coded = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055;
      result.push_back(static_cast<std::uint8_t>(coded * 255.0 + 0.5));
    }
    return result;
  }();
  return codes[static_cast<std::size_t>(std::clamp(linear, 0.0, 1.0) * kSteps + 0.5)];
}

Image8 paintImage(int width, int height, const std::function<DVec3(double u, double v)>& linear_color) {
  Image8 image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const DVec3 c = linear_color((x + 0.5) / width, (y + 0.5) / height);
      image.at(x, y) = {srgbByte(c.x), srgbByte(c.y), srgbByte(c.z), 255};
    }
  return image;
}

DVec3 mixColors(const DVec3& a, const DVec3& b, double t) {
  return a + std::clamp(t, 0.0, 1.0) * (b - a);
}

double smoothStep(double lo, double hi, double x) {
  const double t = std::clamp((x - lo) / (hi - lo), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace sheaf::scenes
