// raster/shade_reference: shading written plainly, one pixel at a time in double precision. The kernels are tested
// against it; nothing is drawn with it.
#pragma once

#include <cstdint>

#include "core/math.h"
#include "raster/shade.h"

namespace sheaf::raster {

/// Linear colour of triangle `id` of the scene at the centre of pixel (x, y) of the frame.
DVec3 shadePixelReference(const ShadeScene& scene, std::uint32_t id, int x, int y);

/// Share of the second solid colour at an object-space position times the frequency, [0, 1].
double solidReference(SolidTexture solid, const DVec3& p);

}  // namespace sheaf::raster
