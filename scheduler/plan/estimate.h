/// Rough estimate of a plan from its triangles only; scheduler/plan/size_estimate.h estimates voxels, bytes and time.
#pragma once

#include <cstdint>

#include "scheduler/plan/plan.h"

namespace gigabake {

struct PlanEstimate {
  std::uint64_t max_cell_triangles = 0;
  std::uint64_t kernel_bytes = 0;  ///< working memory of the largest cell without a memory limit
};

/// Returns the estimate for a plan.
/// Exact   The result is an order of magnitude. Memory depends on voxels as much as on triangles, and the number of
///         voxels is not known before the bake.
PlanEstimate estimate(const BakePlan& plan);

/// Returns the relative cost of a cell, for the order of work; the unit is arbitrary.
/// Exact   Real costs scatter around the result, as modelled in bench/schedule_model.h.
inline std::uint64_t cell_cost(const CellJob& job) { return job.triangles; }

}  // namespace gigabake
