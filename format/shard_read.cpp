#include <sstream>

#include "format/error.h"
#include "format/shard.h"
#include "format/shard_check.h"
#include "format/shard_layout.h"
#include "format/shard_reader.h"

namespace gigabake {
namespace {

template <class T>
T scalar(const Hdf5File& file, const char* name, Hdf5Type type) {
  T value{};
  file.read_attribute(name, type, &value, 0);
  return value;
}

std::vector<Hash128> hashes(const Hdf5File& file, const char* name) {
  std::vector<Hash128> out;
  std::istringstream words(file.read_text(name));
  for (std::string word; words >> word;) {
    const auto h = Hash128::from_hex(word);
    if (!h) file.fail(name, "expected 32 hexadecimal digits, got '" + word + "'");
    out.push_back(*h);
  }
  return out;
}

void check_format(const Hdf5File& file) {
  if (file.read_text("format") != shard_format) file.fail("format", "not a gigabake shard");
  const auto version = scalar<std::int32_t>(file, "version", Hdf5Type::i32);
  if (version != shard_version)
    file.fail("version", "expected " + std::to_string(shard_version) + ", got " + std::to_string(version) +
                             "; another gigabake wrote this shard");
  if (scalar<std::uint32_t>(file, "brick_edge", Hdf5Type::u32) != brick_edge) file.fail("brick_edge", "expected 8");
}

bool read_channels(const Hdf5File& file) {
  const std::string channels = file.read_text("channels");
  if (channels != "rgba" && channels != "rgba normal")
    file.fail("channels", "expected 'rgba' or 'rgba normal', got '" + channels + "'");
  return channels == "rgba normal";
}

ShardHeader read_header(const Hdf5File& file, const std::filesystem::path& path) {
  check_format(file);
  ShardHeader h;
  h.generator = file.read_text("generator");
  h.cell = file.read_text("cell");
  file.read_attribute("lattice_min", Hdf5Type::i64, h.lattice_min.data(), 3);
  h.cell_voxels = scalar<std::uint32_t>(file, "cell_voxels", Hdf5Type::u32);
  h.voxel_size_m = scalar<double>(file, "voxel_size_m", Hdf5Type::f64);
  file.read_attribute("lattice_origin_m", Hdf5Type::f64, h.lattice_origin_m.data(), 3);
  h.lods = scalar<std::uint32_t>(file, "lods", Hdf5Type::u32);
  if (file.has_attribute("origin")) {
    double origin[3];
    file.read_attribute("origin", Hdf5Type::f64, origin, 3);
    h.origin = Geodetic{origin[0], origin[1], origin[2]};
  }
  const std::vector<Hash128> fingerprint = hashes(file, "fingerprint");
  if (fingerprint.size() != 1) file.fail("fingerprint", "expected one hash");
  h.fingerprint = fingerprint[0];
  h.content_hash = hashes(file, "content_hash");
  h.has_normals = read_channels(file);
  h.triangles = scalar<std::uint64_t>(file, "triangles", Hdf5Type::u64);
  check_header(path, h);
  return h;
}

/// Fills `out`, of whose items `row_bytes / sizeof(T)` make a row.
template <class T>
void read_rows(const Hdf5File& file, const Hdf5Column& column, std::vector<T>& out) {
  const std::size_t rows = file.column_rows(column);
  out.resize(rows * column.row_bytes() / sizeof(T));
  file.read_column(column, out.data(), rows);
}

}  // namespace

ShardReader::ShardReader(const std::filesystem::path& path)
    : path_(path), file_(Hdf5File::open(path)), header_(read_header(file_, path)) {}

NodeTable ShardReader::nodes() const {
  const NodeColumns columns;
  NodeTable n;
  read_rows(file_, columns.key, n.key);
  read_rows(file_, columns.lod, n.lod);
  read_rows(file_, columns.kind, n.kind);
  read_rows(file_, columns.child_mask, n.child_mask);
  read_rows(file_, columns.first_child, n.first_child);
  read_rows(file_, columns.value, n.value);
  read_rows(file_, columns.normal, n.normal);
  check_nodes(path_, header_, n);
  return n;
}

BrickLevel ShardReader::level(int lod) const {
  if (lod < 0 || std::uint32_t(lod) >= header_.lods)
    throw InputError(path_, "/lod_" + std::to_string(lod), "the cell has no such level");
  const NodeColumns columns;
  std::vector<std::uint8_t> lods;
  std::vector<NodeKind> kinds;
  read_rows(file_, columns.lod, lods);
  read_rows(file_, columns.kind, kinds);
  if (lods.size() != kinds.size()) file_.fail("/nodes", "columns differ in length");
  return read_level(lod, brick_counts(header_, lods, kinds)[std::size_t(lod)]);
}

BrickLevel ShardReader::read_level(int lod, std::uint64_t bricks) const {
  const LevelColumns columns(lod);
  BrickLevel level;
  read_rows(file_, columns.mask, level.mask);
  read_rows(file_, columns.first, level.first);
  read_rows(file_, columns.rgba, level.rgba);
  if (header_.has_normals) read_rows(file_, columns.normal, level.normal);
  check_level(path_, header_, level, lod, bricks);
  return level;
}

Shard ShardReader::all() const {
  Shard shard{header_, nodes(), {}};
  const std::vector<std::uint64_t> bricks = brick_counts(header_, shard.nodes.lod, shard.nodes.kind);
  for (int lod = 0; lod < int(header_.lods); ++lod) shard.levels.push_back(read_level(lod, bricks[std::size_t(lod)]));
  return shard;
}

std::uint64_t ShardReader::level_bytes(int lod) const {
  std::uint64_t bytes = 0;
  for (const Hdf5Column& column : LevelColumns(lod).all(header_.has_normals)) bytes += file_.stored_bytes(column);
  return bytes;
}

std::uint64_t ShardReader::node_bytes() const {
  std::uint64_t bytes = 0;
  for (const Hdf5Column& column : NodeColumns().all()) bytes += file_.stored_bytes(column);
  return bytes;
}

std::vector<std::string> ShardReader::unreadable_columns() const {
  std::vector<std::string> faults;
  const auto try_column = [&](const Hdf5Column& column) {
    try {
      std::vector<std::uint8_t> rows;
      read_rows(file_, column, rows);
    } catch (const InputError& error) {
      faults.emplace_back(error.what());
    }
  };
  for (const Hdf5Column& column : NodeColumns().all()) try_column(column);
  for (int lod = 0; lod < int(header_.lods); ++lod)
    for (const Hdf5Column& column : LevelColumns(lod).all(header_.has_normals)) try_column(column);
  return faults;
}

ShardHeader read_shard_header(const std::filesystem::path& path) { return ShardReader(path).header(); }
NodeTable read_shard_nodes(const std::filesystem::path& path) { return ShardReader(path).nodes(); }
BrickLevel read_shard_level(const std::filesystem::path& path, int lod) { return ShardReader(path).level(lod); }
Shard read_shard(const std::filesystem::path& path) { return ShardReader(path).all(); }

}  // namespace gigabake
