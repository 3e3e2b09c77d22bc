/// First step of a bake: what one tile covers.
#pragma once

#include <cstdint>

#include "format/job/survey.h"
#include "format/source/source.h"
#include "lattice/parameters.h"
#include "lattice/thread_pool.h"
#include "worker/tiles/tile_store.h"

namespace gigabake {

/// Reads the tile's positions and finds its columns of parameters.cell_voxels² voxels, each with a height range that
/// holds every voxel which parameters.surface can occupy, and with the triangles that may touch it.
/// store: gives tiles that may be large (TileStore::may_be_large()), so that their clusters are on scratch before the
/// first cell; where it has no scratch such a tile is read twice, part by part. Null: every tile is read as a whole.
/// Exact   Equal for any number of threads, with a store and without.
/// Instances  A primitive placed at least 16 times, with more than 2^20 triangles in all, is surveyed by the boxes of
///         its placements: columns and heights may then reach a little farther than its triangles, and a column counts
///         all triangles of an instance that reaches it.
/// Too far  A triangle whose box has a side of more than longest_side (worker/far_triangles.h) is left out and counted;
///         so is one with a vertex beyond the lattice.
/// Cost    Time follows triangles, boxes and columns; a tile that spreads over more than 2^21 columns is an error.
/// Errors  None thrown: TileSurvey::error says in one line why the tile has no columns.
TileSurvey survey_tile(const SceneSources& sources, std::uint32_t tile, const BakeParameters& parameters,
                       const ThreadPool& pool, const TileStore* store = nullptr);

}  // namespace gigabake
