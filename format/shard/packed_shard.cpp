#include "format/shard/packed_shard.h"

#include "format/shard/shard_layout.h"

namespace gigabake {

std::vector<LevelColumn> level_columns(const ShardHeader& header, int lod) {
  std::vector<LevelColumn> columns{LevelColumn::first, LevelColumn::children, LevelColumn::rgb, LevelColumn::alpha};
  const int lattice_lod = int(header.first_lod) + lod;
  if (header.has_normals) columns.push_back(LevelColumn::normal);
  if (header.has_directional_coverage && lattice_lod > 0) columns.push_back(LevelColumn::facing);
  if (has_planes(shard_version, header, lattice_lod)) columns.push_back(LevelColumn::plane);
  if (header.has_classes) columns.push_back(LevelColumn::voxel_class);
  return columns;
}

Hdf5Column level_column(int lod, LevelColumn column) {
  const std::string group = level_group(lod) + "/";
  const auto make = [&](const char* name, Hdf5Type type, std::size_t width) {
    const RowShape row = row_of(column);
    const BytePlanes planes = row.shuffled_bytes == 1           ? BytePlanes::no
                              : row.shuffled_bytes == row.bytes ? BytePlanes::of_rows
                                                                : BytePlanes::of_elements;
    return Hdf5Column{group + name, type, width, planes, row.min_match_bytes};
  };
  switch (column) {
    case LevelColumn::first:
      return make("first", Hdf5Type::u64, 3);
    case LevelColumn::children:
      return make("children", Hdf5Type::u8, 1);
    case LevelColumn::rgb:
      return make("rgb", Hdf5Type::u8, 3);
    case LevelColumn::alpha:
      return make("alpha", Hdf5Type::u8, 1);
    case LevelColumn::normal:
      return make("normal", Hdf5Type::i8, 2);
    case LevelColumn::facing:
      return make("facing", Hdf5Type::u8, coverage_bytes);
    case LevelColumn::voxel_class:
      return {group + "class", Hdf5Type::u16, 1, BytePlanes::of_elements, row_of(column).min_match_bytes};
    default:
      return make("plane", Hdf5Type::u8, 1);
  }
}

std::vector<RowShape> packed_nodes(const ShardHeader& header) {
  static_assert(NodeKind() == NodeKind::brick, "a device leaves zeros where all nodes are bricks");
  std::vector<RowShape> rows;
  for (const Hdf5Column& column : NodeColumns(shard_version).all(header))
    rows.push_back({column.row_bytes(), column.shuffled_bytes(), column.min_match_bytes});
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
