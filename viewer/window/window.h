/// A scene in a window (docs/viewer.md).
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "viewer/live/live_scene.h"

namespace gigabake {

struct WindowOptions {
  int width = 1280, height = 720;
  std::filesystem::path output = ".";                                 ///< folder of pictures and paths that are saved
  std::function<void(const std::string&)> told = [](const auto&) {};  ///< one line for each thing saved or failed
};

/// Returns when the window is closed. For the main thread. scene_options.changed is the window's own.
/// Errors  std::runtime_error: no display, no OpenGL 2.1, or a program built without windows.
void show_window(const std::filesystem::path& scene, LiveScene::Options scene_options, const WindowOptions& options);

}  // namespace gigabake
