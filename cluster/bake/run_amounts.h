/// The amounts that a run has baked, for the rates in its report.
#pragma once

#include <cstdint>
#include <vector>

#include "format/job/cell_job.h"
#include "scheduler/plan/plan.h"

namespace gigabake {

struct RunAmounts {
  /// Ground area of the columns of the baked cells, as far as the columns overlap the bounds of the plan.
  double square_km = 0;
  std::uint64_t triangles = 0;  ///< summed over cells: a triangle counts in each cell that it overlaps
  std::uint64_t voxels = 0;     ///< of all levels; duplicated levels count once
  std::uint64_t bytes = 0;      ///< of the shards, including overviews
};

/// Returns the amounts of this run. `reports` does not contain reports of cells that an earlier run has baked.
RunAmounts amounts_of(const BakePlan& plan, const std::vector<CellReport>& reports, double voxel_size_m);

}  // namespace gigabake
