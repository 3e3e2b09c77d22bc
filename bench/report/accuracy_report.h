/// Reports of `bench accuracy` as JSON and Markdown.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/accuracy_bench.h"

namespace gigabake::bench {

/// A goal for coarse levels, where a voxel of lod 4 fills a pixel.
struct AccuracyGoal {
  std::string text;  ///< such as "nadir: holes ≤ 0.02"
  double measured = 0, bound = 0;
  bool holds() const { return measured <= bound; }
};

/// Returns the goals of a setting whose voxels have the benchmark's voxel size. Returns no goals if there are no images
/// at 16 voxels per pixel.
std::vector<AccuracyGoal> goals_of(const AccuracySetting& setting);

std::string to_json(const AccuracyBench& bench);
/// Returns the conclusion, then tables of the settings, their lod-0 voxels, the first setting's
/// views, and the goals. Ends with a description of the columns.
std::string to_markdown(const AccuracyBench& bench);

}  // namespace gigabake::bench
