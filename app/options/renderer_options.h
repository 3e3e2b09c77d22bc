/// Options of every command that renders: the device that casts rays, and its memory limits.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

#include "viewer/pictures/frame_renderer.h"
#include "worker/device/backend.h"

namespace gigabake::app {

struct RendererArguments {
  int threads = 0;
  std::uint64_t memory_bytes = FrameRenderer::Options{}.memory_bytes;
  std::uint64_t device_bytes = FrameRenderer::Options{}.device_bytes;
  Backend backend = Backend::automatic;
};

/// Options of lit images.
struct LightArguments {
  std::string haze = "off";
  double exposure_stops = 0;
};

/// Options of a view other than its camera and mode.
struct SunArguments {
  std::string sun, time;
  Shadows shadows = Shadows::off;
  LevelBlend level_blend = LevelBlend::off;
};

void add_light_options(CLI::App& command, LightArguments& arguments);
void add_sun_options(CLI::App& command, SunArguments& arguments);
/// Errors  UsageError.
void set_light(const LightArguments& arguments, FrameRenderer::Options& options);

/// Sets the sun's position, the shadows and the level blending of `view`.
/// Errors  UsageError: an invalid value; --time for a scene that has no position on the earth.
void set_sun(const SunArguments& arguments, const SceneHeader& scene, View& view);
/// Prints the sun's position at --time, and a line if the sun is below the horizon.
void print_sun(const SunArguments& arguments, const View& view);

void add_renderer_options(CLI::App& command, RendererArguments& arguments);
/// Errors  UsageError; InputError: --backend cuda and no device.
FrameRenderer::Options renderer_options(const RendererArguments& arguments);

}  // namespace gigabake::app
