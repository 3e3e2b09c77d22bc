/// Options of every command that draws: where rays are cast, and how much memory that may take.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

#include "viewer/frame_renderer.h"

namespace gigabake::app {

struct RendererArguments {
  int threads = 0;
  std::uint64_t memory_bytes = std::uint64_t(1) << 30, device_bytes = std::uint64_t(4) << 30;
  std::string backend = "auto";
};

void add_renderer_options(CLI::App& command, RendererArguments& arguments);
/// Errors  UsageError; InputError: --backend cuda and no device.
FrameRenderer::Options renderer_options(const RendererArguments& arguments);

}  // namespace gigabake::app
