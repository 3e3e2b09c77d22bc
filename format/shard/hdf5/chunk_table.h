/// The shapes of all columns of a file, and the places of their chunks. The file stores the table in one dataset, so
/// that a reader opens this dataset instead of one per column. HDF5 serves one thread at a time, and opening a dataset
/// takes longer than reading a small column.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/base/rules.h"

namespace gigabake {

/// The place of a stored chunk in its file.
struct ChunkPlace {
  std::uint64_t offset = 0, bytes = 0;  ///< bytes 0: missing
  friend bool operator==(const ChunkPlace&, const ChunkPlace&) = default;
};

/// The shape of a column, and its chunks in order. A column without rows has no chunks.
struct ChunkedColumn {
  std::uint64_t rows = 0, chunk_rows = 0, row_bytes = 0;
  Codec codec = Codec::lz4;
  bool is_shuffled = false;
  std::vector<ChunkPlace> chunks;
  std::uint64_t chunk_count() const { return rows == 0 ? 0 : 1 + (rows - 1) / chunk_rows; }
  friend bool operator==(const ChunkedColumn&, const ChunkedColumn&) = default;
};

/// A table of the columns of a file.
class ChunkTable {
 public:
  /// The stored form of a table.
  struct Stored {
    std::string names;  ///< of the columns, separated by blanks
    /// Per column: rows, rows per chunk, bytes per row and filters, then offset and bytes of each chunk. Bit 0 of the
    /// filters: deflate instead of LZ4; bit 1: shuffle.
    std::vector<std::uint64_t> numbers;
  };

  ChunkTable() = default;
  /// Errors  std::invalid_argument: names and numbers do not match. The places may lie outside of the file.
  explicit ChunkTable(const Stored& stored);

  /// Adds a column.
  /// Range   The table has no column of this name.
  void add(const std::string& name, ChunkedColumn column);
  /// Adds the next chunk of the last column.
  void add_chunk(const ChunkPlace& place) { columns_.at(names_.back()).chunks.push_back(place); }

  Stored stored() const;
  std::span<const std::string> names() const { return names_; }
  /// Returns null if the table has no such column.
  const ChunkedColumn* find(const std::string& name) const;

 private:
  std::vector<std::string> names_;
  std::unordered_map<std::string, ChunkedColumn> columns_;
};

}  // namespace gigabake
