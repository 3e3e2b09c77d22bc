/// Which pieces of a scene are baked to judge the whole by, and how large they are.
#pragma once

#include <cstdint>
#include <vector>

#include "format/job/survey.h"

namespace gigabake {

struct Piece {
  std::uint32_t tile = 0;
  ColumnExtent column;
};

/// The indices of `weights` above 0 in random order, heavy ones rather sooner than later: each place is drawn with
/// chances in proportion to the weights that are left. Exact  The seed decides.
std::vector<std::uint32_t> weighted_order(const std::vector<std::uint64_t>& weights, std::uint64_t seed);

/// The columns of some tiles in the order in which to bake them, by their crossings. all_tiles: there are no others;
/// else the tiles themselves were drawn by weighted_order() and take turns.
std::vector<Piece> piece_order(const std::vector<TileSurvey>& surveys, bool all_tiles, std::uint64_t seed);

/// Edge in voxels of cells in which a sheet of surface has at most so many voxels: a power of two from 64 (or
/// cell_voxels, where that is less) to cell_voxels.
std::uint32_t piece_voxels(double voxels, std::uint32_t cell_voxels);

}  // namespace gigabake
