/// Flights through a scene at several speeds and frame rates. Still images of the path compare voxels with a mesh that
/// has levels of detail.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/accuracy_bench.h"
#include "bench/flight/fly.h"

namespace gigabake::bench {

/// One orbit at one speed and frame rate.
struct FlightRow {
  double step_m = 0;  ///< movement of the eye per frame, along the orbit
  double frames_per_s = 0;
  FlightTimes times;
};

/// The error of a still image relative to the triangles of the source.
struct StillError {
  double psnr_db = 0, flip = 0;  ///< psnr_db: PictureError::psnr_black_db
};

/// One still image of the orbit, with and without light.
struct StillRow {
  double at = 0;  ///< position on the orbit, 0 … 1
  std::string mode;
  std::uint64_t compared_pixels = 0;  ///< pixels in which the reference shows the surface
  StillError voxels, mesh;
  std::uint64_t voxel_bytes = 0;  ///< pools and pages of the complete image
  std::uint64_t mesh_triangles = 0, mesh_bytes = 0;
};

struct FlightBench {
  std::string scene, backend;
  double voxel_size_m = 0, orbit_m = 0;
  int samples = 0, width = 0, height = 0, threads = 0;
  std::uint64_t source_triangles = 0;
  std::vector<FlightRow> flights;
  std::vector<StillRow> stills;
};

/// The frame rates of the flights.
inline constexpr double flight_rates[] = {60, 120};
/// The minimum number of frames of a flight that are compared with exact images, if it has as many.
inline constexpr int flight_exact_frames = 32;
/// The number of still images.
inline constexpr int flight_stills = 4;
/// The maximum error of the mesh's levels in pixels.
inline constexpr double mesh_pixel_error = 1;

/// Bakes the scene with the default rules into request.out. Measures flights and still images with request.backend.
/// request.steps_m are the speeds, and request.samples is the number of rays per pixel of images of triangles.
/// `progress` is called before each flight and still image.
/// Errors  Same as bench_accuracy(). UsageError: built without meshoptimizer, before anything is baked; an orbit has
///         fewer than 4 or more than 100,000 frames.
FlightBench bench_flight(const AccuracyBenchRequest& request, const AccuracyProgress& progress);

}  // namespace gigabake::bench
