/// What a plan will cost, from its triangles alone; scheduler/size_estimate.h knows voxels, bytes and time.
#pragma once

#include <cstdint>

#include "scheduler/plan.h"

namespace gigabake {

struct PlanEstimate {
  std::uint64_t largest_cell_triangles = 0;
  std::uint64_t kernel_bytes = 0;  ///< working memory of the largest cell, with no bound on memory
};

/// Exact  Orders of magnitude: cost follows voxels as much as triangles, and nobody has counted those yet.
PlanEstimate estimate(const BakePlan& plan);

/// What a cell costs beside another one, for the order of work; the unit has no meaning.
/// Exact  Real bakes scatter about it: bench/schedule_model.h has by how much.
inline std::uint64_t cell_cost(const CellJob& job) { return job.triangles; }

}  // namespace gigabake
