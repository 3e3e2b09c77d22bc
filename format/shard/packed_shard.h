/// A shard whose levels somebody else has packed, a device for one: the host has no voxels, and only writes.
#pragma once

#include <filesystem>
#include <vector>

#include "format/shard/level_summary.h"
#include "format/shard/shard.h"
#include "format/shard/voxel_channel.h"
#include "lattice/pack/packed_level.h"

namespace gigabake {

struct PackedShard {
  ShardHeader header;
  std::vector<PackedColumn> nodes;  ///< as packed_nodes() asks for
  NodeTable constants;              ///< of the nodes those that are no bricks: kind, lod and value alone
  std::vector<PackedLevel> levels;  ///< [lod]; channels as packed_channels() asks for
  ParentSource above = {};          ///< as Shard has it
};

/// What must be packed of each voxel of a level, in this order, for shards as they are written today.
std::vector<ChannelPlace> packed_channels(const ShardHeader& header, int lod);

/// The rows of the node table's columns, in the order of the file, which is NodeColumn's.
std::vector<RowShape> packed_nodes(const ShardHeader& header);

/// As write_shard().
/// Exact   The same bytes as write_shard() makes of the same voxels, if the columns hold what it would pack
///         (lattice/pack) and, where they come as stored chunks, these are encode_chunk()'s.
/// Cost    The columns' bytes once; what comes raw is packed here.
/// Errors  InputError as write_shard().
StoredShard write_packed_shard(const std::filesystem::path& path, const PackedShard& shard,
                               const ShardWriteOptions& options);

std::vector<LevelSummary> summarize_levels(const PackedShard& shard);
/// Those that constant nodes stand for included.
std::vector<std::uint64_t> count_voxels(const PackedShard& shard);

}  // namespace gigabake
