/// Edits in a plan: the cells that fills add, and edits that change nothing.
#pragma once

#include <cstdint>
#include <vector>

#include "core/octree/parameters.h"
#include "format/edit/edits_in_scene.h"
#include "format/job/cell_job.h"
#include "format/job/tile_scan.h"
#include "format/source/source.h"

namespace gigabake {

/// Appends a cell, without tiles, for each cell in which a fill selects a voxel and that is not among the jobs. In a
/// column of tiles, cells continue the column's stack upwards and downwards. In other columns, cells begin at multiples
/// of their edge. Thus, no other cell depends on the edits.
/// Errors  UsageError with file and key: a fill needs more than max_cells_per_tile cells.
void add_filled_cells(const EditsInScene& edits, const std::vector<TileScan>& scans, const BakeParameters& parameters,
                      std::vector<CellJob>& jobs);

/// Extends the heights of the columns of each tile to the heights to which edits of its source may move it.
/// Errors  UsageError with file and key: a height does not fit the lattice.
void extend_to_moved(const SceneSources& sources, const BakeParameters& parameters, std::vector<TileScan>& scans);

/// Returns a box that contains all filled voxels; empty without fills.
Box3i64 filled_bounds(const EditsInScene& edits);

/// Checks that each edit selects a voxel of at least one cell.
/// Errors  UsageError with file and key for the first edit that does not.
void expect_selecting(const EditsInScene& edits, const std::vector<CellJob>& jobs);

}  // namespace gigabake
