#include "format/shard/packed_shard.h"

#include "format/shard/shard_layout.h"

namespace gigabake {

std::vector<ChannelPlace> packed_channels(const ShardHeader& header, int lod) {
  std::vector<ChannelPlace> places;
  for (const VoxelChannel& channel : stored_channels(shard_version, header, lod))
    places.push_back({channel.array, bytes_a_voxel(channel.array), channel.offset, channel.width});
  return places;
}

}  // namespace gigabake
