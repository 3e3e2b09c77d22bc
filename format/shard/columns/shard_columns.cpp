#include "format/shard/columns/shard_columns.h"

#include <algorithm>
#include <atomic>
#include <bit>

#include "core/base/error.h"
#include "format/shard/packed_shard.h"
#include "format/shard/splice/spliced_rows.h"

namespace gigabake {
namespace {

constexpr std::size_t bricks_per_check = 8192;

/// Returns whether level.first counts the mask bits and each array has one entry per voxel.
bool is_consistent(const BrickLevel& level, const std::vector<LevelColumn>& columns, const ThreadPool& pool) {
  const std::size_t bricks = level.mask.size() / 8;
  if (level.mask.size() % 8 != 0 || level.first.size() != bricks + 1 || level.first[0] != 0) return false;
  std::atomic<bool> fits{true};
  pool.parallel_for(bricks, bricks_per_check, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t b = begin; b < end; ++b) {
      std::uint64_t voxels = 0;
      for (std::size_t w = 0; w < 8; ++w) voxels += std::uint64_t(std::popcount(level.mask[8 * b + w]));
      if (level.first[b + 1] != level.first[b] + voxels) fits = false;
    }
  });
  const auto has = [&](LevelColumn column) { return std::ranges::find(columns, column) != columns.end(); };
  const std::uint64_t voxels = level.first.back();
  return fits && level.rgba.size() == 4 * voxels && (level.normal.size() == 2 * voxels || !has(LevelColumn::normal)) &&
         (level.voxel_class.size() == voxels || !has(LevelColumn::voxel_class)) &&
         (level.directional_coverage.size() == directional_coverage_bytes * voxels ||
          !(has(LevelColumn::facing) || has(LevelColumn::plane)));
}

}  // namespace

StoredShard ShardColumns::stored_bytes(const std::vector<std::uint64_t>& stored) const {
  StoredShard out;
  out.levels.resize(std::size_t(lods_));
  for (std::size_t c = 0; c < columns_.size(); ++c)
    if (part_[c] != of_above) (part_[c] == of_nodes ? out.nodes : out.levels[std::size_t(part_[c])]) += stored[c];
  return out;
}

void ShardColumns::add_bytes(const Hdf5Column& column, std::uint64_t rows, const std::uint8_t* bytes) {
  const std::size_t row = column.row_bytes();
  add(column, rows, [bytes, row](std::uint64_t first, std::uint64_t count, auto&) {
    return std::span(bytes + first * row, count * row);
  });
}

/// Adds all rows in `values`.
template <class T>
void ShardColumns::add_array(const Hdf5Column& column, const std::vector<T>& values) {
  add_bytes(column, values.size() * sizeof(T) / column.row_bytes(),
            reinterpret_cast<const std::uint8_t*>(values.data()));
}

void ShardColumns::add_packed(const Hdf5Column& column, const PackedColumn& packed) {
  add_bytes(column, packed.rows, packed.raw.data());
  columns_.back().stored = packed.stored;
}

void ShardColumns::add_nodes(const NodeTable& n) {
  group_ = "/nodes";
  NodeColumns(shard_version).for_each(header_, [&](const Hdf5Column& column, auto array) {
    add_array(column, n.*array);
  });
}

void ShardColumns::add_nodes(const std::vector<PackedColumn>& nodes) {
  group_ = "/nodes";
  const std::vector<Hdf5Column> all = NodeColumns(shard_version).all(header_);
  for (std::size_t c = 0; c < all.size(); ++c) add_packed(all[c], nodes.at(c));
}

void ShardColumns::add_above(const DownsampleState& above) {
  if (above.empty()) return;
  next_part_ = of_above;
  const DownsampleStateColumns names(int(header_.first_lod + header_.lods) - 1);
  group_ = "/above";
  add_array(names.place, above.place);
  add_array(names.rgba, above.rgba);
  if (!above.normal.empty()) add_array(names.normal, above.normal);
  if (!above.raster.empty()) add_array(names.raster, above.raster);
  if (!above.patch.empty()) add_array(names.patch, above.patch);
  if (!above.voxel_class.empty()) add_array(names.voxel_class, above.voxel_class);
}

void ShardColumns::begin_level() {
  next_part_ = lods_;
  group_ = level_group(lods_++);
}

void ShardColumns::add_levels(const NodeTable& nodes, const std::vector<BrickLevel>& levels, const ThreadPool& pool) {
  std::vector<std::size_t> bricks;
  for (std::size_t lod = 0; lod < levels.size(); ++lod) {
    if (!is_consistent(levels[lod], level_columns(header_, int(lod)), pool))
      throw InputError(header_.cell, level_group(int(lod)), "the arrays of the level do not match each other");
    bricks.push_back(levels[lod].mask.size() / 8);
  }
  std::vector<std::vector<BrickParent>> parents = brick_parents(nodes, bricks);
  for (std::size_t lod = 0; lod < levels.size(); ++lod) {
    const std::vector<LevelColumn> columns = level_columns(header_, int(lod));
    const bool has_coverage = std::ranges::find(columns, LevelColumn::facing) != columns.end();
    const BrickLevel* above = lod + 1 < levels.size() ? &levels[lod + 1] : nullptr;
    add_level(levels_.emplace_back(levels[lod], above, std::move(parents[lod]), has_coverage, pool));
  }
}

void ShardColumns::add_level(const LevelDifferences& level) {
  begin_level();
  for (const LevelColumn column : level_columns(header_, lods_ - 1)) {
    const Hdf5Column stored = level_column(lods_ - 1, column);
    add(stored, level.rows(column),
        [&level, column, width = stored.row_bytes()](std::uint64_t first, std::uint64_t count, auto& scratch) {
          scratch.resize(count * width);
          level.collect(column, first, scratch);
          return std::span<const std::uint8_t>(scratch);
        });
  }
}

void ShardColumns::add_level(const SplicedRows& level) {
  begin_level();
  for (const LevelColumn column : level_columns(header_, lods_ - 1)) {
    add(level_column(lods_ - 1, column), level.rows(column),
        [&level, column](std::uint64_t first, std::uint64_t count, auto& scratch) {
          level.collect(column, first, count, scratch);
          return std::span<const std::uint8_t>(scratch);
        });
    columns_.back().stored = level.copied_chunks(column);
  }
}

void ShardColumns::add_level(const PackedLevel& level) {
  begin_level();
  for (const LevelColumn column : level_columns(header_, lods_ - 1))
    add_packed(level_column(lods_ - 1, column), level[column]);
}

}  // namespace gigabake
