#include "worker/pipeline/shard_from_volume.h"

#include <utility>

namespace gigabake {

Shard shard_from_volume(kernels::CellVolume volume, ShardHeader header) {
  Shard shard;
  shard.header = std::move(header);
  shard.nodes = std::move(volume.nodes);
  for (kernels::Level& level : volume.levels) shard.levels.push_back(std::move(static_cast<BrickLevel&>(level)));
  if (!shard.header.has_directional_coverage) shard.nodes.directional_coverage.clear();
  shard.header.lods = std::uint32_t(shard.levels.size());
  shard.header.content_hash = std::move(volume.content_hash);
  shard.above = std::move(volume.above);
  return shard;
}

PackedShard shard_from_packed(kernels::PackedCell& cell, ShardHeader header) {
  PackedShard shard;
  shard.header = std::move(header);
  shard.nodes = std::move(cell.nodes);
  shard.constants = std::move(cell.constants);
  shard.levels = std::move(cell.levels);
  shard.header.lods = std::uint32_t(shard.levels.size());
  shard.header.content_hash = std::move(cell.content_hash);
  shard.above = std::move(cell.above);
  return shard;
}

}  // namespace gigabake
