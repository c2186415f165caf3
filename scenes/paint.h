// scenes/paint: texture images painted by formula.
#pragma once

#include <functional>

#include "core/image.h"
#include "core/math.h"

namespace sheaf::scenes {

/// A fraction of linear light as an sRGB byte; clamped to [0, 1].
std::uint8_t srgbByte(double linear);

/// Calls linear_color(u, v) at every texel's centre, u to the right and v down, both in (0, 1).
Image8 paintImage(int width, int height, const std::function<DVec3(double u, double v)>& linear_color);

/// a + t (b - a), t clamped to [0, 1].
DVec3 mixColors(const DVec3& a, const DVec3& b, double t);

/// 0 below `lo`, 1 above `hi`, smooth between.
double smoothStep(double lo, double hi, double x);

}  // namespace sheaf::scenes
