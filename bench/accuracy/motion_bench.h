/// Motion: the difference between two frames from cameras that are a fraction of a pixel apart, for voxels and for
/// triangles. If the difference is larger for voxels than for triangles, flicker or popping is visible. At the border
/// between levels it is visible as a ring that moves with the eye.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/accuracy_bench.h"

namespace gigabake::bench {

/// The differences for one way of rendering voxels.
struct MotionFigures {
  double pair = 0;         ///< mean FLIP between the two frames
  double worst_block = 0;  ///< max over blocks: mean FLIP minus the reference's mean FLIP
  double still = 0;        ///< mean FLIP of the first frame, compared with the reference
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

  /// Returns the maximum over the rows of the voxels' difference divided by the triangles' difference. `way` is the
  /// member `plain` or `blended`.
  double worst_ratio(MotionFigures MotionRow::*way) const;
  double mean_still(MotionFigures MotionRow::*way) const;
};

/// The motion between the two frames of a pair, in pixels: of the nearest surface, or of the image border in a zoom.
inline constexpr double motion_pixels = 0.25;
/// The edge of a block in pixels; the ring between two levels is a few pixels wide.
inline constexpr int motion_block = 16;

/// Bakes the scene with the default rules into request.out. Renders each pair lit, without shadows, with --level-blend
/// off and on. request.samples is the number of rays per pixel of the reference. `progress` is called before each path
/// is rendered.
/// Errors  Same as bench_accuracy().
MotionBench bench_motion(const AccuracyBenchRequest& request, const AccuracyProgress& progress);

}  // namespace gigabake::bench
