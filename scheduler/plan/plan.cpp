#include "scheduler/plan/plan.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include "core/base/pluralize.h"
#include "core/base/quote.h"
#include "format/area/area_in_scene.h"
#include "format/job/fingerprint.h"
#include "format/source/raster/dem.h"
#include "scheduler/plan/edited_cells.h"
#include "scheduler/plan/overviews.h"
#include "scheduler/plan/stated_names.h"

namespace gigabake {
namespace {

/// A column of one tile. It points into the tile's scan result.
struct TileColumn {
  const ColumnExtent* extent;
  std::uint32_t tile;
};

std::int64_t floor_to(std::int64_t v, std::int64_t multiple) {
  const std::int64_t rest = v % multiple;
  return v - (rest < 0 ? rest + multiple : rest);
}

bool spreads_too_far(const TileScan& scan, std::int64_t cell_voxels) {
  std::int64_t cells = 0;
  for (const ColumnExtent& c : scan.columns) {
    cells += std::min((c.z_end - c.z_min) / cell_voxels, max_cells_per_tile) + 1;
    if (cells > max_cells_per_tile) return true;
  }
  return false;
}

/// Replaces the columns of tiles with too many cells by an error.
void refuse_spread_tiles(std::vector<TileScan>& scans, std::uint32_t cell_voxels) {
  for (TileScan& s : scans) {
    if (!spreads_too_far(s, cell_voxels)) continue;
    TileScan refused;
    refused.tile = s.tile;
    refused.error = "needs more than " + std::to_string(max_cells_per_tile) + " cells of " +
                    std::to_string(cell_voxels) +
                    " voxels; enlarge `voxel_size_m` or `cell_voxels`, or check the unit of its coordinates";
    s = std::move(refused);
  }
}

/// Returns all columns sorted by position, then by tile.
std::vector<TileColumn> by_column(const std::vector<TileScan>& scans) {
  std::size_t number = 0;
  for (const TileScan& s : scans) number += s.columns.size();
  std::vector<TileColumn> all;
  all.reserve(number);
  for (const TileScan& s : scans)
    for (const ColumnExtent& c : s.columns) all.push_back({&c, s.tile});
  std::sort(all.begin(), all.end(), [](const TileColumn& a, const TileColumn& b) {
    return std::tie(a.extent->column_y, a.extent->column_x, a.tile) <
           std::tie(b.extent->column_y, b.extent->column_x, b.tile);
  });
  return all;
}

bool same_column(const TileColumn& a, const TileColumn& b) {
  return a.extent->column_x == b.extent->column_x && a.extent->column_y == b.extent->column_y;
}

std::size_t columns_in(const std::vector<TileColumn>& all) {
  std::size_t columns = 0;
  for (std::size_t i = 0; i < all.size(); ++i) columns += i == 0 || !same_column(all[i - 1], all[i]) ? 1 : 0;
  return columns;
}

CellJob empty_job(const ColumnExtent& c, const CellStack& stack, std::int64_t level, std::uint32_t cell_voxels) {
  const std::int64_t n = cell_voxels;
  CellJob job;
  job.name = "c_" + std::to_string(c.column_x) + "_" + std::to_string(c.column_y) + "_" + std::to_string(level);
  job.lattice_min = {c.column_x * n, c.column_y * n, stack.z_min + level * n};
  job.cell_voxels = cell_voxels;
  return job;
}

/// The area of interest on the lattice of a bake.
class PlannedArea {
 public:
  PlannedArea(const SceneSources& sources, const BakeParameters& parameters)
      : frame_{parameters.voxel_size_m, parameters.lattice_origin_m} {
    if (sources.area) area_.emplace(sources.area, sources.origin);
  }
  bool is_restricted() const { return area_.has_value(); }
  bool excludes(const CellJob& job) const {
    return area_ && area_->overlap(frame_, Box3i64::cube(job.lattice_min, job.cell_voxels)) == AreaOverlap::outside;
  }

 private:
  SnapFrame frame_;
  std::optional<AreaInScene> area_;
};

/// Appends the cells of a column's stack that at least one tile overlaps.
void add_column(std::span<const TileColumn> column, const BakeParameters& parameters, std::vector<CellJob>& jobs) {
  const std::uint32_t cell_voxels = parameters.cell_voxels;
  std::int64_t z_min = column[0].extent->z_min, z_end = column[0].extent->z_end;
  for (const TileColumn& t : column) {
    z_min = std::min(z_min, t.extent->z_min);
    z_end = std::max(z_end, t.extent->z_end);
  }
  const CellStack stack = stack_over(z_min, z_end, cell_voxels, parameters.coarsest_lod);
  std::vector<std::pair<std::int64_t, const TileColumn*>> reached;  // pairs of a level in the stack and a tile's column
  for (const TileColumn& t : column) {
    const std::int64_t last = (t.extent->z_end - 1 - stack.z_min) / cell_voxels;
    for (std::int64_t level = (t.extent->z_min - stack.z_min) / cell_voxels; level <= last; ++level)
      reached.push_back({level, &t});
  }
  std::sort(reached.begin(), reached.end());  // keeps the order of tiles in a level: the pointers point into one array
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const auto& [level, t] = reached[i];
    if (i == 0 || reached[i - 1].first != level) jobs.push_back(empty_job(*t->extent, stack, level, cell_voxels));
    jobs.back().tiles.push_back(t->tile);
    jobs.back().triangles += t->extent->triangles;
  }
}

/// Appends the cells of all columns, except cells outside the area. A column's stack does not depend on the area.
void add_columns(const std::vector<TileScan>& scans, const BakeParameters& parameters, const PlannedArea& area,
                 const Progress& progress, std::vector<CellJob>& jobs) {
  const std::vector<TileColumn> all = by_column(scans);
  jobs.reserve(columns_in(all));  // few columns have more than one cell
  progress.step("planning the cells", all.size());
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    while (end < all.size() && same_column(all[begin], all[end])) ++end;
    const auto first = std::ptrdiff_t(jobs.size());
    add_column(std::span(all).subspan(begin, end - begin), parameters, jobs);
    jobs.erase(std::remove_if(jobs.begin() + first, jobs.end(), [&](const CellJob& job) { return area.excludes(job); }),
               jobs.end());
    progress.advance(end - begin);
  }
}

/// Appends the cells that fills add, except cells outside the area. Without an area, checks that each edit selects a
/// voxel of the scene.
void add_edited_cells(const SceneSources& sources, const BakeParameters& parameters, const std::vector<TileScan>& scans,
                      const PlannedArea& area, BakePlan& plan) {
  if (!sources.edits) return;
  const EditsInScene edits(sources.edits, sources.origin, {parameters.voxel_size_m, parameters.lattice_origin_m});
  const auto first = std::ptrdiff_t(plan.jobs.size());
  add_filled_cells(edits, scans, parameters, plan.jobs);
  plan.jobs.erase(std::remove_if(plan.jobs.begin() + first, plan.jobs.end(),
                                 [&](const CellJob& job) { return area.excludes(job); }),
                  plan.jobs.end());
  if (!area.is_restricted()) expect_selecting(edits, plan.jobs);
  plan.bounds = hull(plan.bounds, filled_bounds(edits));
}

/// A summary of warnings from several sources: one line per text, with summed counts.
class WarningSummary {
 public:
  void add(const std::string& name, const SourceWarning& warning) {
    const auto [kind, is_new] = index_.try_emplace(warning.text, kinds_.size());
    if (is_new) kinds_.push_back({warning, name, {name}});
    Kind& known = kinds_[kind->second];
    if (is_new || !known.names.insert(name).second) return;
    known.sum.count += warning.count;
    known.sum.of += warning.of;
  }

  std::vector<std::string> lines() const {
    std::vector<std::string> lines;
    for (const Kind& kind : kinds_) {
      const std::size_t more = kind.names.size() - 1;
      lines.push_back(short_path(kind.first) + (more == 0 ? "" : fmt::format(" and {} more", more)) + ": " +
                      kind.sum.line());
    }
    return lines;
  }

 private:
  struct Kind {
    SourceWarning sum;
    std::string first;
    std::set<std::string> names;  ///< a file placed several times counts once
  };
  std::vector<Kind> kinds_;  ///< in the order of their first occurrence
  std::map<std::string, std::size_t> index_;
};

std::string name_of_file(const SceneSources& sources, const std::filesystem::path& file) {
  return file.lexically_relative(sources.root).generic_string();
}

/// Warns about rasters without any baked surface, if all of their tiles could be read.
void add_empty_rasters(const std::vector<TileScan>& scans, const SceneSources& sources, WarningSummary& kinds) {
  std::map<const DemRaster*, bool> has_terrain;
  for (const TileScan& s : scans)
    if (const auto& dem = sources.tiles[s.tile].dem)
      has_terrain[dem->raster.get()] |= s.triangles != 0 || !s.error.empty();
  for (const TileRef& tile : sources.tiles) {
    if (!tile.dem) continue;
    const auto at = has_terrain.find(tile.dem->raster.get());
    if (at == has_terrain.end() || at->second) continue;
    at->second = true;
    kinds.add(name_of_file(sources, tile.path),
              "contributes nothing: no four neighbouring pixels have a value (nodata, a mask or an alpha band)");
  }
}

std::vector<std::string> warning_lines(const std::vector<TileScan>& scans, const SceneSources& sources) {
  WarningSummary kinds;
  const DemRaster* last = nullptr;
  for (const TileRef& tile : sources.tiles) {
    if (!tile.dem || tile.dem->raster.get() == last) continue;
    last = tile.dem->raster.get();
    for (const DemPart& part : last->parts)
      for (const std::string& warning : part.warnings) kinds.add(name_of_file(sources, part.options.dem), warning);
  }
  add_empty_rasters(scans, sources, kinds);
  for (const TileScan& s : scans)
    for (const SourceWarning& warning : s.warnings)
      if (!warning.is_loss) kinds.add(sources.tiles[s.tile].name, warning);
  return kinds.lines();
}

/// Returns the entry in the list of losses for triangles that are too long to be baked. The tile itself is readable.
SceneLoss far_loss(const TileScan& s, const std::string& tile, double voxel_size_m) {
  const double needed_m = s.reach_m / double(max_side_voxels);
  return {fmt::format("{} of tile {}", pluralize(s.too_far, "triangle"), tile),
          fmt::format("up to {:.3g} voxels ({:.3g} m) long, but at most {} can be baked; fix the distant vertex, or "
                      "set `voxel_size_m` to {:.3g} or more",
                      s.reach_m / voxel_size_m, s.reach_m, max_side_voxels, needed_m * 1.005)};
}

void add_counts(const std::vector<TileScan>& scans, const SceneSources& sources, double voxel_size_m, BakePlan& plan) {
  for (const SkippedSource& s : sources.skipped) {
    if (!s.informative) plan.losses.push_back({s.name, s.reason});
    plan.skipped_points += s.points;
  }
  for (const TileScan& s : scans) {
    plan.bounds = hull(plan.bounds, s.bounds);
    plan.triangles += s.triangles;
    plan.tile_triangles.push_back(s.triangles);
    plan.tile_crossings.push_back(0);
    for (const ColumnExtent& c : s.columns) plan.tile_crossings.back() += c.projected_voxels;
    plan.non_finite += s.non_finite;
    plan.zero_area += s.zero_area;
    plan.skipped_points += s.skipped_points;
    plan.skipped_lines += s.skipped_lines;
    if (!s.error.empty()) plan.losses.push_back({"tile " + sources.tiles[s.tile].name, s.error});
    for (const SourceWarning& w : s.warnings)
      if (w.is_loss) plan.losses.push_back({"a part of tile " + sources.tiles[s.tile].name, w.line()});
    if (s.too_far != 0) plan.losses.push_back(far_loss(s, sources.tiles[s.tile].name, voxel_size_m));
  }
}

/// Returns the smallest box that contains all cells.
Box3i64 box_of(const std::vector<CellJob>& cells) {
  Box3i64 box;
  for (const CellJob& job : cells) box = hull(box, Box3i64::cube(job.lattice_min, job.cell_voxels));
  return box;
}

void name_jobs(const std::vector<TileScan>& scans, const SceneSources& sources, const BakeParameters& parameters,
               const Progress& progress, std::vector<CellJob>& jobs) {
  std::sort(jobs.begin(), jobs.end(), [](const CellJob& a, const CellJob& b) {
    return std::tie(a.lattice_min[2], a.lattice_min[1], a.lattice_min[0]) <
           std::tie(b.lattice_min[2], b.lattice_min[1], b.lattice_min[0]);
  });
  const CellFingerprints fingerprints(parameters, sources);
  progress.step("naming the cells", jobs.size());
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    progress.advance();
    jobs[i].id = std::uint32_t(i);
    for (const std::uint32_t tile : jobs[i].tiles) jobs[i].tile_sources.push_back(scans[tile].source);
    jobs[i].fingerprint = fingerprints.of(jobs[i], jobs[i].tile_sources);
  }
}

}  // namespace

CellStack stack_over(std::int64_t z_min, std::int64_t z_end, std::int64_t cell_voxels, std::uint32_t coarsest_lod) {
  // A stack starts at a multiple of the coarsest level's voxel, so that every level of every cell lies on one grid.
  const std::int64_t octant = coarsest_lod == 0 ? 0 : std::int64_t(brick_edge / 2) << coarsest_lod;
  const std::int64_t step = std::max({std::int64_t(brick_edge), cell_voxels / brick_edge, octant});
  for (std::int64_t cells = (z_end - z_min + cell_voxels - 1) / cell_voxels;; ++cells) {
    const std::int64_t spare = cells * cell_voxels - (z_end - z_min);
    std::int64_t start = floor_to(z_min - spare / 2, step);
    if (start + cells * cell_voxels < z_end) start += step;
    if (start <= z_min && start + cells * cell_voxels >= z_end) return {start, cells};
  }
}

BakePlan make_plan(std::vector<TileScan> scans, const SceneSources& sources, const BakeParameters& parameters,
                   PlanLevels levels, const Progress& progress) {
  progress.step("planning");
  std::sort(scans.begin(), scans.end(), [](const TileScan& a, const TileScan& b) { return a.tile < b.tile; });
  expect_stated_names(scans, sources);
  extend_to_moved(sources, parameters, scans);
  refuse_spread_tiles(scans, parameters.cell_voxels);
  BakePlan plan;
  add_counts(scans, sources, parameters.voxel_size_m, plan);
  plan.warnings = warning_lines(scans, sources);
  plan.precision = source_precision(scans, sources, parameters.voxel_size_m);
  const PlannedArea area(sources, parameters);
  add_columns(scans, parameters, area, progress, plan.jobs);
  add_edited_cells(sources, parameters, scans, area, plan);
  if (area.is_restricted()) plan.bounds = intersection(plan.bounds, box_of(plan.jobs));
  name_jobs(scans, sources, parameters, progress, plan.jobs);
  if (levels == PlanLevels::cells_and_overviews) add_overviews(plan.jobs);
  return plan;
}

}  // namespace gigabake
