/// Times the latencies of an interactive viewer: the first image, the image at rest, and the response to input.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "viewer/pictures/frame_renderer.h"

namespace gigabake::bench {

struct LiveBenchRequest {
  std::filesystem::path scene;  ///< scene.xml of a bake
  int width = 1280, height = 720;
  FrameRenderer::Options renderer;
  int movements = 9;  ///< number of movements, each during the rendering of a full frame
};

/// A frame compared with the frame at rest of the same camera; the smaller frame is enlarged.
struct LiveBenchFrame {
  double at_s = 0;  ///< since the scene was opened
  int width = 0, height = 0;
  double holes = 0;       ///< fraction of pixels with surface only in the frame at rest
  double mean_error = 0;  ///< mean error of sRGB bytes
};

struct LiveBench {
  int width = 0, height = 0;
  double render_s = 0;                 ///< opening the scene again and rendering the same image without a pause
  double rest_s = 0;                   ///< from opening the scene to the image at rest
  std::vector<LiveBenchFrame> frames;  ///< up to the frame at rest
  double median_answer_s = 0, worst_answer_s = 0;  ///< from a movement to the next image
  double close_s = 0;                              ///< closing a scene that is rendering a full frame
  bool same_as_rendered = false;
  std::uint64_t surface_pixels = 0;  ///< pixels of the image at rest that show the surface

  bool failed() const { return !same_as_rendered || surface_pixels == 0; }
};

/// Measures one scene.
/// Errors  See FrameRenderer. InputError: no image is rendered within ten minutes.
LiveBench bench_live(const LiveBenchRequest& request);

}  // namespace gigabake::bench
