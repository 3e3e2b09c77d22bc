/// Rows of a column, any range of them. HDF5 is only asked where a chunk lies, once; reading, checking and unpacking it
/// go past the library, whose lock would let one thread work at a time.
#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <unordered_map>

#include "format/shard/hdf5/hdf5_file.h"
#include "format/shard/stored_rows.h"

namespace gigabake {

class Hdf5Rows : public StoredRows {
 public:
  /// Borrows `file`. Shape and type of the dataset are compared with `column`, its size with what is stored.
  /// Errors  InputError: file, dataset, what is wrong with it.
  Hdf5Rows(const Hdf5File& file, const Hdf5Column& column);

  std::uint64_t rows() const override { return rows_; }

  /// Any number of threads. Space  `to` has room for `count` rows; first + count ≤ rows().
  /// Cost    Reads whole chunks, those that the range touches; unpacks each up to the range's end.
  /// Errors  InputError: a chunk is missing, lies outside of the file, or its checksum is wrong.
  void read(std::uint64_t first, std::uint64_t count, void* to) const override;

 private:
  struct Chunk {
    std::uint64_t offset = 0, bytes = 0;
  };
  Chunk find_chunk(std::uint64_t index) const;
  /// The first bytes of chunk `index`, as many as `raw` has.
  void read_chunk(std::uint64_t index, std::span<std::uint8_t> raw) const;
  [[noreturn]] void fail_chunk(std::uint64_t index, const char* message) const;

  const Hdf5File& file_;
  Hdf5Column column_;
  Hdf5Id set_;
  int descriptor_;
  ChunkFilters filters_;
  std::uint64_t file_bytes_, rows_, chunk_rows_ = 0;
  mutable std::mutex mutex_;
  mutable std::unordered_map<std::uint64_t, Chunk> chunks_;  ///< those found so far
};

/// The columns of an open file. Borrows it.
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
