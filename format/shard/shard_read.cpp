#include <algorithm>
#include <memory>

#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "format/shard/check/shard_check.h"
#include "format/shard/hdf5/hdf5_rows.h"
#include "format/shard/levels/above.h"
#include "format/shard/levels/coarse_levels.h"
#include "format/shard/packed_shard.h"
#include "format/shard/shard.h"
#include "format/shard/shard_header.h"
#include "format/shard/shard_layout.h"
#include "format/shard/shard_reader.h"

namespace gigabake {
namespace {

/// Reads all rows of the column. A row has `row_bytes / sizeof(T)` items of `out`.
template <class T>
void read_rows(const Hdf5File& file, const Hdf5Column& column, std::vector<T>& out) {
  const Hdf5Rows rows(file, column);
  out.resize(rows.rows() * column.row_bytes() / sizeof(T));
  rows.read(0, rows.rows(), out.data());
}

std::vector<std::uint8_t> read_bytes(const Hdf5File& file, const Hdf5Column& column) {
  std::vector<std::uint8_t> bytes;
  read_rows(file, column, bytes);
  return bytes;
}

/// Adds the message of the InputError that `check` throws, if it does.
template <class Check>
void add_fault(std::vector<std::string>& faults, const Check& check) {
  try {
    check();
  } catch (const InputError& error) {
    faults.emplace_back(error.what());
  }
}

/// Checks that the table has the column with the shape and the chunks that HDF5 finds.
void check_listed(const Hdf5File& file, const Hdf5Column& column, const ChunkTable& table) {
  const ChunkedColumn* listed = table.find(column.name);
  if (listed == nullptr || !IndexedColumn(file, column).matches(*listed))
    file.fail("/chunks", "does not match the dataset " + column.name + "; bake the cell again");
}

}  // namespace

std::vector<DirectionalCoverage> directional_coverage_of_rows(const std::vector<std::uint8_t>& bytes,
                                                              const Hdf5Column& column) {
  const std::size_t width = column.row_bytes();
  std::vector<DirectionalCoverage> out(bytes.size() / width);
  for (std::size_t i = 0; i < out.size(); ++i) std::copy_n(&bytes[width * i], width, out[i].begin());
  return out;
}

ShardReader::ShardReader(const std::filesystem::path& path) : ShardReader(path, Hdf5Turn()) {}

/// Opens the shard during one turn at HDF5.
ShardReader::ShardReader(const std::filesystem::path& path, const Hdf5Turn&)
    : path_(path),
      file_(std::make_unique<const Hdf5File>(Hdf5File::open(path, ChunkPlaces::by_index))),
      header_(read_header(*file_)),
      version_(read_version(*file_)) {}

ShardReader::ShardReader(ShardReader&&) noexcept = default;
ShardReader& ShardReader::operator=(ShardReader&&) noexcept = default;
ShardReader::~ShardReader() = default;

ColumnReads ShardReader::reads() const {
  const ColumnReads by_index = file_->reads(), by_table = with_table_ ? with_table_->reads() : ColumnReads();
  return {by_index.rows + by_table.rows, by_index.bytes + by_table.bytes};
}

NodeTable ShardReader::nodes() const {
  const NodeColumns columns(version_);
  NodeTable n;
  read_rows(data_file(), columns.key, n.key);
  read_rows(data_file(), columns.lod, n.lod);
  read_rows(data_file(), columns.kind, n.kind);
  read_rows(data_file(), columns.child_mask, n.child_mask);
  if (header_.leaf_lod != 0) read_rows(data_file(), columns.leaf_mask, n.leaf_mask);
  read_rows(data_file(), columns.first_child, n.first_child);
  read_rows(data_file(), columns.value, n.value);
  read_rows(data_file(), columns.normal, n.normal);
  if (header_.has_directional_coverage)
    n.directional_coverage = directional_coverage_of_rows(read_bytes(data_file(), columns.directional_coverage),
                                                          columns.directional_coverage);
  if (header_.has_classes) read_rows(data_file(), columns.voxel_class, n.voxel_class);
  n.has_finest_planes = has_finest_planes(version_, header_);
  check_nodes(path_, header_, n);
  return n;
}

BrickLevel ShardReader::level(int lod) const {
  if (lod < 0 || std::uint32_t(lod) >= header_.lods)
    throw InputError(path_, level_group(lod), "the cell has no such level");
  return read_brick_level(FileColumns(data_file()), header_, version_, lod);
}

CoarseLevels ShardReader::coarse_levels(int lod) const {
  return read_coarse_levels(FileColumns(data_file()), header_, version_, lod);
}

DownsampleState ShardReader::above() const {
  const auto hash = read_above_hash(*file_);
  if (!hash) return {};
  const DownsampleStateColumns columns(int(header_.first_lod + header_.lods) - 1);
  DownsampleState above;
  read_rows(data_file(), columns.place, above.place);
  read_rows(data_file(), columns.rgba, above.rgba);
  if (header_.has_normals) read_rows(data_file(), columns.normal, above.normal);
  if (columns.raster.width != 0 && data_file().has_column(columns.raster))
    read_rows(data_file(), columns.raster, above.raster);
  if (data_file().has_column(columns.patch)) read_rows(data_file(), columns.patch, above.patch);
  if (header_.has_classes) read_rows(data_file(), columns.voxel_class, above.voxel_class);
  check_above(path_, header_, above);
  if (hash_of(above) != *hash) file_->fail("/above", "does not match above_hash");
  return above;
}

Shard ShardReader::all() const {
  Shard shard{header_, nodes(), {}, above()};
  shard.levels = read_brick_levels(FileColumns(data_file()), header_, version_, shard.nodes, 0);
  check_leaves(path_, shard.nodes, shard.levels);
  return shard;
}

std::vector<Hdf5Column> ShardReader::columns_of_level(int lod) const {
  std::vector<Hdf5Column> all;
  if (version_ >= first_version_of_differences) {
    for (const LevelColumn column : level_columns(header_, lod)) all.push_back(level_column(lod, column));
    return all;
  }
  const LevelColumns columns(lod);
  all = {columns.mask, columns.first};
  for (const VoxelChannel& channel : stored_channels(version_, header_, lod)) {
    const ChannelColumns of_channel(columns.group, channel);
    all.push_back(of_channel.value);
    for (const Hdf5Column& column : {of_channel.share, of_channel.first})
      if (data_file().has_column(column)) all.push_back(column);
  }
  return all;
}

std::uint64_t ShardReader::stored_bytes(const Hdf5Column& column) const {
  const ChunkedColumn* listed = with_table_ ? with_table_->chunk_table()->find(column.name) : nullptr;
  if (listed == nullptr) return file_->stored_bytes(column);
  std::uint64_t bytes = 0;
  for (const ChunkPlace& chunk : listed->chunks) bytes += chunk.bytes;
  return bytes;
}

std::uint64_t ShardReader::level_bytes(int lod) const {
  std::uint64_t bytes = 0;
  for (const Hdf5Column& column : columns_of_level(lod)) bytes += stored_bytes(column);
  return bytes;
}

std::uint64_t ShardReader::node_bytes() const {
  std::uint64_t bytes = 0;
  for (const Hdf5Column& column : NodeColumns(version_).all(header_)) bytes += stored_bytes(column);
  return bytes;
}

std::vector<Hdf5Column> ShardReader::all_columns() const {
  std::vector<Hdf5Column> all = NodeColumns(version_).all(header_);
  for (int lod = 0; lod < int(header_.lods); ++lod)
    for (Hdf5Column& column : columns_of_level(lod)) all.push_back(std::move(column));
  if (!read_above_hash(*file_)) return all;
  DownsampleStateColumns above(int(header_.first_lod + header_.lods) - 1);
  all.insert(all.end(), {above.place, above.rgba});
  if (header_.has_normals) all.push_back(above.normal);
  for (const Hdf5Column& column : {above.raster, above.patch})
    if (column.width != 0 && file_->has_column(column)) all.push_back(column);
  if (header_.has_classes) all.push_back(above.voxel_class);
  return all;
}

std::vector<std::string> ShardReader::check_chunk_table() {
  const Hdf5Turn turn;  // threads would otherwise wait for each other at each chunk
  std::vector<std::string> faults;
  add_fault(faults, [&] {
    auto with_table = std::make_unique<const Hdf5File>(Hdf5File::open(path_, ChunkPlaces::by_table));
    const ChunkTable* table = with_table->chunk_table();
    if (table == nullptr) return;
    const std::vector<Hdf5Column> all = all_columns();
    for (const Hdf5Column& column : all) add_fault(faults, [&] { check_listed(*file_, column, *table); });
    if (table->names().size() != all.size())
      file_->fail("/chunks", "lists " + pluralize(table->names().size(), "column") + " of " +
                                 std::to_string(all.size()) + "; bake the cell again");
    if (faults.empty()) with_table_ = std::move(with_table);
  });
  return faults;
}

std::vector<std::string> ShardReader::unreadable_columns() const {
  std::vector<std::string> faults;
  const auto try_column = [&](const Hdf5Column& column) {
    add_fault(faults, [&] { read_bytes(data_file(), column); });
  };
  for (const Hdf5Column& column : NodeColumns(version_).all(header_)) try_column(column);
  for (int lod = 0; lod < int(header_.lods); ++lod)
    for (const Hdf5Column& column : columns_of_level(lod)) try_column(column);
  add_fault(faults, [&] { above(); });
  return faults;
}

ShardHeader read_shard_header(const std::filesystem::path& path) { return ShardReader(path).header(); }
NodeTable read_shard_nodes(const std::filesystem::path& path) { return ShardReader(path).nodes(); }
BrickLevel read_shard_level(const std::filesystem::path& path, int lod) { return ShardReader(path).level(lod); }
Shard read_shard(const std::filesystem::path& path) { return ShardReader(path).all(); }

}  // namespace gigabake
