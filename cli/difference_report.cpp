#include "cli/difference_report.h"

#include <cmath>

namespace sheaf::cli {

using Json = nlohmann::ordered_json;

Json finiteOrNull(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json toJson(const raster::ImageDifference& d) {
  Json json = {{"equal", d.differing_pixels == 0},
               {"differing_pixels", d.differing_pixels},
               {"differing_fraction", d.differingFraction()},
               {"max_error", d.max_error},
               {"max_error_rgba", d.max_error_channel},
               {"rms", d.rms},
               {"psnr_db", finiteOrNull(d.psnr_db)},
               {"first", nullptr},
               {"box", nullptr}};
  if (d.first) {
    json["first"] = {d.first->x, d.first->y};
    json["box"] = {{"min", {d.box_min.x, d.box_min.y}}, {"max", {d.box_max.x, d.box_max.y}}};
  }
  return json;
}

}  // namespace sheaf::cli
