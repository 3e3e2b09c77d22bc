/// Which cells a bake consists of: columns of N×N voxels, each with the smallest stack of N³ cells over its height.
///
/// Exact  A pure function: equal surveys give equal plans, in whatever order they arrived.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "format/job/cell_job.h"
#include "format/job/survey.h"
#include "format/source/source.h"
#include "lattice/parameters.h"
#include "lattice/progress.h"
#include "scheduler/source_precision.h"

namespace gigabake {

struct BakePlan {
  /// Cells by lattice_min z, y, x; then, once they were added (scheduler/parents.h), parents. jobs[i].id is i.
  std::vector<CellJob> jobs;
  std::uint64_t triangles = 0, non_finite = 0, zero_area = 0, skipped_points = 0, skipped_lines = 0;
  /// Of each of sources.tiles: ColumnExtent::crossings of all its columns.
  std::vector<std::uint64_t> tile_crossings;
  std::vector<std::uint64_t> tile_triangles;
  SourcePrecision precision;
  std::vector<std::string> warnings;  ///< what is baked otherwise than files have it; one line per kind
  std::vector<SceneLoss> losses;      ///< what the source lacks, then tiles that could not be read or placed

  std::size_t cells() const {
    return std::size_t(std::partition_point(jobs.begin(), jobs.end(), [](const CellJob& j) { return !is_parent(j); }) -
                       jobs.begin());
  }
};

/// A tile that needs more cells than these is lost with a line that says so: its unit is wrong, or one vertex is.
inline constexpr std::int64_t most_cells_of_a_tile = std::int64_t(1) << 21;

/// surveys: one for each of sources.tiles. A stack is centred on its column's height and starts at a multiple of the
/// coarsest level's voxel, so that every level of every cell lies on one grid; cells that no tile reaches are left out.
/// Errors  Stopped.
BakePlan make_plan(std::vector<TileSurvey> surveys, const SceneSources& sources, const BakeParameters& parameters,
                   const Progress& progress = {});

/// Lowest voxel and number of cells of the stack over [z_min, z_end). Range  z_min < z_end.
struct CellStack {
  std::int64_t z_min = 0;
  std::int64_t cells = 0;
};
CellStack stack_over(std::int64_t z_min, std::int64_t z_end, std::int64_t cell_voxels);

}  // namespace gigabake
