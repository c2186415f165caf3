// cli/views: rows of cameras, as --views of compare and bench asks for them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/scene_options.h"
#include "scenes/scene.h"

namespace CLI {
class App;
}

namespace sheaf::cli {

enum class Views { kOne, kOrbit, kInside, kFly, kFile };

struct ViewsRequest {
  Views kind = Views::kOne;
  std::optional<int> count;  ///< of an orbit or a flight
  std::string file;          ///< of kFile
};

/// `orbit[:N]`, `inside`, `fly[:N]` or a JSON file of cameras; N is 1 to 10000. Throws Error(kUsage), also where the
/// camera options do not go with it: --orbit says where an orbit begins and from where the inside is entered.
ViewsRequest understandViews(const std::string& text, const ViewRequest& view);

/// Cameras that are reported together.
struct ViewRow {
  std::string name;                     ///< "orbit", "5 % in view"
  std::optional<double> share_in_view;  ///< of triangles, where the cameras were chosen for it
  std::vector<scenes::Camera> cameras;  ///< at least one; near and far are set, names tell them apart
};

/// One row, or three of `inside`: 5, 25 and 50 % of the triangles in view. Throws Error.
std::vector<ViewRow> makeViews(const scenes::Scene& scene, const ViewsRequest& request, const ViewRequest& view,
                               double aspect, int default_count);

}  // namespace sheaf::cli
