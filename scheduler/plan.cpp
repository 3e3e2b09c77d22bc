#include "scheduler/plan.h"

#include <algorithm>
#include <map>
#include <tuple>
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

bool spreads_too_far(const TileSurvey& survey, std::int64_t cell_voxels) {
  std::int64_t cells = 0;
  for (const ColumnExtent& c : survey.columns) {
    cells += std::min((c.z_end - c.z_min) / cell_voxels, most_cells_of_a_tile) + 1;
    if (cells > most_cells_of_a_tile) return true;
  }
  return false;
}

/// Tiles that reach too far get an error in place of their columns.
void refuse_spread_tiles(std::vector<TileSurvey>& surveys, std::uint32_t cell_voxels) {
  for (TileSurvey& s : surveys) {
    if (!spreads_too_far(s, cell_voxels)) continue;
    TileSurvey refused;
    refused.tile = s.tile;
    refused.error = "needs more than " + std::to_string(most_cells_of_a_tile) + " cells of " +
                    std::to_string(cell_voxels) +
                    " voxels; enlarge --voxel-size or --cell-voxels, or check the unit of its coordinates";
    s = std::move(refused);
  }
}

std::map<ColumnKey, std::vector<TileExtent>> by_column(const std::vector<TileSurvey>& surveys) {
  std::map<ColumnKey, std::vector<TileExtent>> columns;
  for (const TileSurvey& s : surveys)
    for (const ColumnExtent& c : s.columns) columns[{c.column_y, c.column_x}].push_back({s.tile, c});
  return columns;
}

CellJob empty_job(const ColumnKey& column, const CellStack& stack, std::int64_t level, std::uint32_t cell_voxels) {
  const std::int64_t n = cell_voxels;
  CellJob job;
  job.name = "c_" + std::to_string(column.second) + "_" + std::to_string(column.first) + "_" + std::to_string(level);
  job.lattice_min = {column.second * n, column.first * n, stack.z_min + level * n};
  job.cell_voxels = cell_voxels;
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
  std::map<std::int64_t, CellJob> levels;  // where nothing is, the stack has no cell
  for (const TileExtent& t : extents) {
    const std::int64_t last = (t.extent.z_end - 1 - stack.z_min) / cell_voxels;
    for (std::int64_t level = (t.extent.z_min - stack.z_min) / cell_voxels; level <= last; ++level) {
      CellJob& job = levels.try_emplace(level, empty_job(column, stack, level, cell_voxels)).first->second;
      job.tiles.push_back(t.tile);
      job.triangles += t.extent.triangles;
    }
  }
  for (auto& [level, job] : levels) plan.jobs.push_back(std::move(job));
}

void add_counts(const std::vector<TileSurvey>& surveys, const SceneSources& sources, BakePlan& plan) {
  for (const SkippedSource& s : sources.skipped)
    if (!s.informative) plan.losses.push_back({s.name, s.reason});
  for (const TileSurvey& s : surveys) {
    plan.triangles += s.triangles;
    plan.non_finite += s.non_finite;
    plan.zero_area += s.zero_area;
    plan.skipped_points += s.skipped_points;
    plan.skipped_lines += s.skipped_lines;
    if (!s.error.empty()) plan.losses.push_back({"tile " + sources.tiles[s.tile].name, s.error});
  }
}

void name_jobs(const std::vector<TileSurvey>& surveys, const SceneSources& sources, const BakeParameters& parameters,
               std::vector<CellJob>& jobs) {
  std::sort(jobs.begin(), jobs.end(), [](const CellJob& a, const CellJob& b) {
    return std::tie(a.lattice_min[2], a.lattice_min[1], a.lattice_min[0]) <
           std::tie(b.lattice_min[2], b.lattice_min[1], b.lattice_min[0]);
  });
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    jobs[i].id = std::uint32_t(i);
    for (const std::uint32_t tile : jobs[i].tiles) jobs[i].tile_sources.push_back(surveys[tile].source);
    jobs[i].fingerprint = cell_fingerprint(jobs[i], parameters, sources.origin, jobs[i].tile_sources);
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

BakePlan make_plan(std::vector<TileSurvey> surveys, const SceneSources& sources, const BakeParameters& parameters) {
  std::sort(surveys.begin(), surveys.end(), [](const TileSurvey& a, const TileSurvey& b) { return a.tile < b.tile; });
  refuse_spread_tiles(surveys, parameters.cell_voxels);
  BakePlan plan;
  add_counts(surveys, sources, plan);
  for (const auto& [column, extents] : by_column(surveys)) add_column(column, extents, parameters.cell_voxels, plan);
  name_jobs(surveys, sources, parameters, plan.jobs);
  return plan;
}

}  // namespace gigabake
