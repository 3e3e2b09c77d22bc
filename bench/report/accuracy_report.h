/// What `bench accuracy` found, for programs and for readers.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/accuracy_bench.h"
#include "bench/report/svg_plot.h"

namespace gigabake::bench {

/// What coarse levels ought to reach where a voxel of lod 4 fills a pixel.
struct AccuracyGoal {
  std::string text;  ///< "nadir: holes ≤ 0.02"
  double measured = 0, bound = 0;
  bool holds() const { return measured <= bound; }
};

/// Of a setting whose voxels are as large as the bench's; none without pictures at 16 voxels a pixel.
std::vector<AccuracyGoal> goals_of(const AccuracySetting& setting);

std::string to_json(const AccuracyBench& bench);
/// The verdict, then tables: the settings, their voxels of lod 0, fewer bits a normal, the first one's views, the
/// goals; then what columns are.
std::string to_markdown(const AccuracyBench& bench);

struct NamedPlot {
  std::string file;  ///< "flip-bake-time.svg"
  Plot plot;
};
/// Mean FLIP against bytes per voxel, bytes in all and seconds of the bake; ΔE of lod 0's voxels against bytes.
std::vector<NamedPlot> plots_of(const AccuracyBench& bench);

}  // namespace gigabake::bench
