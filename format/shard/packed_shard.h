/// A shard whose levels are packed already, for example by a device. The host has no voxel arrays and only writes the
/// file.
#pragma once

#include <filesystem>
#include <vector>

#include "core/codec/packed_level.h"
#include "format/shard/columns/voxel_channel.h"
#include "format/shard/levels/level_summary.h"
#include "format/shard/shard.h"

namespace gigabake {

struct PackedShard {
  ShardHeader header;
  std::vector<PackedColumn> nodes;  ///< columns in the order of packed_nodes()
  NodeTable constants;              ///< the constant nodes: only their class, lod and value
  std::vector<PackedLevel> levels;  ///< [lod]; each has the columns of level_columns()
  DownsampleState above = {};       ///< see Shard::above
};

/// Returns the columns of level `lod` in file order, for shards of the current version.
std::vector<LevelColumn> level_columns(const ShardHeader& header, int lod);

/// Returns the row shapes of the node table's columns, in the order of the file (see NodeColumns).
std::vector<RowShape> packed_nodes(const ShardHeader& header);

/// Writes the shard like write_shard().
/// Exact   Same bytes as write_shard() for the same voxels.
/// Range   Raw columns hold the bytes that write_shard() would pack (core/codec). Stored chunks equal the output of
///         encode_chunk().
/// Cost    Reads the bytes of the columns once. Packs the raw columns.
/// Errors  InputError: see write_shard().
StoredShard write_packed_shard(const std::filesystem::path& path, const PackedShard& shard,
                               const ShardWriteOptions& options);

std::vector<LevelSummary> summarize_levels(const PackedShard& shard);
/// Returns the number of voxels per lod, including those that constant nodes represent.
std::vector<std::uint64_t> count_voxels(const PackedShard& shard);

}  // namespace gigabake
