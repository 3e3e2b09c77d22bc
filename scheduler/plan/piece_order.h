/// Selection and size of the sample pieces from which a whole bake is estimated.
#pragma once

#include <cstdint>
#include <vector>

#include "format/job/tile_scan.h"

namespace gigabake {

struct Piece {
  std::uint32_t tile = 0;
  ColumnExtent column;
};

/// Returns the indices of weights above 0 in random order. Each position is drawn among the remaining indices, with
/// probabilities proportional to their weights.
/// Exact   The order depends only on the weights and the seed.
std::vector<std::uint32_t> weighted_order(const std::vector<std::uint64_t>& weights, std::uint64_t seed);

/// Returns the columns of scanned tiles in the order in which to bake them: weighted_order() by projected voxels.
/// `all_tiles` is true if `scans` covers all tiles. If it is false, weighted_order() has selected the tiles. The
/// columns of each tile are then ordered separately, and the result takes one column of each tile in rotation.
std::vector<Piece> piece_order(const std::vector<TileScan>& scans, bool all_tiles, std::uint64_t seed);

/// Returns the edge in voxels of cells in which a surface has at most `voxels` voxels. It is a power of two from 64 (or
/// cell_voxels, if smaller) to cell_voxels.
std::uint32_t piece_voxels(double voxels, std::uint32_t cell_voxels);

}  // namespace gigabake
