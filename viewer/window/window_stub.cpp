#include <stdexcept>

#include "viewer/window/window.h"

namespace gigabake {

void show_window(const std::filesystem::path&, LiveScene::Options, const WindowOptions&) {
  throw std::runtime_error(
      "this gigabake was built without windows; install libglfw3-dev, libimgui-dev and libgl-dev and build again, or "
      "use "
      "gigabake serve");
}

}  // namespace gigabake
