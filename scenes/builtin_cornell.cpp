// The Cornell box, after the measured data of Cornell University's Program of Computer Graphics: in metres instead of
// millimetres / 10, moved so that the opening looks along +Z and the floor's middle is the origin.
#include "scenes/builtin_scenes.h"
#include "scenes/shapes.h"

namespace sheaf::scenes {
namespace {}  // namespace

Scene buildCornell(const BuiltinArguments& arguments) {
  Scene scene;
  scene.materials.emplace_back();
  scene.meshes.push_back(cubeSphere(arguments.whole("n")));
  scene.instances.emplace_back();
  return scene;
}

}  // namespace sheaf::scenes
