/// The errors of shadows in images of voxels, relative to images of triangles that cast shadows, and the time that
/// shadows take.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bench/accuracy/accuracy_bench.h"

namespace gigabake::bench {

/// The errors of images from one camera, after tone mapping.
struct LightRow {
  std::string view;  ///< AccuracyView::name()
  int width = 0, height = 0;
  std::uint64_t compared_pixels = 0;  ///< pixels in which the reference shows the surface
  double flip = 0;                    ///< image with shadows, compared with the reference
  double flip_without = 0;            ///< image without shadows, compared with the same reference
  double flip_unshadowed = 0;         ///< image and reference both without shadows: errors that shadows do not cause
  double frame_s = 0, frame_without_s = 0;  ///< after all requested data is resident
};

struct LightBench {
  std::string scene;
  double voxel_size_m = 0;
  int samples = 0, threads = 0;
  std::vector<LightRow> rows;

  double mean_flip() const;
  double mean_flip_without() const;
  double mean_flip_unshadowed() const;
  double time_ratio() const;  ///< total time of all frames with shadows, divided by the time without shadows
};

/// Bakes the scene with the default rules into request.out, and renders it from the views of bench_accuracy().
///
/// request.samples is the number of rays per pixel of the reference. `progress` is called before each view is rendered.
/// Errors  Same as bench_accuracy().
LightBench bench_light(const AccuracyBenchRequest& request, const AccuracyProgress& progress);

}  // namespace gigabake::bench
