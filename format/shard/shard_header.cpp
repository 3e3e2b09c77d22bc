#include "format/shard/shard_header.h"

#include <sstream>

#include "core/base/error.h"
#include "format/shard/check/shard_check.h"
#include "format/shard/columns/channels.h"
#include "format/shard/shard_layout.h"

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
    if (!h) file.fail(name, "expected 32 hexadecimal digits, got " + in_quotes(word));
    out.push_back(*h);
  }
  return out;
}

void read_channels(const Hdf5File& file, ShardHeader& h) {
  const std::string channels = file.read_text("channels");
  const auto parsed = parse_channels(channels);
  if (!parsed)
    file.fail("channels",
              "expected 'rgba', optionally followed by 'normal', 'facing' and 'class', got " + in_quotes(channels));
  h.has_normals = parsed->normals, h.has_directional_coverage = parsed->directional_coverage;
  h.has_classes = parsed->classes;
}

}  // namespace

std::int32_t read_version(const Hdf5File& file) {
  if (file.read_text("format") != shard_format) file.fail("format", "not a gigabake shard");
  const auto version = scalar<std::int32_t>(file, "version", Hdf5Type::i32);
  if (version < oldest_shard_version || version > shard_version)
    file.fail("version", "expected " + std::to_string(oldest_shard_version) + " to " + std::to_string(shard_version) +
                             ", got " + std::to_string(version) + "; another version of gigabake wrote this shard");
  return version;
}

std::optional<Hash128> read_above_hash(const Hdf5File& file) {
  if (!file.has_attribute("above_hash")) return std::nullopt;
  const std::vector<Hash128> hash = hashes(file, "above_hash");
  if (hash.size() != 1) file.fail("above_hash", "expected one hash");
  return hash[0];
}

ShardHeader read_header(const Hdf5File& file) {
  const std::int32_t version = read_version(file);
  if (scalar<std::uint32_t>(file, "brick_edge", Hdf5Type::u32) != brick_edge) file.fail("brick_edge", "expected 8");
  ShardHeader h;
  h.generator = file.read_text("generator");
  h.cell = file.read_text("cell");
  file.read_attribute("lattice_min", Hdf5Type::i64, h.lattice_min.v, 3);
  h.cell_voxels = scalar<std::uint32_t>(file, "cell_voxels", Hdf5Type::u32);
  h.voxel_size_m = scalar<double>(file, "voxel_size_m", Hdf5Type::f64);
  file.read_attribute("lattice_origin_m", Hdf5Type::f64, h.lattice_origin_m.v, 3);
  h.lods = scalar<std::uint32_t>(file, "lods", Hdf5Type::u32);
  if (version >= 4) h.first_lod = scalar<std::uint32_t>(file, "first_lod", Hdf5Type::u32);
  if (version >= 5) h.copied_lods = scalar<std::uint32_t>(file, "copied_lods", Hdf5Type::u32);
  const bool has_leaves =
      version == first_version_of_leaves || (version >= first_version_of_classes && file.has_attribute("leaf_lod"));
  if (has_leaves) h.leaf_lod = scalar<std::uint32_t>(file, "leaf_lod", Hdf5Type::u32);
  if (has_leaves && h.leaf_lod == 0) file.fail("leaf_lod", "expected a level with leaves, got 0");
  if (file.has_attribute("origin")) {
    double origin[3];
    file.read_attribute("origin", Hdf5Type::f64, origin, 3);
    h.origin = Geodetic{origin[0], origin[1], origin[2]};
  }
  const std::vector<Hash128> fingerprint = hashes(file, "fingerprint");
  if (fingerprint.size() != 1) file.fail("fingerprint", "expected one hash");
  h.fingerprint = fingerprint[0];
  h.content_hash = hashes(file, "content_hash");
  read_channels(file, h);
  if (h.has_classes != (version >= first_version_of_classes))
    file.fail("channels", h.has_classes ? "have 'class', which this version does not have" : "lack 'class'");
  h.triangles = scalar<std::uint64_t>(file, "triangles", Hdf5Type::u64);
  check_header(file.path(), h);
  return h;
}

}  // namespace gigabake
