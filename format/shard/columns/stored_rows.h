/// Interfaces for reading a shard's columns, from a file or from memory.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "format/shard/hdf5/hdf5_file.h"

namespace gigabake {

/// A column that is read by ranges of rows. Thread-safe.
class StoredRows {
 public:
  virtual ~StoredRows() = default;
  virtual std::uint64_t rows() const = 0;
  /// Reads rows [first, first + count).
  /// Range   `to` has the size of `count` rows; first + count ≤ rows().
  /// Errors  InputError: a chunk is missing or damaged.
  virtual void read(std::uint64_t first, std::uint64_t count, void* to) const = 0;
};

/// A source of the columns of one shard.
class ColumnSource {
 public:
  virtual ~ColumnSource() = default;
  /// Returns the path that error messages name.
  virtual const std::filesystem::path& path() const = 0;
  virtual bool has(const Hdf5Column& column) const = 0;
  /// Errors  InputError: the column is missing, or its stored shape differs from `column`.
  virtual std::unique_ptr<StoredRows> open(const Hdf5Column& column) const = 0;
};

/// Calls visit(index, before, rows) for each chunk that rows [first, first + count) overlap, in order. `rows` rows of
/// chunk `index` belong to the range; `before` rows of the chunk precede them.
template <class Visit>
void for_each_chunk_of_rows(std::uint64_t first, std::uint64_t count, std::uint64_t chunk_rows, const Visit& visit) {
  for (const std::uint64_t end = first + count; first < end;) {
    const std::uint64_t before = first % chunk_rows, rows = std::min(end - first, chunk_rows - before);
    visit(first / chunk_rows, before, rows);
    first += rows;
  }
}

/// Reads rows [first, first + count) of a column that is stored in chunks of `chunk_rows` rows.
/// read_chunk(index, raw) must fill `raw` with the first unpacked bytes of chunk `index`.
template <class ReadChunk>
void read_chunked_rows(std::uint64_t first, std::uint64_t count, std::uint64_t chunk_rows, std::size_t row_bytes,
                       void* to, const ReadChunk& read_chunk) {
  auto* out = static_cast<std::uint8_t*>(to);
  std::vector<std::uint8_t> part;
  for_each_chunk_of_rows(first, count, chunk_rows, [&](std::uint64_t index, std::uint64_t before, std::uint64_t rows) {
    if (before == 0) {
      read_chunk(index, std::span(out, rows * row_bytes));
    } else {
      part.resize((before + rows) * row_bytes);
      read_chunk(index, std::span(part));
      std::copy_n(part.end() - std::ptrdiff_t(rows * row_bytes), rows * row_bytes, out);
    }
    out += rows * row_bytes;
  });
}

}  // namespace gigabake
