/// Motion: how much two pictures differ that are taken a fraction of a pixel apart, of voxels and of the triangles.
/// What differs more is seen to flicker or to pop, and where levels meet it is a ring that moves with the eye.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/accuracy_bench.h"

namespace gigabake::bench {

/// Figures of one way of drawing voxels.
struct MotionFigures {
  double pair = 0;         ///< mean FLIP between the two frames
  double worst_block = 0;  ///< the most that a block of pixels differs by beyond what it does in the reference
  double still = 0;        ///< mean FLIP of the first frame against the reference
};

/// Two frames of a path.
struct MotionRow {
  std::string path;
  double at = 0;                      ///< where along the path, 0 … 1
  std::uint64_t compared_pixels = 0;  ///< in which the first frame of triangles shows the surface
  double reference = 0;               ///< mean FLIP between the two frames of triangles
  MotionFigures plain, blended;
};

struct MotionBench {
  std::string scene;
  double voxel_size_m = 0;
  int samples = 0, width = 0, height = 0, threads = 0;
  std::vector<MotionRow> rows;

  /// The largest of a pair's difference over the reference's.
  double worst_ratio(MotionFigures MotionRow::*way) const;
  double mean_still(MotionFigures MotionRow::*way) const;
};

/// Frames of a pair are a quarter of a pixel apart: pixels of the nearest surface, or of the border where it zooms.
inline constexpr double motion_pixels = 0.25;
/// Blocks of so many pixels a side: a ring of another level is a few of them wide.
inline constexpr int motion_block = 16;

/// Bakes the scene with the default rules into `out` and draws each pair lit, without shadows, with --level-blend off
/// and on. samples: of the reference, a pixel. Told of each path before it is drawn. Errors  as bench_accuracy().
MotionBench bench_motion(const AccuracyBenchRequest& request, const AccuracyProgress& progress);

}  // namespace gigabake::bench
