/// The coarsest levels of a shard by themselves: all that an overview copies of a child. They come from a file, of
/// which only the chunks with these rows are read, or from the arrays of a cell that was baked a moment ago.
#pragma once

#include <vector>

#include "format/shard/packed_shard.h"
#include "format/shard/shard.h"
#include "format/shard/stored_rows.h"

namespace gigabake {

struct CoarseLevels {
  NodeTable nodes;                 ///< the rows of these levels, which are the first of the whole table
  std::vector<BrickLevel> levels;  ///< from the finest of them to the shard's last
};

/// Returns levels [begin, lods) of a shard.
/// Exact   The same rows as ShardReader::all() has. Keys and links are derived from the child masks, not read.
/// Range   begin < header.lods.
/// Cost    Reads the node rows of these levels in two columns, values of nodes only where some are constant, and the
///         bricks of these levels.
/// Errors  InputError: file, dataset, row, rule.
CoarseLevels read_coarse_levels(const ColumnSource& source, const ShardHeader& header, std::int32_t version, int begin);
/// The same of a shard in memory, whose arrays are moved or copied.
CoarseLevels take_coarse_levels(Shard&& shard, int begin);
/// The same of a packed shard: only the chunks with these rows are unpacked.
CoarseLevels unpack_coarse_levels(const PackedShard& shard, int begin);

/// Reads all bricks of one level. bricks: as many as the node table has of this level.
/// Errors  InputError: file, dataset, row, rule.
BrickLevel read_brick_level(const ColumnSource& source, const ShardHeader& header, std::int32_t version, int lod,
                            std::uint64_t bricks);

}  // namespace gigabake
