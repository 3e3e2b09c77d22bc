#include "format/shard/levels/brick_walk.h"

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
  for (std::size_t n = 0; n < shard.nodes.kind.size(); ++n) {
    if (shard.nodes.kind[n] == NodeKind::brick) continue;
    const int lod = shard.nodes.lod[n];
    const int lowest = shard.nodes.kind[n] == NodeKind::leaf_constant ? 0 : lod;
    for (int l = lod; l >= lowest; --l) counts[std::size_t(l)] += std::uint64_t(brick_voxels) << 3 * (lod - l);
  }
  return counts;
}

}  // namespace gigabake
