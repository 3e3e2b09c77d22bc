#include "worker/shard_from_volume.h"

#include <utility>

namespace gigabake {
namespace {

static_assert(int(NodeKind::brick) == int(kernels::NodeKind::brick) &&
              int(NodeKind::constant) == int(kernels::NodeKind::constant) &&
              int(NodeKind::leaf_constant) == int(kernels::NodeKind::leaf_constant));

NodeTable to_table(kernels::Nodes nodes) {
  NodeTable table{std::move(nodes.key),        std::move(nodes.lod),         {},
                  std::move(nodes.child_mask), std::move(nodes.first_child), std::move(nodes.value),
                  std::move(nodes.normal),     std::move(nodes.facing)};
  table.kind.reserve(nodes.kind.size());
  for (const kernels::NodeKind kind : nodes.kind) table.kind.push_back(NodeKind(kind));
  return table;
}

}  // namespace

Shard shard_from_volume(kernels::CellVolume volume, ShardHeader header) {
  Shard shard;
  shard.header = std::move(header);
  shard.nodes = to_table(std::move(volume.nodes));
  for (kernels::Level& level : volume.levels)
    shard.levels.push_back({std::move(level.mask), std::move(level.first), std::move(level.rgba),
                            std::move(level.normal), std::move(level.facing)});
  if (!shard.header.has_facing) shard.nodes.facing.clear();
  shard.header.lods = std::uint32_t(shard.levels.size());
  for (const kernels::Sum128& hash : volume.content_hash) shard.header.content_hash.push_back({hash.lo, hash.hi});
  return shard;
}

}  // namespace gigabake
