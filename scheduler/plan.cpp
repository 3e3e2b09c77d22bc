#include "scheduler/plan.h"

#include <algorithm>
#include <map>
#include <utility>

#include "scheduler/fingerprint.h"

namespace gigabake {
namespace {

using ColumnKey = std::pair<std::int64_t, std::int64_t>;  // y, x

struct TileExtent {
  std::uint32_t tile;
  ColumnExtent extent;
};

std::int64_t floor_to(std::int64_t v, std::int64_t multiple) {
  const std::int64_t rest = v % multiple;
  return v - (rest < 0 ? rest + multiple : rest);
}

std::map<ColumnKey, std::vector<TileExtent>> by_column(const std::vector<TileSurvey>& surveys) {
  std::map<ColumnKey, std::vector<TileExtent>> columns;
  for (const TileSurvey& s : surveys)
    for (const ColumnExtent& c : s.columns) columns[{c.column_y, c.column_x}].push_back({s.tile, c});
  return columns;
}

/// The cell's tiles and estimate; no tiles: nothing reaches it.
CellJob make_job(const ColumnKey& column, std::int64_t z_min, std::int64_t z_index, std::uint32_t cell_voxels,
                 const std::vector<TileExtent>& extents) {
  CellJob job;
  job.name = "c_" + std::to_string(column.second) + "_" + std::to_string(column.first) + "_" + std::to_string(z_index);
  job.lattice_min = {column.second * cell_voxels, column.first * cell_voxels, z_min};
  job.cell_voxels = cell_voxels;
  for (const TileExtent& t : extents) {
    if (t.extent.z_min >= z_min + cell_voxels || t.extent.z_end <= z_min) continue;
    job.tiles.push_back(t.tile);
    job.triangles += t.extent.triangles;
  }
  return job;
}

void add_column(const ColumnKey& column, const std::vector<TileExtent>& extents, std::uint32_t cell_voxels,
                BakePlan& plan) {
  std::int64_t z_min = extents[0].extent.z_min, z_end = extents[0].extent.z_end;
  for (const TileExtent& t : extents) {
    z_min = std::min(z_min, t.extent.z_min);
    z_end = std::max(z_end, t.extent.z_end);
  }
  const CellStack stack = stack_over(z_min, z_end, cell_voxels);
  for (std::int64_t k = 0; k < stack.cells; ++k) {
    CellJob job = make_job(column, stack.z_min + k * cell_voxels, k, cell_voxels, extents);
    if (!job.tiles.empty()) plan.jobs.push_back(std::move(job));
  }
}

void add_counts(const std::vector<TileSurvey>& surveys, const std::vector<std::string>& names, BakePlan& plan) {
  for (const TileSurvey& s : surveys) {
    plan.triangles += s.triangles;
    plan.non_finite += s.non_finite;
    plan.zero_area += s.zero_area;
    plan.skipped_points += s.skipped_points;
    plan.skipped_lines += s.skipped_lines;
    if (!s.error.empty()) plan.losses.push_back({"tile " + names[s.tile], s.error});
  }
}

}  // namespace

CellStack stack_over(std::int64_t z_min, std::int64_t z_end, std::int64_t cell_voxels) {
  for (std::int64_t cells = (z_end - z_min + cell_voxels - 1) / cell_voxels;; ++cells) {
    const std::int64_t spare = cells * cell_voxels - (z_end - z_min);
    std::int64_t start = floor_to(z_min - spare / 2, brick_edge);
    if (start + cells * cell_voxels < z_end) start += brick_edge;
    if (start <= z_min && start + cells * cell_voxels >= z_end) return {start, cells};
  }
}

BakePlan make_plan(std::vector<TileSurvey> surveys, const std::vector<std::string>& tile_names,
                   const BakeParameters& parameters, const std::optional<Geodetic>& origin) {
  std::sort(surveys.begin(), surveys.end(), [](const TileSurvey& a, const TileSurvey& b) { return a.tile < b.tile; });
  BakePlan plan;
  add_counts(surveys, tile_names, plan);
  for (const auto& [column, extents] : by_column(surveys)) add_column(column, extents, parameters.cell_voxels, plan);
  std::sort(plan.jobs.begin(), plan.jobs.end(), [](const CellJob& a, const CellJob& b) {
    return std::make_pair(a.lattice_min[2], std::make_pair(a.lattice_min[1], a.lattice_min[0])) <
           std::make_pair(b.lattice_min[2], std::make_pair(b.lattice_min[1], b.lattice_min[0]));
  });
  for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
    CellJob& job = plan.jobs[i];
    job.id = std::uint32_t(i);
    std::vector<Hash128> sources;
    for (const std::uint32_t tile : job.tiles) sources.push_back(surveys[tile].source);
    job.fingerprint = cell_fingerprint(job, parameters, origin, sources);
  }
  return plan;
}

}  // namespace gigabake
