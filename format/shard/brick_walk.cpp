#include "format/shard/brick_walk.h"

#include <utility>

#include "format/shard/packed_shard.h"

namespace gigabake {
std::vector<LevelNodes> level_nodes(const NodeTable& nodes, std::uint32_t lods) {
  std::vector<LevelNodes> levels(lods);
  std::size_t at = 0;
  for (std::uint32_t lod = lods; lod-- > 0;) {
    levels[lod].begin = at;
    while (at < nodes.lod.size() && nodes.lod[at] == lod) ++at;
    levels[lod].end = at;
  }
  return levels;
}

std::vector<std::uint64_t> count_voxels(const Shard& shard) {
  std::vector<std::uint64_t> counts;
  for (const BrickLevel& level : shard.levels) counts.push_back(level.rgba.size() / 4);
  return count_voxels(std::move(counts), shard.nodes);
}

std::vector<std::uint64_t> count_voxels(const PackedShard& shard) {
  std::vector<std::uint64_t> counts;
  for (const PackedLevel& level : shard.levels) counts.push_back(level.voxels);
  return count_voxels(std::move(counts), shard.nodes);
}

std::vector<std::uint64_t> count_voxels(std::vector<std::uint64_t> in_bricks, const NodeTable& nodes) {
  for (std::size_t n = 0; n < nodes.kind.size(); ++n) {
    if (nodes.kind[n] == NodeKind::brick) continue;
    const int lod = nodes.lod[n];
    const int lowest = nodes.kind[n] == NodeKind::leaf_constant ? 0 : lod;
    for (int l = lod; l >= lowest; --l) in_bricks[std::size_t(l)] += std::uint64_t(brick_voxels) << 3 * (lod - l);
  }
  return in_bricks;
}

}  // namespace gigabake
