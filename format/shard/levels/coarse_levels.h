/// The coarsest levels of a shard. An overview copies these levels from each child. They come from the arrays of a cell
/// that was baked in this process, or from a file. Only the file's chunks with rows of these levels are read.
#pragma once

#include <vector>

#include "format/shard/columns/stored_rows.h"
#include "format/shard/packed_shard.h"
#include "format/shard/shard.h"

namespace gigabake {

struct CoarseLevels {
  NodeTable nodes;                 ///< rows of these levels: the first rows of the complete table
  std::vector<BrickLevel> levels;  ///< bricks from level `begin` to the coarsest level
};

/// Returns levels [begin, lods) of a shard.
/// Exact   Same rows as ShardReader::all(). Keys and links are derived from the child masks, not read.
/// Range   begin < header.lods.
/// Cost    Reads the bricks of these levels, and two columns of their node rows. Reads node values only if some of
///         these nodes are constant.
/// Errors  InputError naming file, dataset, row and rule.
CoarseLevels read_coarse_levels(const ColumnSource& source, const ShardHeader& header, std::int32_t version, int begin);
/// Returns levels [begin, lods) of a shard in memory: moves the bricks and copies the node rows.
CoarseLevels take_coarse_levels(Shard&& shard, int begin);
/// Returns levels [begin, lods) of a packed shard. Unpacks only the chunks that contain rows of these levels.
CoarseLevels unpack_coarse_levels(const PackedShard& shard, int begin);

/// Reads one level, and since version 7 also the coarser levels.
/// Range   lod < header.lods.
/// Errors  InputError naming file, dataset, row and rule.
BrickLevel read_brick_level(const ColumnSource& source, const ShardHeader& header, std::int32_t version, int lod);

/// Reads all bricks of levels [begin, lods). `nodes` has at least the node rows of these levels.
/// Errors  InputError naming file, dataset, row and rule.
std::vector<BrickLevel> read_brick_levels(const ColumnSource& source, const ShardHeader& header, std::int32_t version,
                                          const NodeTable& nodes, int begin);

}  // namespace gigabake
