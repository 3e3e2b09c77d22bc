/// Renders the frames of a flight and compares some of them with complete images.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "viewer/pictures/frame_renderer.h"

namespace gigabake::bench {

struct FlightPace {
  double upload_s = 0.008;      ///< maximum upload time per frame
  double period_s = 0;          ///< frames begin at multiples of it, as on a display; 0: without a pause
  bool starts_at_rest = false;  ///< the first view is complete before the flight; else the pools are empty
};

struct FlightTimes {
  int frames = 0;
  double median_s = 0, p99_s = 0, worst_s = 0;
  double late = 0;  ///< fraction of frames that take longer than FlightPace::period_s, if it is not 0
  std::uint64_t uploads = 0, uploaded_bytes = 0;    ///< bricks and node tiles; their bytes in the pools
  std::uint64_t peak_bytes = 0, allowed_bytes = 0;  ///< of pools and pages
  int compared_frames = 0;
  double mean_psnr_db = 0, worst_psnr_db = 0;  ///< frames as displayed, compared with exact images; at most 100
  std::uint64_t surface_pixels = 0;            ///< pixels of these exact images that show the surface
};

/// Renders the views in turn. Compares at least `exact_frames` evenly spaced frames, or all if there are fewer, with
/// complete images. These are rendered after the flight, so that they give it no time to load pages.
/// Range   At least one view.
/// Errors  See FrameRenderer.
FlightTimes fly(const std::filesystem::path& scene, const FrameRenderer::Options& renderer,
                const std::vector<View>& views, const FlightPace& pace, int exact_frames);

/// Returns the PSNR of the sRGB bytes of two images of the same size; infinite if they are equal.
double psnr_db(const Picture& a, const Picture& b);
/// Returns the number of pixels that show the surface.
std::uint64_t surface_pixels_of(const Picture& picture);
/// Returns the value below which a fraction of the values lies; 0: the minimum, 1: the maximum.
/// Range   At least one value.
double at_share(std::vector<double> values, double share);

}  // namespace gigabake::bench
