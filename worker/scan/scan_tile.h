/// First step of a bake: scans the columns that one tile covers.
#pragma once

#include <cstdint>

#include "core/base/thread_pool.h"
#include "core/octree/parameters.h"
#include "format/job/tile_scan.h"
#include "format/source/source.h"
#include "worker/tiles/tile_store.h"

namespace gigabake {

/// Reads the tile's positions and finds the columns, of parameters.cell_voxels² voxels, that the tile covers. Each
/// column has a height range that contains every voxel that parameters.surface can occupy, and the number of triangles
/// that may overlap it. The store loads tiles for which TileStore::may_be_large() is true, so that their clusters are
/// on scratch before the first cell is baked. If the store has no scratch folder, such a tile is read twice, part by
/// part. If the store is null, every tile is read as a whole.
/// Exact   The result is equal for any number of threads, with and without a store.
/// Instances  A primitive placed at least 16 times, with more than 2^20 triangles in all placements together, is
///         scanned by the boxes of its placements. Columns and heights may then extend slightly beyond the primitive's
///         triangles, and a column counts all triangles of an instance whose box overlaps it.
/// Too far  A triangle is omitted and counted if a side of its box exceeds max_triangle_side
///         (worker/scan/long_triangles.h) or a vertex is beyond the lattice.
/// Cost    Time is linear in triangles, boxes and columns; a tile with more than 2^21 columns is an error.
/// Errors  Throws nothing: TileScan::error holds one line with the reason why the tile has no columns.
TileScan scan_tile(const SceneSources& sources, std::uint32_t tile, const BakeParameters& parameters,
                   const ThreadPool& pool, const TileStore* store = nullptr);

}  // namespace gigabake
