#include "scheduler/estimate.h"

#include <algorithm>

namespace gigabake {
namespace {

/// The fractal terrain (bench/) at 2048³: 2.1 million triangles, 307 MB, 3.6 core seconds.
constexpr double bytes_per_triangle = 150, core_seconds_per_triangle = 1.7e-6;

}  // namespace

PlanEstimate estimate(const BakePlan& plan) {
  PlanEstimate e;
  std::uint64_t all = 0;
  for (const CellJob& job : plan.jobs) {
    e.largest_cell_triangles = std::max(e.largest_cell_triangles, job.triangles);
    all += job.triangles;
  }
  e.kernel_bytes = std::uint64_t(bytes_per_triangle * double(e.largest_cell_triangles));
  e.core_seconds = core_seconds_per_triangle * double(all);
  return e;
}

}  // namespace gigabake
