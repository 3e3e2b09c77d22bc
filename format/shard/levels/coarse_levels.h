/// The coarsest levels of a shard, which an overview copies from its child. Their source is the arrays of a cell baked
/// in this process, or a file. Only the file's chunks with these rows are read.
#pragma once

#include <vector>

#include "format/shard/columns/stored_rows.h"
#include "format/shard/packed_shard.h"
#include "format/shard/shard.h"

namespace gigabake {

struct CoarseLevels {
  NodeTable nodes;                 ///< rows of these levels: the first rows of the complete table
  std::vector<BrickLevel> levels;  ///< from level `begin` to the coarsest
};

/// Returns levels [begin, lods) of a shard.
/// Exact   Same rows as ShardReader::all(). Keys and links are derived from the child masks, not read.
/// Range   begin < header.lods.
/// Cost    Reads the node rows of these levels in two columns, node values only if some nodes are constant, and the
///         bricks of these levels.
/// Errors  InputError: file, dataset, row, rule.
CoarseLevels read_coarse_levels(const ColumnSource& source, const ShardHeader& header, std::int32_t version, int begin);
/// Like read_coarse_levels(), for a shard in memory: moves its levels and copies the node rows.
CoarseLevels take_coarse_levels(Shard&& shard, int begin);
/// Like read_coarse_levels(), for a packed shard: unpacks only the chunks that contain these rows.
CoarseLevels unpack_coarse_levels(const PackedShard& shard, int begin);

/// Reads all bricks of one level. `bricks` is the number of brick nodes that the node table has on this level.
/// Errors  InputError: file, dataset, row, rule.
BrickLevel read_brick_level(const ColumnSource& source, const ShardHeader& header, std::int32_t version, int lod,
                            std::uint64_t bricks);

}  // namespace gigabake
