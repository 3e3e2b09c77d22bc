/// Random access to the rows of a column. The file's table of chunks locates the chunks. In files without a table HDF5
/// is called to locate each chunk once, and the dataset of a column with few chunks is closed at once. Reading,
/// checking and unpacking bypass HDF5, whose lock would admit only one thread at a time.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "format/shard/columns/stored_rows.h"
#include "format/shard/hdf5/hdf5_file.h"
#include "format/shard/hdf5/indexed_column.h"

namespace gigabake {

class Hdf5Rows : public StoredRows {
 public:
  /// Borrows `file`. Checks that the dataset's shape matches `column`, and its type if the file has no table of chunks.
  /// Checks that the stored bytes can expand to its size.
  /// Errors  InputError naming file, dataset and fault.
  Hdf5Rows(const Hdf5File& file, const Hdf5Column& column);
  /// Reads a column that HDF5 locates, even if the file has a table of chunks. Checks and errors are the same.
  Hdf5Rows(const Hdf5File& file, const Hdf5Column& column, IndexedColumn index);

  std::uint64_t rows() const override { return shape_->rows; }
  /// Returns the rows per chunk; 0 if there are no rows.
  std::uint64_t chunk_rows() const { return shape_->chunk_rows; }
  /// Returns a chunk in stored form. Thread-safe.
  /// Errors  InputError: the chunk is missing or damaged.
  std::vector<std::uint8_t> stored_chunk(std::uint64_t index) const;

  /// Reads rows [first, first + count). Thread-safe.
  /// Range   `to` has the size of `count` rows; first + count ≤ rows().
  /// Cost    Reads all chunks that overlap the range, each completely, unless the file's cache has them. Unpacks each
  ///         chunk at least up to the range's end.
  /// Errors  InputError: a chunk is missing, lies outside of the file, or its checksum is wrong.
  void read(std::uint64_t first, std::uint64_t count, void* to) const override;

 private:
  void locate_by_index(IndexedColumn index);
  /// Checks the shape, and sets the filters.
  void accept_shape();
  std::uint64_t raw_chunk_bytes() const { return shape_->chunk_rows * shape_->row_bytes; }
  /// Returns the place of a chunk that lies inside of the file.
  ChunkPlace find_chunk(std::uint64_t index) const;
  std::vector<std::uint8_t> bytes_of_chunk(std::uint64_t index) const;
  /// Implements read() with the file's cache of chunks.
  void read_from_cache(std::uint64_t first, std::uint64_t count, std::uint8_t* to) const;
  /// Fills `raw` with the first bytes of chunk `index`.
  void read_chunk(std::uint64_t index, std::span<std::uint8_t> raw) const;
  [[noreturn]] void fail_chunk(std::uint64_t index, const char* message) const;

  const Hdf5File& file_;
  Hdf5Column column_;
  ChunkFilters filters_;
  const ChunkedColumn* shape_;  ///< in the file's table, or found_
  std::uint64_t number_ = 0;    ///< in the file's cache of chunks
  ChunkedColumn found_;         ///< by HDF5
  /// The dataset of a column whose chunks are located at their first use; none if all chunks are located.
  std::optional<IndexedColumn> index_;
  mutable std::mutex mutex_;
  mutable std::unordered_map<std::uint64_t, ChunkPlace> located_;  ///< by index_ so far
};

/// The columns of an open file. Borrows the file.
class FileColumns : public ColumnSource {
 public:
  explicit FileColumns(const Hdf5File& file) : file_(file) {}
  const std::filesystem::path& path() const override { return file_.path(); }
  bool has(const Hdf5Column& column) const override { return file_.has_column(column); }
  std::unique_ptr<StoredRows> open(const Hdf5Column& column) const override {
    return std::make_unique<Hdf5Rows>(file_, column);
  }

 private:
  const Hdf5File& file_;
};

}  // namespace gigabake
