/// A scene in a window (docs/viewer.md).
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "viewer/live/live_scene.h"

namespace gigabake {

struct WindowOptions {
  int width = 1280, height = 720;
  std::filesystem::path output = ".";                                 ///< folder for saved images and paths
  std::function<void(const std::string&)> told = [](const auto&) {};  ///< called with one line per saved file or error
};

/// Shows the scene until the window is closed. Replaces scene_options.changed. Call this function on the main thread.
/// Errors  std::runtime_error: no display, no OpenGL 2.1, or a program built without windows.
void show_window(const std::filesystem::path& scene, LiveScene::Options scene_options, const WindowOptions& options);

}  // namespace gigabake
