#include "format/shard/brick_walk.h"

namespace gigabake {
namespace {

std::uint32_t every_third_bit(std::uint64_t v) {
  std::uint32_t r = 0;
  for (int i = 0; i < 21; ++i) r |= std::uint32_t(v >> (3 * i) & 1) << i;
  return r;
}

std::uint64_t to_every_third_bit(std::uint32_t v) {
  std::uint64_t r = 0;
  for (int i = 0; i < 21; ++i) r |= std::uint64_t(v >> i & 1) << (3 * i);
  return r;
}

}  // namespace

BrickPosition brick_position(std::uint64_t key) {
  return {every_third_bit(key), every_third_bit(key >> 1), every_third_bit(key >> 2)};
}

std::uint64_t brick_key(BrickPosition p) {
  return to_every_third_bit(p.x) | to_every_third_bit(p.y) << 1 | to_every_third_bit(p.z) << 2;
}

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
