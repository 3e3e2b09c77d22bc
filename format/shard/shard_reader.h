/// An open shard file, read in parts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "format/shard/shard.h"

namespace gigabake {

struct CoarseLevels;  // format/shard/levels/coarse_levels.h
class Hdf5File;
class Hdf5Turn;
struct Hdf5Column;

/// The amount of data read from all columns of a file since it was opened.
struct ColumnReads {
  std::uint64_t rows = 0;   ///< requested by callers
  std::uint64_t bytes = 0;  ///< size of the stored chunks that contain those rows
};

/// Reader of a shard. Checks every size, count and checksum before using the data. Reads the datasets of the file, not
/// its table of chunks unless check_chunk_table() has compared it, and refuses links to other files.
/// Errors  InputError naming file and dataset, from every member.
class ShardReader {
 public:
  explicit ShardReader(const std::filesystem::path& path);
  ShardReader(ShardReader&&) noexcept;
  ShardReader& operator=(ShardReader&&) noexcept;
  ~ShardReader();

  const std::filesystem::path& path() const { return path_; }
  const ShardHeader& header() const { return header_; }
  NodeTable nodes() const;
  /// Returns one level; it has as many bricks as nodes() lists for it.
  /// Cost    Since version 7 also reads the coarser levels, from which the level is predicted: a third more.
  BrickLevel level(int lod) const;
  /// Returns levels [lod, lods) without reading finer levels.
  /// Range   0 ≤ lod < header().lods.
  CoarseLevels coarse_levels(int lod) const;
  /// Returns the downsample state; it is empty if the shard stores none. Shards before version 4 never store it.
  DownsampleState above() const;
  Shard all() const;

  /// Returns the size of the level's columns on disk in bytes, compressed and without HDF5's metadata.
  std::uint64_t level_bytes(int lod) const;
  std::uint64_t node_bytes() const;
  /// Returns the amount of column data read so far.
  ColumnReads reads() const;
  /// Compares the table of chunks, if the shard has one, with HDF5's indexes of all columns. Returns one message for
  /// each dataset that differs or has a damaged index. If there is none, later reads use the table, and threads that
  /// read other shards do not wait for HDF5. Never throws for damaged data.
  std::vector<std::string> check_chunk_table();
  /// Returns one message for each dataset that cannot be read. Never throws for damaged data.
  std::vector<std::string> unreadable_columns() const;

 private:
  ShardReader(const std::filesystem::path& path, const Hdf5Turn& turn);
  const Hdf5File& data_file() const { return with_table_ ? *with_table_ : *file_; }
  std::uint64_t stored_bytes(const Hdf5Column& column) const;
  std::vector<Hdf5Column> columns_of_level(int lod) const;
  std::vector<Hdf5Column> all_columns() const;

  std::filesystem::path path_;
  std::unique_ptr<const Hdf5File> file_;        ///< located by HDF5's indexes
  std::unique_ptr<const Hdf5File> with_table_;  ///< set once the table is known to match the indexes
  ShardHeader header_;
  std::int32_t version_;
};

}  // namespace gigabake
