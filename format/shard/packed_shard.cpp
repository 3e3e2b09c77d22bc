#include "format/shard/packed_shard.h"

#include "format/shard/shard_layout.h"

namespace gigabake {

std::vector<ChannelPlace> packed_channels(const ShardHeader& header, int lod) {
  std::vector<ChannelPlace> places;
  for (const VoxelChannel& channel : stored_channels(shard_version, header, lod))
    places.push_back({channel.array, bytes_a_voxel(channel.array), channel.offset, channel.width});
  return places;
}

std::vector<RowShape> packed_nodes(const ShardHeader& header) {
  static_assert(NodeKind() == NodeKind::brick, "a device leaves zeros where all nodes are bricks");
  std::vector<RowShape> rows;
  for (const Hdf5Column& column : NodeColumns(shard_version).all(header))
    rows.push_back({column.row_bytes(), column.planes == BytePlanes::yes ? element_bytes(column.type) : 1});
  return rows;
}

std::vector<LevelSummary> summarize_levels(const PackedShard& shard) {
  std::vector<AlphaCounts> counts;
  for (const PackedLevel& level : shard.levels) counts.push_back(level.alphas);
  return summarize_levels(counts, shard.constants);
}

std::vector<std::uint64_t> count_voxels(const PackedShard& shard) {
  std::vector<std::uint64_t> counts;
  for (const LevelSummary& level : summarize_levels(shard)) counts.push_back(level.voxels());
  return counts;
}

}  // namespace gigabake
