#include "format/export/shard_levels.h"

#include <bit>
#include <utility>

namespace gigabake {
namespace {

LevelIndex lowest_of(const LevelIndex& corner, std::uint64_t key, std::int64_t edge) {
  return corner + LevelIndex(demorton(key)) * edge;
}

/// Calls visit(node, down) for each node that represents voxels of level `shard_lod`. `down` is the number of levels
/// from the node down to this level.
template <class Visit>
void for_each_node_of(const NodeTable& nodes, int shard_lod, const Visit& visit) {
  for (std::size_t n = 0; n < nodes.key.size() && nodes.lod[n] >= shard_lod; ++n) {
    const int down = nodes.lod[n] - shard_lod;
    if (down == 0 || nodes.kind[n] == NodeKind::leaf_constant) visit(n, down);
  }
}

}  // namespace

ShardLevel::ShardLevel(const PagedScene& scene, const SceneCell& shard, int lod) {
  ReadLevel read = read_level(scene, shard, lod);
  const int shard_lod = lod - int(read.header.first_lod);
  const NodeTable& nodes = read.nodes;
  level_ = std::move(read.level);
  level_.directional_coverage = {};
  corner_ = read.header.lattice_min >> lod;
  for_each_node_of(nodes, shard_lod, [&](std::size_t n, int down) {
    if (nodes.kind[n] == NodeKind::brick) {
      keys_.push_back(nodes.key[n]);
      number_.push_back(nodes.value[n]);
      return;
    }
    const std::uint32_t v = nodes.value[n];
    const std::int64_t edge = std::int64_t(brick_edge) << down;
    constants_.push_back({lowest_of(corner_, nodes.key[n], edge),
                          edge,
                          {std::uint8_t(v), std::uint8_t(v >> 8), std::uint8_t(v >> 16), std::uint8_t(v >> 24)},
                          nodes.normal[n],
                          class_of_constant(nodes, n)});
  });
}

std::uint64_t ShardLevel::bytes() const {
  return keys_.size() * 12 + constants_.size() * sizeof(Constant) + level_.mask.size() * 8 + level_.first.size() * 8 +
         level_.rgba.size() + level_.normal.size() + level_.voxel_class.size() * sizeof(VoxelClass);
}

std::vector<Box3i64> bricks_of(const ShardHeader& header, const NodeTable& nodes, int lod) {
  std::vector<Box3i64> boxes;
  const LevelIndex corner = header.lattice_min >> lod;
  for_each_node_of(nodes, lod - int(header.first_lod), [&](std::size_t n, int down) {
    const std::int64_t edge = std::int64_t(brick_edge) << down;
    boxes.push_back(Box3i64::cube(lowest_of(corner, nodes.key[n], edge), edge));
  });
  for (std::size_t n = 0; n < nodes.leaf_mask.size(); ++n) {
    const int down = nodes.lod[n] + int(header.first_lod) - lod;
    for (unsigned rest = down > 0 ? nodes.leaf_mask[n] : 0u; rest != 0; rest &= rest - 1) {
      const std::int64_t edge = std::int64_t(brick_edge / 2) << down;
      boxes.push_back(
          Box3i64::cube(lowest_of(corner, nodes.key[n] << 3 | unsigned(std::countr_zero(rest)), edge), edge));
    }
  }
  return boxes;
}

std::shared_ptr<const ShardLevel> ShardLevels::get(const SceneCell& shard, int lod) {
  return levels_.get({shard.file, lod}, [&] { return read(shard, lod); });
}

void ShardLevels::read_ahead(const SceneCell& shard, int lod) {
  constexpr std::uint64_t bytes_per_voxel = 8;  // colour, normal, class and a share of the masks
  if (shard.voxels.at(std::size_t(lod) - shard.first_lod) > max_bytes_ / 4 / bytes_per_voxel) return;
  levels_.load_ahead({shard.file, lod}, [&] { return read(shard, lod); });
}

std::shared_ptr<const ShardLevel> ShardLevels::read(const SceneCell& shard, int lod) const {
  return std::make_shared<const ShardLevel>(scene_, shard, lod);
}

}  // namespace gigabake
