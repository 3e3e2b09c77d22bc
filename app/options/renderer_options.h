/// Options of every command that draws: where rays are cast, and how much memory that may take.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

#include "viewer/pictures/frame_renderer.h"
#include "worker/backend.h"

namespace gigabake::app {

struct RendererArguments {
  int threads = 0;
  std::uint64_t memory_bytes = FrameRenderer::Options{}.memory_bytes;
  std::uint64_t device_bytes = FrameRenderer::Options{}.device_bytes;
  Backend backend = Backend::automatic;
};

/// Of lit pictures.
struct LightArguments {
  std::string haze = "off";
  double exposure_stops = 0;
};

/// What a view is besides its camera and mode.
struct SunArguments {
  std::string sun, time;
  Shadows shadows = Shadows::off;
  LevelBlend level_blend = LevelBlend::off;
};

void add_light_options(CLI::App& command, LightArguments& arguments);
void add_sun_options(CLI::App& command, SunArguments& arguments);
/// Errors  UsageError.
void set_light(const LightArguments& arguments, FrameRenderer::Options& options);

/// Where the sun stands, whether it casts shadows, and whether levels are blended.
/// Errors  UsageError: as above; --time, and the scene has no place on the earth.
void set_sun(const SunArguments& arguments, const SceneHeader& scene, View& view);
/// Says where a time puts the sun, and that there is none by night.
void tell_sun(const SunArguments& arguments, const View& view);

void add_renderer_options(CLI::App& command, RendererArguments& arguments);
/// Errors  UsageError; InputError: --backend cuda and no device.
FrameRenderer::Options renderer_options(const RendererArguments& arguments);

}  // namespace gigabake::app
