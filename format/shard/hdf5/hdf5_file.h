/// The few things that shards need of HDF5: columns of fixed-width rows and attributes of the root group.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "format/shard/hdf5/chunk_codec.h"
#include "format/shard/hdf5/file_image.h"
#include "format/shard/hdf5/hdf5_call.h"
#include "lattice/thread_pool.h"

namespace gigabake {

/// Little endian, in the file and here.
enum class Hdf5Type : std::uint8_t { u8, i8, u32, i32, u64, i64, f64 };

std::size_t element_bytes(Hdf5Type type);

/// Whether a column's chunks are written byte plane by byte plane: for numbers that rise or are small.
enum class BytePlanes : std::uint8_t { no, yes };

/// One array of fixed-width rows.
struct Hdf5Column {
  std::string name;  ///< "/lod_0/mask"
  Hdf5Type type;
  std::size_t width;  ///< elements a row; 1: the dataset has one dimension
  BytePlanes planes = BytePlanes::no;
  std::size_t row_bytes() const { return width * element_bytes(type); }
  int dimensions() const { return width == 1 ? 1 : 2; }
};

/// A column that is to be written. The data may still have to be made: then a chunk of it exists while it is packed. Or
/// somebody has packed it already.
struct ColumnRows {
  std::string group;  ///< to make before the column; empty: none
  Hdf5Column column;
  std::uint64_t rows;
  /// Rows [first, first + count), wherever they are, or made in `scratch`. Any number of threads.
  std::function<std::span<const std::uint8_t>(std::uint64_t first, std::uint64_t count,
                                              std::vector<std::uint8_t>& scratch)>
      get;
  /// Instead of get: each chunk as it is stored, by the codec that the others are packed with.
  std::span<const std::span<const std::uint8_t>> stored = {};
};

/// What was read of a file's columns since it was opened, of all columns together.
struct ColumnReads {
  std::uint64_t rows = 0;   ///< that callers requested
  std::uint64_t bytes = 0;  ///< of the stored chunks that contain them
};

/// Errors  All members throw InputError: file, object, what failed.
/// Cost    HDF5 serves one thread at a time; chunks are compressed outside of it, and read past it (hdf5_rows.h).
class Hdf5File {
 public:
  /// called: what messages call the file, where it is to get another name once it is whole.
  static Hdf5File create(const std::filesystem::path& path, const std::filesystem::path& called);
  /// In memory, of which image.file() is the file once it is closed. Borrows `image`. called: as above, and no other
  /// open file's.
  static Hdf5File create(FileImage& image, const std::filesystem::path& called);
  static Hdf5File open(const std::filesystem::path& path);

  /// Chunked, each chunk as chunk_codec.h: packed by the threads of `pool`, in one loop over all of them, and stored in
  /// order, as they become ready, by whichever thread has the next. Returns each column's bytes, compressed, without
  /// HDF5's own index. Memory: at worst, where the disk is slow, all that is stored.
  std::vector<std::uint64_t> write_columns(std::span<const ColumnRows> columns, Codec codec, const ThreadPool& pool);
  Hdf5Id open_column(const Hdf5Column& column) const;
  bool has_column(const Hdf5Column& column) const;  ///< whose group is there
  /// As stored: compressed, without HDF5's own index.
  std::uint64_t stored_bytes(const Hdf5Column& column) const;

  void write_attribute(const char* name, Hdf5Type type, const void* data, std::size_t count);  ///< count 0: a scalar
  void write_attribute(const char* name, const std::string& text);
  bool has_attribute(const char* name) const;
  /// Exactly `count` elements (0: a scalar) of `type`.
  void read_attribute(const char* name, Hdf5Type type, void* data, std::size_t count) const;
  std::string read_text(const char* name) const;  ///< a fixed-length string of at most 64 KiB

  ColumnReads reads() const { return {reads_->rows, reads_->bytes}; }
  /// Called by whatever reads this file's columns.
  void add_read_rows(std::uint64_t rows) const { reads_->rows += rows; }
  void add_read_bytes(std::uint64_t bytes) const { reads_->bytes += bytes; }

  const std::filesystem::path& path() const { return path_; }
  /// The system's own handle of the open file, HDF5's still: for pread.
  int descriptor() const;

  void close();
  [[noreturn]] void fail(const std::string& object, const std::string& message) const;

 private:
  friend class ColumnsInOrder;
  Hdf5File(std::filesystem::path path, Hdf5Id file);
  void make_group(const std::string& name);
  Hdf5Id make_column(const Hdf5Column& column, std::uint64_t rows, Codec codec);
  void write_raw_attribute(const char* name, std::int64_t type, const void* data, std::size_t count);

  struct ReadCounters {
    std::atomic<std::uint64_t> rows{0}, bytes{0};
  };

  std::filesystem::path path_;
  Hdf5Id file_;
  std::unique_ptr<ReadCounters> reads_ = std::make_unique<ReadCounters>();
};

}  // namespace gigabake
