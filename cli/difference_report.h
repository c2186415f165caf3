// cli/difference_report: how far two pictures are apart, as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "raster/image_compare.h"

namespace sheaf::cli {

/// JSON knows no infinity: null.
nlohmann::ordered_json finiteOrNull(double value);

nlohmann::ordered_json toJson(const raster::ImageDifference& difference);

}  // namespace sheaf::cli
