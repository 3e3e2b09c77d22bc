/// Plan of a bake: columns of N×N voxels, each with the smallest stack of N³ cells that covers its height.
///
/// Exact   Equal scan results, sources and parameters give equal plans; the order of the scan results has no effect.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/math/box3.h"
#include "core/octree/parameters.h"
#include "format/job/cell_job.h"
#include "format/job/tile_scan.h"
#include "format/source/source.h"
#include "scheduler/plan/source_precision.h"

namespace gigabake {

struct BakePlan {
  /// Cells, sorted by z, y, x of lattice_min, then overviews, each after its children (scheduler/plan/overviews.h).
  /// jobs[i].id is i.
  std::vector<CellJob> jobs;
  Box3i64 bounds;  ///< lod-0 voxels that contain all voxels of the cells; empty if there are none
  std::uint64_t triangles = 0, non_finite = 0, zero_area = 0, skipped_points = 0, skipped_lines = 0;
  /// Sums of ColumnExtent::projected_voxels over each tile's columns, by index in sources.tiles.
  std::vector<std::uint64_t> tile_crossings;
  std::vector<std::uint64_t> tile_triangles;
  SourcePrecision precision;
  std::vector<std::string> warnings;  ///< deviations of the bake from the files; one line per type of warning
  std::vector<SceneLoss> losses;      ///< losses of the sources, then tiles and parts of tiles that cannot be baked

  std::size_t cells() const {
    return std::size_t(
        std::partition_point(jobs.begin(), jobs.end(), [](const CellJob& j) { return !is_overview(j); }) -
        jobs.begin());
  }
};

/// Max cells of a tile. A tile with more cells counts as lost, because it probably has a wrong unit or vertex.
inline constexpr std::int64_t max_cells_per_tile = std::int64_t(1) << 21;

/// The types of jobs in a plan.
enum class PlanLevels { cells, cells_and_overviews };

/// Makes the plan. `scans` has one entry per entry of sources.tiles. A stack of cells is centred on the height range of
/// its column. It starts at a multiple of the coarsest level's voxel, so that every level of every cell lies on one
/// grid. Cells that no tile overlaps and no edit fills are omitted (scheduler/plan/edited_cells.h).
/// Errors  UsageError with file and key: an edit selects no voxel of the scene, does not fit the lattice, or fills too
///         many cells. UsageError: a source does not fit its classes or voxel sizes (scheduler/plan/stated_names.h).
///         Stopped if `progress` cancels the plan.
BakePlan make_plan(std::vector<TileScan> scans, const SceneSources& sources, const BakeParameters& parameters,
                   PlanLevels levels = PlanLevels::cells, const Progress& progress = {});

/// The lowest voxel and the number of cells of a column's stack.
struct CellStack {
  std::int64_t z_min = 0;
  std::int64_t cells = 0;
};
/// Returns the smallest stack that contains the voxels [z_min, z_end). If sources are voxelized at levels up to
/// `coarsest_lod`, octants of this level are aligned in all stacks, because leaves consist of octants.
/// Range   z_min < z_end. A cell has a level `coarsest_lod`.
CellStack stack_over(std::int64_t z_min, std::int64_t z_end, std::int64_t cell_voxels, std::uint32_t coarsest_lod = 0);

}  // namespace gigabake
