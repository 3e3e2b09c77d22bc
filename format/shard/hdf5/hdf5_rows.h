/// Random access to the rows of a column. HDF5 is called to locate each chunk once. The dataset of a column with few
/// chunks is closed when it is checked and its chunks are located. Reading, checking and unpacking bypass HDF5, whose
/// lock would admit only one thread at a time.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "format/shard/columns/stored_rows.h"
#include "format/shard/hdf5/hdf5_file.h"

namespace gigabake {

class Hdf5Rows : public StoredRows {
 public:
  /// Borrows `file`. Checks that the dataset's shape and type match `column` and that the stored bytes can expand to
  /// its size.
  /// Errors  InputError naming file, dataset and fault.
  Hdf5Rows(const Hdf5File& file, const Hdf5Column& column);

  std::uint64_t rows() const override { return rows_; }
  /// Returns the rows per chunk; 0 if there are no rows.
  std::uint64_t chunk_rows() const { return chunk_rows_; }
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
  struct Chunk {
    std::uint64_t offset = 0, bytes = 0;  ///< bytes 0: missing
    bool is_filtered = true;              ///< false: stored without one of the filters
  };
  Chunk locate(const Hdf5Call& call, const Hdf5Id& set, std::uint64_t index) const;
  /// Returns the place of a chunk that lies inside of the file.
  Chunk find_chunk(std::uint64_t index) const;
  std::vector<std::uint8_t> bytes_of_chunk(std::uint64_t index) const;
  /// Implements read() with the file's cache of chunks.
  void read_from_cache(std::uint64_t first, std::uint64_t count, std::uint8_t* to) const;
  /// Fills `raw` with the first bytes of chunk `index`.
  void read_chunk(std::uint64_t index, std::span<std::uint8_t> raw) const;
  [[noreturn]] void fail_chunk(std::uint64_t index, const char* message) const;

  const Hdf5File& file_;
  Hdf5Column column_;
  std::optional<Hdf5Id> set_;  ///< none if all chunks are located
  ChunkFilters filters_;
  std::uint64_t rows_ = 0, chunk_rows_ = 0;
  std::uint64_t number_ = 0;  ///< in the file's cache of chunks
  mutable std::mutex mutex_;
  mutable std::unordered_map<std::uint64_t, Chunk> chunks_;  ///< chunks located so far, by index
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
