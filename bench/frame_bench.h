/// Times the streaming renderer. For fixed cameras, it times the frames until all data is resident, and then frames at
/// rest. It also times the frames of a flight. It compares the frames with exact images from the same cameras.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/flight/fly.h"
#include "viewer/pictures/frame_renderer.h"

namespace gigabake::bench {

struct FrameBenchRequest {
  std::filesystem::path scene;  ///< scene.xml of a bake
  int width = 1920, height = 1080;
  bool fixed_views = true;  ///< false: only the flight
  int repeats = 10;         ///< frames at rest per camera, once all data is resident
  FrameRenderer::Options renderer;
  double upload_s = 0.008;  ///< maximum upload time per frame
  int flight_frames = 200;
  int exact_frames = 8;  ///< evenly spaced frames of the flight, compared with exact images
};

struct FrameBenchView {
  std::string view;
  std::uint64_t frames_to_complete = 0, uploads = 0;
  double complete_s = 0;             ///< time until all data is resident, starting with empty pools
  double best_s = 0, median_s = 0;   ///< per frame at rest
  double best_cast_s = 0;            ///< minimum time for casting the rays of a frame at rest
  double first_psnr_db = 0;          ///< first frame with any surface, compared with the last
  bool same_as_exact = false;        ///< the last frame is bit-identical to the exact image
  std::uint64_t surface_pixels = 0;  ///< pixels of the exact image that show the surface
};

struct FrameBench {
  std::string backend;
  int width = 0, height = 0;
  std::vector<FrameBenchView> views;
  FlightTimes flight;

  /// Returns the number of pixels in all exact images that show the surface.
  std::uint64_t surface_pixels() const;
  /// Returns true if any view at rest differs from the exact image, or no image shows the surface.
  bool failed() const;
};

/// Measures all views and the flight.
/// Errors  See FrameRenderer.
FrameBench bench_frames(const FrameBenchRequest& request);

}  // namespace gigabake::bench
