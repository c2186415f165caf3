#pragma once

#include <string>

#include "scenes/scene.h"

namespace sheaf::scenes {

Scene buildBuiltin(const std::string& spec);

}  // namespace sheaf::scenes
