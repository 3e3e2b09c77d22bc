/// Which cells a bake consists of: columns of N×N voxels, each with the smallest stack of N³ cells over its height.
///
/// Exact  A pure function: equal surveys give equal plans, in whatever order they arrived.
#pragma once

#include <optional>
#include <vector>

#include "format/cell_job.h"
#include "format/parameters.h"
#include "format/survey.h"

namespace gigabake {

struct BakePlan {
  std::vector<CellJob> jobs;  ///< by lattice_min z, y, x; jobs[i].id is i
  std::uint64_t triangles = 0, non_finite = 0, zero_area = 0, skipped_points = 0, skipped_lines = 0;
  std::vector<SceneLoss> losses;  ///< tiles that could not be read
};

/// surveys: one per tile. tile_names: of all tiles, for the losses. A stack is centred on its column's height and
/// starts at a multiple of 8 voxels, so that lod 0 to 3 lie on the lattice; cells that no tile reaches are left out.
BakePlan make_plan(std::vector<TileSurvey> surveys, const std::vector<std::string>& tile_names,
                   const BakeParameters& parameters, const std::optional<Geodetic>& origin);

/// Lowest voxel and number of cells of the stack over [z_min, z_end). Range  z_min < z_end.
struct CellStack {
  std::int64_t z_min = 0;
  std::int64_t cells = 0;
};
CellStack stack_over(std::int64_t z_min, std::int64_t z_end, std::int64_t cell_voxels);

}  // namespace gigabake
