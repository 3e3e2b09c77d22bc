#include "cluster/bake/run_amounts.h"

#include <algorithm>
#include <array>
#include <set>

namespace gigabake {
namespace {

/// Returns the number of voxels of [begin, begin + size) that lie in [low, end).
double overlap(std::int64_t begin, std::int64_t size, std::int64_t low, std::int64_t end) {
  return double(std::max<std::int64_t>(0, std::min(begin + size, end) - std::max(begin, low)));
}

}  // namespace

RunAmounts amounts_of(const BakePlan& plan, const std::vector<CellReport>& reports, double voxel_size_m) {
  RunAmounts amounts;
  std::set<std::array<std::int64_t, 2>> columns;
  double area_voxels = 0;
  for (const CellReport& report : reports) {
    if (report.outcome != CellOutcome::baked && report.outcome != CellOutcome::empty) continue;
    amounts.voxels += report.cell.own_voxels();
    amounts.bytes += report.cell.bytes;
    const CellJob& job = plan.jobs[report.id];
    if (is_overview(job)) continue;
    amounts.triangles += report.cell.triangles;
    const auto [x, y] = std::array{job.lattice_min[0], job.lattice_min[1]};
    if (!columns.insert({x, y}).second) continue;
    area_voxels += overlap(x, job.cell_voxels, plan.bounds.min[0], plan.bounds.end[0]) *
                   overlap(y, job.cell_voxels, plan.bounds.min[1], plan.bounds.end[1]);
  }
  constexpr double square_m_per_square_km = 1e6;
  amounts.square_km = area_voxels * voxel_size_m * voxel_size_m / square_m_per_square_km;
  return amounts;
}

}  // namespace gigabake
