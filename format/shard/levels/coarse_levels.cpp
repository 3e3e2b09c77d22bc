#include "format/shard/levels/coarse_levels.h"

#include <algorithm>
#include <utility>

#include "format/shard/check/shard_check.h"
#include "format/shard/columns/channel_rows.h"
#include "format/shard/columns/packed_columns.h"
#include "format/shard/columns/parent_voxels.h"
#include "format/shard/columns/predicted_level.h"
#include "format/shard/levels/coarse_nodes.h"
#include "format/shard/shard_layout.h"

namespace gigabake {
namespace {

template <class T>
void read_all(const ColumnSource& source, const Hdf5Column& column, std::vector<T>& out) {
  const std::unique_ptr<StoredRows> rows = source.open(column);
  out.resize(rows->rows() * column.row_bytes() / sizeof(T));
  rows->read(0, rows->rows(), out.data());
}

/// Reads a level of versions 1 to 6.
BrickLevel read_values(const ColumnSource& source, const ShardHeader& header, std::int32_t version, int lod,
                       std::uint64_t bricks) {
  const LevelColumns columns(lod);
  BrickLevel level;
  read_all(source, columns.mask, level.mask);
  read_all(source, columns.first, level.first);
  check_bricks_of_level(source.path(), level, lod, bricks);
  const std::uint64_t voxels = level.first.back();
  for (const VoxelChannel& channel : stored_channels(version, header, lod)) {
    const ChannelRows rows(source, columns.group, channel, bricks, voxels);
    rows.read(0, level.mask, 0, voxels, resize_channel(channel, voxels, level));
  }
  check_coverage(source.path(), lod, 0, level.rgba);
  check_planes(source.path(), lod, 0, level.directional_coverage);
  return level;
}

}  // namespace

std::vector<BrickLevel> read_brick_levels(const ColumnSource& source, const ShardHeader& header, std::int32_t version,
                                          const NodeTable& nodes, int begin) {
  const std::vector<std::uint64_t> counted = brick_counts(header, nodes.lod, nodes.kind);
  const std::vector<std::size_t> bricks(counted.begin(), counted.end());
  const std::vector<std::vector<BrickParent>> parents = brick_parents(nodes, bricks);
  std::vector<BrickLevel> levels(std::size_t(int(header.lods) - begin));
  for (int lod = int(header.lods) - 1; lod >= begin; --lod) {
    BrickLevel& level = levels[std::size_t(lod - begin)];
    const std::uint64_t count = counted[std::size_t(lod)];
    if (version < first_version_of_differences) {
      level = read_values(source, header, version, lod, count);
      continue;
    }
    const SomeBricks above{lod + 1 < int(header.lods) ? &levels[std::size_t(lod + 1 - begin)] : nullptr, 0};
    level = PredictedLevel(source, header, lod, count)
                .read(0, parents[std::size_t(lod)], above, PredictedLevel::Values::all);
  }
  return levels;
}

BrickLevel read_brick_level(const ColumnSource& source, const ShardHeader& header, std::int32_t version, int lod) {
  const NodeTable nodes = read_coarse_nodes(source, header, version, lod);
  if (version >= first_version_of_differences)
    return std::move(read_brick_levels(source, header, version, nodes, lod).front());
  return read_values(source, header, version, lod, brick_counts(header, nodes.lod, nodes.kind)[std::size_t(lod)]);
}

CoarseLevels read_coarse_levels(const ColumnSource& source, const ShardHeader& header, std::int32_t version,
                                int begin) {
  CoarseLevels coarse{read_coarse_nodes(source, header, version, begin), {}};
  coarse.levels = read_brick_levels(source, header, version, coarse.nodes, begin);
  return coarse;
}

CoarseLevels take_coarse_levels(Shard&& shard, int begin) {
  CoarseLevels coarse;
  NodeTable& n = shard.nodes;
  const auto rows =
      std::size_t(std::find_if(n.lod.begin(), n.lod.end(), [begin](int lod) { return lod < begin; }) - n.lod.begin());
  const auto keep = [rows](auto& to, const auto& column) {
    to.assign(column.begin(), column.begin() + std::ptrdiff_t(std::min(rows, column.size())));
  };
  keep(coarse.nodes.key, n.key), keep(coarse.nodes.lod, n.lod), keep(coarse.nodes.kind, n.kind);
  keep(coarse.nodes.child_mask, n.child_mask), keep(coarse.nodes.first_child, n.first_child);
  keep(coarse.nodes.leaf_mask, n.leaf_mask), keep(coarse.nodes.voxel_class, n.voxel_class);
  keep(coarse.nodes.value, n.value), keep(coarse.nodes.normal, n.normal),
      keep(coarse.nodes.directional_coverage, n.directional_coverage);
  coarse.nodes.has_finest_planes = n.has_finest_planes;
  std::move(shard.levels.begin() + begin, shard.levels.end(), std::back_inserter(coarse.levels));
  return coarse;
}

CoarseLevels unpack_coarse_levels(const PackedShard& shard, int begin) {
  return read_coarse_levels(PackedColumns(shard), shard.header, shard_version, begin);
}

}  // namespace gigabake
