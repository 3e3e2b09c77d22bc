#include "scheduler/plan/edited_cells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "format/edit/source_edits_in_scene.h"
#include "scheduler/plan/plan.h"

namespace gigabake {
namespace {

std::int64_t floor_div(std::int64_t v, std::int64_t by) { return v / by - (v % by < 0 ? 1 : 0); }

/// A column of cells that fills may select voxels of.
struct FilledColumn {
  std::vector<std::uint32_t> fills;
  std::optional<std::pair<std::int64_t, std::int64_t>> tiles;  ///< the range of z of its tiles
  std::set<std::int64_t> known;                                ///< lattice_min[2] of its jobs
};
using FilledColumns = std::map<std::pair<std::int64_t, std::int64_t>, FilledColumn>;

/// Returns the number of cells along an axis that the interval overlaps, wherever the cells begin.
std::int64_t max_cells(std::int64_t min, std::int64_t end, std::int64_t n) { return (end - min) / n + 2; }

void expect_few_cells(const EditsInScene& edits, std::uint32_t fill, std::int64_t n) {
  std::int64_t cells = 1;
  for (std::size_t c = 0; c < 3; ++c) cells *= max_cells(edits.bounds(fill).min[c], edits.bounds(fill).end[c], n);
  if (cells <= max_cells_per_tile) return;
  refuse(edits.edit(fill), "needs more than " + std::to_string(max_cells_per_tile) + " cells of " + std::to_string(n) +
                               " voxels; make it smaller, or enlarge `voxel_size_m` or `cell_voxels`");
}

FilledColumns columns_of_fills(const EditsInScene& edits, std::int64_t n) {
  FilledColumns columns;
  for (std::uint32_t e = 0; e < edits.size(); ++e) {
    if (edits.edit(e).type != EditType::fill) continue;
    expect_few_cells(edits, e, n);
    const Box3i64& box = edits.bounds(e);
    for (std::int64_t y = floor_div(box.min[1], n); y <= floor_div(box.end[1] - 1, n); ++y)
      for (std::int64_t x = floor_div(box.min[0], n); x <= floor_div(box.end[0] - 1, n); ++x)
        columns[{x, y}].fills.push_back(e);
  }
  return columns;
}

void add_tiles(const std::vector<TileScan>& scans, FilledColumns& columns) {
  for (const TileScan& scan : scans)
    for (const ColumnExtent& c : scan.columns) {
      const auto found = columns.find({c.column_x, c.column_y});
      if (found == columns.end()) continue;
      auto& range = found->second.tiles;
      range = range ? std::pair(std::min(range->first, c.z_min), std::max(range->second, c.z_end))
                    : std::pair(c.z_min, c.z_end);
    }
}

void add_known(const std::vector<CellJob>& jobs, std::int64_t n, FilledColumns& columns) {
  for (const CellJob& job : jobs)
    if (const auto found = columns.find({floor_div(job.lattice_min[0], n), floor_div(job.lattice_min[1], n)});
        found != columns.end())
      found->second.known.insert(job.lattice_min[2]);
}

CellJob job_at(std::int64_t x, std::int64_t y, std::int64_t level, std::int64_t z_min, std::int64_t n) {
  CellJob job;
  job.name = "c_" + std::to_string(x) + "_" + std::to_string(y) + "_" + std::to_string(level);
  job.lattice_min = {x * n, y * n, z_min};
  job.cell_voxels = std::uint32_t(n);
  return job;
}

/// Appends the cells of a column in which one of its fills selects a voxel.
void add_cells(const EditsInScene& edits, std::int64_t x, std::int64_t y, const BakeParameters& parameters,
               FilledColumn& column, std::vector<CellJob>& jobs) {
  const std::int64_t n = parameters.cell_voxels;
  const std::int64_t base =
      column.tiles ? stack_over(column.tiles->first, column.tiles->second, n, parameters.coarsest_lod).z_min : 0;
  for (const std::uint32_t fill : column.fills) {
    const Box3i64& box = edits.bounds(fill);
    const std::int64_t last = floor_div(box.end[2] - 1 - base, n);
    for (std::int64_t level = floor_div(box.min[2] - base, n); level <= last; ++level) {
      CellJob job = job_at(x, y, level, base + level * n, n);
      if (column.known.contains(job.lattice_min[2])) continue;
      if (!edits.selects_any(fill, Box3i64::cube(job.lattice_min, n))) continue;
      column.known.insert(job.lattice_min[2]);
      jobs.push_back(std::move(job));
    }
  }
}

/// Extends a column to the heights to which edits move a surface there.
void extend(const SourceEditsInScene& edits, const SnapFrame& frame, std::int64_t n, ColumnExtent& column) {
  const Vec3i64 min{column.column_x * n, column.column_y * n, 0};
  for (const SourceEditInScene& edit : edits) {
    const SceneRange range = range_of(frame, {{min[0], min[1], column.z_min}, {min[0] + n, min[1] + n, column.z_end}});
    if (!edit.moves() || !edit.affects(range)) continue;
    const auto voxel = [&](double z_m) {
      return std::int64_t(std::floor((z_m - frame.lattice_origin_m[2]) / frame.voxel_size_m));
    };
    const auto [low_m, high_m] = edit.moved_range(range);
    column.z_min = std::min(column.z_min, voxel(low_m) - 1), column.z_end = std::max(column.z_end, voxel(high_m) + 2);
  }
}

}  // namespace

void extend_to_moved(const SceneSources& sources, const BakeParameters& parameters, std::vector<TileScan>& scans) {
  const SnapFrame frame{parameters.voxel_size_m, parameters.lattice_origin_m};
  std::map<const SourceEdits*, SourceEditsInScene> placed;
  for (TileScan& scan : scans) {
    const SourceEdits* edits = sources.tiles.at(scan.tile).edits.get();
    if (edits == nullptr) continue;
    const auto [at, is_new] = placed.try_emplace(edits);
    if (is_new) at->second = placed_edits(*edits, sources.origin);
    for (ColumnExtent& column : scan.columns) {
      extend(at->second, frame, parameters.cell_voxels, column);
      if (scan.bounds.is_empty()) continue;
      scan.bounds.min[2] = std::min(scan.bounds.min[2], column.z_min);
      scan.bounds.end[2] = std::max(scan.bounds.end[2], column.z_end);
    }
  }
}

void add_filled_cells(const EditsInScene& edits, const std::vector<TileScan>& scans, const BakeParameters& parameters,
                      std::vector<CellJob>& jobs) {
  const std::int64_t n = parameters.cell_voxels;
  FilledColumns columns = columns_of_fills(edits, n);
  if (columns.empty()) return;
  add_tiles(scans, columns);
  add_known(jobs, n, columns);
  for (auto& [at, column] : columns) add_cells(edits, at.first, at.second, parameters, column, jobs);
}

Box3i64 filled_bounds(const EditsInScene& edits) {
  Box3i64 bounds;
  for (std::uint32_t e = 0; e < edits.size(); ++e)
    if (edits.edit(e).type == EditType::fill) bounds = hull(bounds, edits.bounds(e));
  return bounds;
}

void expect_selecting(const EditsInScene& edits, const std::vector<CellJob>& jobs) {
  std::vector<bool> is_selecting(edits.size());
  for (const CellJob& job : jobs)
    for (const std::uint32_t e : edits.selecting(Box3i64::cube(job.lattice_min, job.cell_voxels)))
      is_selecting[e] = true;
  const auto found = std::find(is_selecting.begin(), is_selecting.end(), false);
  if (found == is_selecting.end()) return;
  const Edit& edit = edits.edit(std::uint32_t(found - is_selecting.begin()));
  refuse(edit, "selects no voxel of the scene's cells; check its coordinates, or remove it from the list");
}

}  // namespace gigabake
