/// Options that a window and a browser's server share.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "app/renderer_options.h"
#include "viewer/live/live_scene.h"

namespace gigabake::app {

struct LiveArguments {
  std::string scene, eye, target;
  double fovy_deg = 40, pixel_error = 1, frame_ms = 60;
  RendererArguments renderer;
  LightArguments light;
};

void add_live_options(CLI::App& command, LiveArguments& arguments);
/// Errors  UsageError.
LiveScene::Options live_options(const LiveArguments& arguments);

}  // namespace gigabake::app
