/// Times what somebody at a window waits for: the first picture, the picture at rest, and the answer to a hand.
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
  int movements = 9;  ///< each while a full frame is drawn
};

/// A frame against the one at rest, of the same camera, enlarged to its size.
struct LiveBenchFrame {
  double at_s = 0;  ///< since the scene was opened
  int width = 0, height = 0;
  double holes = 0;       ///< share of the pixels in which the frame at rest has a surface and this one has none
  double mean_error = 0;  ///< of sRGB bytes
};

struct LiveBench {
  int width = 0, height = 0;
  double render_s = 0;                 ///< opening the scene anew and drawing the same picture without a pause
  double rest_s = 0;                   ///< until the picture at rest
  std::vector<LiveBenchFrame> frames;  ///< until then
  double median_answer_s = 0, worst_answer_s = 0;  ///< from a movement to the next picture
  double close_s = 0;                              ///< of a scene that is drawing a full frame
  bool same_as_rendered = false;
  std::uint64_t surface_pixels = 0;  ///< of the picture at rest

  bool failed() const { return !same_as_rendered || surface_pixels == 0; }
};

/// Errors  as FrameRenderer's; InputError where no picture comes within minutes.
LiveBench bench_live(const LiveBenchRequest& request);

}  // namespace gigabake::bench
