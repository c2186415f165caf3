// scenes/builtin_scenes: the builders behind buildBuiltin(), one per scene. Internal to scenes.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "scenes/scene.h"

namespace sheaf::scenes {

/// The checked values of a scene's parameters, every one present.
class BuiltinArguments {
 public:
  explicit BuiltinArguments(std::vector<std::pair<std::string, double>> values) : values_(std::move(values)) {}
  double number(const std::string& name) const;
  int whole(const std::string& name) const { return static_cast<int>(number(name)); }

 private:
  std::vector<std::pair<std::string, double>> values_;
};

enum class FillOrder { kFrontToBack = 0, kBackToFront = 1, kShuffled = 2 };

Scene buildGallery(const BuiltinArguments& arguments);
Scene buildTeapot(const BuiltinArguments& arguments);
Scene buildSphere(const BuiltinArguments& arguments);
Scene buildTorusKnot(const BuiltinArguments& arguments);
Scene buildTerrain(const BuiltinArguments& arguments);
Scene buildCity(const BuiltinArguments& arguments);
Scene buildCornell(const BuiltinArguments& arguments);
Scene buildFill(const BuiltinArguments& arguments);

}  // namespace sheaf::scenes
