/// The subset of HDF5 that shards need: columns of fixed-width rows, and attributes of the root group.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/base/work_counts.h"
#include "format/shard/hdf5/chunk_codec.h"
#include "format/shard/hdf5/chunk_table.h"
#include "format/shard/hdf5/file_image.h"
#include "format/shard/hdf5/hdf5_call.h"
#include "format/shard/shard_reader.h"
#include "format/system/descriptor.h"

namespace gigabake {

/// Element types, little-endian in the file and in memory.
enum class Hdf5Type : std::uint8_t { u8, i8, u16, u32, i32, u64, i64, f64 };

std::size_t element_bytes(Hdf5Type type);

/// The shuffle setting of a column: whether each chunk is stored byte plane by byte plane.
enum class BytePlanes : std::uint8_t {
  no,
  of_elements,  ///< for columns of ascending or small numbers
  of_rows,      ///< for columns whose bytes have different meanings; the column is a list of arrays
};

/// The way in which a reader locates the chunks of a file.
enum class ChunkPlaces : std::uint8_t {
  by_table,  ///< by the table of chunks, if the file has one. Links and datasets are then not looked at
  by_index,  ///< by HDF5's indexes
};

class ChunkCache;

/// The description of one dataset of fixed-width rows.
struct Hdf5Column {
  std::string name;  ///< path in the file, e.g. "/lod_0/mask"
  Hdf5Type type;
  std::size_t width;  ///< elements per row
  BytePlanes planes = BytePlanes::no;
  std::uint32_t min_match_bytes = deflate::min_match;  ///< of deflate, for the writer
  std::size_t row_bytes() const { return width * element_bytes(type); }
  /// Returns 1 if a row is one element or one array, else 2.
  int dimensions() const { return width == 1 || planes == BytePlanes::of_rows ? 1 : 2; }
  /// Returns the size of the dataset's items in bytes, which the shuffle filter separates.
  std::size_t item_bytes() const { return planes == BytePlanes::of_rows ? row_bytes() : element_bytes(type); }
  /// Returns the size of the items that are shuffled; 1: the column is not shuffled.
  std::size_t shuffled_bytes() const { return planes == BytePlanes::no ? 1 : item_bytes(); }
  ChunkFilters filters(Codec codec) const { return {codec, shuffled_bytes(), min_match_bytes}; }
};

/// A column to be written. Its rows may be generated on demand, so that only the chunks that are being packed are in
/// memory. Alternatively, the chunks are packed already.
struct ColumnRows {
  std::string group;  ///< HDF5 group to create before the column; empty: none
  Hdf5Column column;
  std::uint64_t rows;
  /// Returns rows [first, first + count), either in existing memory or generated in `scratch`. Thread-safe.
  std::function<std::span<const std::uint8_t>(std::uint64_t first, std::uint64_t count,
                                              std::vector<std::uint8_t>& scratch)>
      get;
  /// All chunks in stored form, packed by the same codec as the other columns; empty if no chunk is. `get` is called
  /// only for the rows of empty chunks.
  std::span<const std::span<const std::uint8_t>> stored = {};
};

/// A dataset that is open for reading.
struct OpenColumn {
  Hdf5Id set, properties;  ///< creation properties
  bool is_chunked;
};

/// An open HDF5 file.
/// Cost    HDF5 serves one thread at a time. Chunks are therefore compressed and read outside of HDF5 (hdf5_rows.h).
/// Errors  InputError naming file, object and reason, from every member.
class Hdf5File {
 public:
  /// Creates a file at `path`. Messages name the file `called`, which is its path after publication.
  static Hdf5File create(const std::filesystem::path& path, const std::filesystem::path& called);
  /// Creates a file in memory and borrows `image`. After close(), image.write_to() writes the file to disk. Messages
  /// name the file `called`.
  static Hdf5File create(FileImage& image, const std::filesystem::path& called);
  /// Opens a file for reading. `chunks` keeps the unpacked chunks that Hdf5Rows reads; null: none are kept.
  static Hdf5File open(const std::filesystem::path& path, ChunkPlaces places, std::shared_ptr<ChunkCache> chunks = {});

  /// Writes the columns in chunks, encoded as in chunk_codec.h. The threads of `pool` pack the chunks in one loop over
  /// all columns. One thread at a time stores the chunks that are ready, in order.
  /// Returns the stored size of each column in bytes, compressed and without HDF5's metadata.
  /// Cost    Holds up to all stored chunks in memory if the disk is slow.
  std::vector<std::uint64_t> write_columns(std::span<const ColumnRows> columns, Codec codec, const ThreadPool& pool);
  /// Writes the table of the chunks that write_columns() has written. Nothing may be written after it but attributes.
  void write_chunk_table(Codec codec);
  /// Returns the table of chunks of a file that was opened by_table; null if the file has none, or was opened by_index.
  /// Reads it at the first call. A file with a table is then closed at HDF5, which keeps half a megabyte per open file;
  /// attributes and datasets cannot be read afterwards. Thread-safe.
  const ChunkTable* chunk_table() const;
  /// Opens a dataset. Rejects datasets whose data is in other files.
  OpenColumn open_column(const Hdf5Column& column) const;
  bool has_column(const Hdf5Column& column) const;  ///< also false if the column's group is missing
  /// Returns the stored size of the column in bytes, compressed and without HDF5's metadata, of a file that was opened
  /// by_index.
  std::uint64_t stored_bytes(const Hdf5Column& column) const;

  void write_attribute(const char* name, Hdf5Type type, const void* data, std::size_t count);  ///< count 0: a scalar
  void write_attribute(const char* name, const std::string& text);
  bool has_attribute(const char* name) const;
  /// Reads exactly `count` elements (0: a scalar) of `type`.
  void read_attribute(const char* name, Hdf5Type type, void* data, std::size_t count) const;
  std::string read_text(const char* name) const;  ///< a fixed-length string of at most 64 KiB

  ColumnReads reads() const { return {reads_->rows, reads_->bytes}; }
  /// Adds `rows` to the sum that reads() returns. All code that reads columns of this file calls add_read_rows().
  void add_read_rows(std::uint64_t rows) const {
    reads_->rows += rows;
    count_work(WorkCounter::shard_rows_read, rows);
  }
  void add_read_bytes(std::uint64_t bytes) const {
    reads_->bytes += bytes;
    count_work(WorkCounter::shard_bytes_read, bytes);
  }

  const std::filesystem::path& path() const { return path_; }
  /// Returns the cache of unpacked chunks; null if there is none.
  ChunkCache* chunks() const { return chunks_.get(); }
  /// Returns the file descriptor of a file that was opened for reading, for pread().
  int descriptor() const { return descriptor_.get(); }
  /// Returns the size that the file had when it was opened for reading.
  std::uint64_t bytes() const { return bytes_; }

  void close();
  [[noreturn]] void fail(const std::string& object, const std::string& message) const;

 private:
  friend class ColumnsInOrder;
  Hdf5File(std::filesystem::path path, Hdf5Id file);
  void make_group(const std::string& name);
  Hdf5Id make_column(const Hdf5Column& column, std::uint64_t rows, Codec codec);
  void read_chunk_table() const;
  /// Stores the chunk of a column that begins with `first_row`, and adds its place to the table.
  void write_chunk(const Hdf5Id& set, const Hdf5Column& column, std::uint64_t first_row,
                   std::span<const std::uint8_t> bytes);
  /// Sets the memory of the next chunks. Has no effect on a file on disk.
  void set_chunk_memory(ChunkMemory chunks) const {
    if (image_ != nullptr) image_->set_chunk_memory(chunks);
  }
  void write_raw_attribute(const char* name, std::int64_t type, const void* data, std::size_t count);

  /// The table of chunks: of a file being written, or as read.
  struct TableState {
    std::atomic<bool> is_read = false;  ///< the next members never change afterwards
    bool exists = false;
    ChunkTable table;
  };
  struct ReadCounters {
    std::atomic<std::uint64_t> rows{0}, bytes{0};
  };

  std::filesystem::path path_;
  mutable Hdf5Id file_;
  Descriptor descriptor_;  ///< of a file opened for reading, like bytes_
  std::uint64_t bytes_ = 0;
  FileImage* image_ = nullptr;  ///< of a file in memory
  std::shared_ptr<ChunkCache> chunks_;
  std::unique_ptr<TableState> table_ = std::make_unique<TableState>();
  std::unique_ptr<ReadCounters> reads_ = std::make_unique<ReadCounters>();
};

}  // namespace gigabake
