#include <sstream>

#include "format/error.h"
#include "format/shard.h"
#include "format/shard_check.h"
#include "format/shard_layout.h"

namespace gigabake {
namespace {

template <class T>
T scalar(const Hdf5File& file, const char* name, hid_t type) {
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

ShardHeader read_header(const Hdf5File& file, const std::filesystem::path& path) {
  if (file.read_text("format") != shard_format) file.fail("format", "not a gigabake shard");
  const auto version = scalar<std::int32_t>(file, "version", H5T_STD_I32LE);
  if (version != shard_version)
    file.fail("version", "expected 1, got " + std::to_string(version) + "; another gigabake wrote this shard");
  if (scalar<std::uint32_t>(file, "brick_edge", H5T_STD_U32LE) != brick_edge) file.fail("brick_edge", "expected 8");
  ShardHeader h;
  h.generator = file.read_text("generator");
  h.cell = file.read_text("cell");
  file.read_attribute("lattice_min", H5T_STD_I64LE, h.lattice_min.data(), 3);
  h.cell_voxels = scalar<std::uint32_t>(file, "cell_voxels", H5T_STD_U32LE);
  h.voxel_size_m = scalar<double>(file, "voxel_size_m", H5T_IEEE_F64LE);
  file.read_attribute("lattice_origin_m", H5T_IEEE_F64LE, h.lattice_origin_m.data(), 3);
  h.lods = scalar<std::uint32_t>(file, "lods", H5T_STD_U32LE);
  if (file.has_attribute("origin")) {
    double origin[3];
    file.read_attribute("origin", H5T_IEEE_F64LE, origin, 3);
    h.origin = Geodetic{origin[0], origin[1], origin[2]};
  }
  const std::vector<Hash128> fingerprint = hashes(file, "fingerprint");
  if (fingerprint.size() != 1) file.fail("fingerprint", "expected one hash");
  h.fingerprint = fingerprint[0];
  h.content_hash = hashes(file, "content_hash");
  h.has_normals = file.read_text("channels").find("normal") != std::string::npos;
  h.triangles = scalar<std::uint64_t>(file, "triangles", H5T_STD_U64LE);
  check_header(path, h);
  return h;
}

/// Fills `out`, whose items are `bytes_per_row / sizeof(T)` to a row.
template <class T>
void read_rows(const Hdf5File& file, const Hdf5Column& column, std::vector<T>& out) {
  const std::size_t rows = file.column_rows(column);
  out.resize(rows * column.width * column.element_bytes / sizeof(T));
  file.read_column(column, out.data(), rows);
}

NodeTable read_nodes(const Hdf5File& file, const std::filesystem::path& path, const ShardHeader& header) {
  const NodeColumns columns;
  NodeTable n;
  read_rows(file, columns.key, n.key);
  read_rows(file, columns.lod, n.lod);
  read_rows(file, columns.kind, n.kind);
  read_rows(file, columns.child_mask, n.child_mask);
  read_rows(file, columns.first_child, n.first_child);
  read_rows(file, columns.value, n.value);
  read_rows(file, columns.normal, n.normal);
  check_nodes(path, header, n);
  return n;
}

BrickLevel read_level(const Hdf5File& file, const std::filesystem::path& path, const ShardHeader& header, int lod) {
  const LevelColumns columns(lod);
  BrickLevel level;
  read_rows(file, columns.mask, level.mask);
  read_rows(file, columns.first, level.first);
  read_rows(file, columns.rgba, level.rgba);
  if (header.has_normals) read_rows(file, columns.normal, level.normal);
  check_level(path, header, level, lod);
  return level;
}

}  // namespace

ShardHeader read_shard_header(const std::filesystem::path& path) { return read_header(Hdf5File::open(path), path); }

NodeTable read_shard_nodes(const std::filesystem::path& path) {
  const Hdf5File file = Hdf5File::open(path);
  return read_nodes(file, path, read_header(file, path));
}

BrickLevel read_shard_level(const std::filesystem::path& path, int lod) {
  const Hdf5File file = Hdf5File::open(path);
  const ShardHeader header = read_header(file, path);
  if (lod < 0 || std::uint32_t(lod) >= header.lods)
    throw InputError(path, "/lod_" + std::to_string(lod), "the cell has no such level");
  return read_level(file, path, header, lod);
}

Shard read_shard(const std::filesystem::path& path) {
  const Hdf5File file = Hdf5File::open(path);
  Shard shard;
  shard.header = read_header(file, path);
  shard.nodes = read_nodes(file, path, shard.header);
  for (int lod = 0; lod < int(shard.header.lods); ++lod)
    shard.levels.push_back(read_level(file, path, shard.header, lod));
  check_bricks_in_use(path, shard);
  return shard;
}

}  // namespace gigabake
