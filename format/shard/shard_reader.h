/// A shard file held open, read part by part.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "format/shard/hdf5/hdf5_file.h"
#include "format/shard/shard.h"

namespace gigabake {

struct CoarseLevels;  // format/shard/coarse_levels.h

/// Every size, count and checksum is checked before what it says is used.
/// Errors  InputError naming file and dataset, from every member.
class ShardReader {
 public:
  explicit ShardReader(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  const ShardHeader& header() const { return header_; }
  NodeTable nodes() const;
  BrickLevel level(int lod) const;  ///< with as many bricks as nodes() has of this level
  /// Returns levels [lod, lods) without reading the others. Range  0 ≤ lod < header().lods.
  CoarseLevels coarse_levels(int lod) const;
  /// Of what levels above are made; empty where the shard keeps none, as those before version 4.
  ParentSource above() const;
  Shard all() const;

  /// As stored on disk: compressed, without HDF5's own index.
  std::uint64_t level_bytes(int lod) const;
  std::uint64_t node_bytes() const;
  /// Returns what was read of the columns so far.
  ColumnReads reads() const { return file_.reads(); }
  /// One message for each dataset that cannot be read. Never throws for damage.
  std::vector<std::string> unreadable_columns() const;

 private:
  BrickLevel read_level(int lod, std::uint64_t bricks) const;
  std::vector<Hdf5Column> level_columns(int lod) const;

  std::filesystem::path path_;
  Hdf5File file_;
  ShardHeader header_;
  std::int32_t version_;
};

}  // namespace gigabake
