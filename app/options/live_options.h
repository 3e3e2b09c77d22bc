/// Options that the commands `view` and `serve` share.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "app/options/renderer_options.h"
#include "viewer/live/live_scene.h"

namespace gigabake::app {

struct LiveArguments {
  std::string scene, eye, target;
  double fovy_deg = CameraOptions{}.fovy_deg, pixel_error = CameraOptions{}.pixel_error;
  double frame_ms = 1000 * LiveScene::Options{}.frame_s;
  RendererArguments renderer;
  LightArguments light;
  SunArguments sun;
};

void add_live_options(CLI::App& command, LiveArguments& arguments);
/// Errors  UsageError.
LiveScene::Options live_options(const LiveArguments& arguments);

}  // namespace gigabake::app
