/// Motion: differences between two frames that are a fraction of a pixel apart, of voxels and of triangles. A larger
/// difference of voxels is visible as flicker or popping. At the border between levels it is a ring that moves with the
/// eye.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/accuracy_bench.h"

namespace gigabake::bench {

/// Numbers of one way of rendering voxels.
struct MotionFigures {
  double pair = 0;         ///< mean FLIP between the two frames
  double worst_block = 0;  ///< max over blocks of the difference in excess of the reference's
  double still = 0;        ///< mean FLIP of the first frame against the reference
};

/// The differences between two frames of a path.
struct MotionRow {
  std::string path;
  double at = 0;                      ///< position along the path, 0 … 1
  std::uint64_t compared_pixels = 0;  ///< pixels in which the first reference frame shows the surface
  double reference = 0;               ///< mean FLIP between the two frames of triangles
  MotionFigures plain, blended;
};

struct MotionBench {
  std::string scene;
  double voxel_size_m = 0;
  int samples = 0, width = 0, height = 0, threads = 0;
  std::vector<MotionRow> rows;

  /// Returns the maximum ratio of a pair's difference to the reference's.
  double worst_ratio(MotionFigures MotionRow::*way) const;
  double mean_still(MotionFigures MotionRow::*way) const;
};

/// The distance between the frames of a pair, in pixels of the nearest surface, or at the image border when zooming.
inline constexpr double motion_pixels = 0.25;
/// The edge of a block in pixels; the ring between two levels is a few pixels wide.
inline constexpr int motion_block = 16;

/// Bakes the scene with the default rules into `out`. Renders each pair lit, without shadows, with --level-blend off
/// and on. Parameter samples: rays per pixel of the reference. The callback `progress` is called before each path is
/// rendered.
/// Errors  Same as bench_accuracy().
MotionBench bench_motion(const AccuracyBenchRequest& request, const AccuracyProgress& progress);

}  // namespace gigabake::bench
