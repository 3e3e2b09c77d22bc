/// Times the streaming renderer: fixed cameras until all has come and then at rest, and a flight, with the error of its
/// frames against the exact pictures of the same cameras.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "viewer/pictures/frame_renderer.h"

namespace gigabake::bench {

struct FrameBenchRequest {
  std::filesystem::path scene;  ///< scene.xml of a bake
  int width = 1920, height = 1080;
  bool fixed_views = true;  ///< else the flight alone
  int repeats = 10;         ///< of each camera, once everything is there
  FrameRenderer::Options renderer;
  double upload_s = 0.008;  ///< of a frame, at most
  int flight_frames = 200;
  int exact_frames = 8;  ///< of the flight, spread evenly, that are compared with exact pictures
};

struct FrameBenchView {
  std::string view;
  std::uint64_t frames_to_complete = 0, uploads = 0;
  double complete_s = 0;             ///< from empty pools
  double best_s = 0, median_s = 0;   ///< a frame at rest
  double best_cast_s = 0;            ///< of it the rays
  double first_psnr_db = 0;          ///< of the first frame that showed anything, against the last
  bool same_as_exact = false;        ///< the last frame is the exact picture, bit for bit
  std::uint64_t surface_pixels = 0;  ///< of the exact picture
};

struct FlightBench {
  int frames = 0;
  double median_s = 0, p99_s = 0, worst_s = 0;
  std::uint64_t uploads = 0, peak_bytes = 0, allowed_bytes = 0;
  double mean_psnr_db = 0, worst_psnr_db = 0;  ///< of frames as they were shown, against exact pictures
  std::uint64_t surface_pixels = 0;            ///< of these exact pictures
};

struct FrameBench {
  std::string backend;
  int width = 0, height = 0;
  std::vector<FrameBenchView> views;
  FlightBench flight;

  /// Returns the pixels of all exact pictures that show the surface.
  std::uint64_t surface_pixels() const;
  /// Returns true if any view at rest is not the exact picture, or no picture shows the surface.
  bool failed() const;
};

/// Errors  as FrameRenderer's.
FrameBench bench_frames(const FrameBenchRequest& request);

}  // namespace gigabake::bench
