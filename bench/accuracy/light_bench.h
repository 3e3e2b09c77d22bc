/// The light of pictures, against triangles that stand in each other's light: what shadows are off by, and what they
/// take.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bench/accuracy/accuracy_bench.h"

namespace gigabake::bench {

/// Of one camera, pictures as a screen shows them.
struct LightRow {
  std::string view;  ///< AccuracyView::name()
  int width = 0, height = 0;
  std::uint64_t compared_pixels = 0;        ///< in which the reference shows the surface
  double flip = 0;                          ///< with shadows, against the reference
  double flip_without = 0;                  ///< without, against the same
  double flip_unshadowed = 0;               ///< without, against the reference without: what is not light's error
  double frame_s = 0, frame_without_s = 0;  ///< at rest: all that it wants is in memory
};

struct LightBench {
  std::string scene;
  double voxel_size_m = 0;
  int samples = 0, threads = 0;
  std::vector<LightRow> rows;

  double mean_flip() const;
  double mean_flip_without() const;
  double mean_flip_unshadowed() const;
  double time_ratio() const;  ///< of all frames together, with shadows to without
};

/// Bakes the scene with the default rules into `out`, and looks at it as bench_accuracy() does. samples: of the
/// reference, a pixel. Told of each view before it is drawn.
/// Errors  as bench_accuracy().
LightBench bench_light(const AccuracyBenchRequest& request, const AccuracyProgress& progress);

}  // namespace gigabake::bench
