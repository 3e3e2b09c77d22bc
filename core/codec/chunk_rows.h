/// The number of rows per chunk, and the number of chunks, of a column: a dataset of a shard.
///
/// All stored chunks of a column have the same size: the last chunk is padded with zeros.
/// Exact   Integers: all packers return the same numbers.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/host_device.h"

namespace gigabake {

/// Returns the rows per chunk. Chunks of 128 KiB are efficient to read from disks. HDF5 slows down beyond a few
/// thousand chunks, so large columns have larger chunks.
/// Range   rows ≥ 1.
GB_HD std::size_t rows_per_chunk(std::size_t rows, std::size_t row_bytes) {
  constexpr std::size_t chunk_bytes = 128 << 10, max_chunks = 1024;
  const std::size_t of_a_page = chunk_bytes / row_bytes, of_few = (rows + max_chunks - 1) / max_chunks;
  const std::size_t wanted = of_a_page > of_few ? of_a_page : of_few;
  return wanted < 1 ? 1 : wanted < rows ? wanted : rows;
}

/// Returns the number of chunks; 0 if there are no rows.
GB_HD std::size_t chunk_count(std::size_t rows, std::size_t row_bytes) {
  if (rows == 0) return 0;
  const std::size_t per_chunk = rows_per_chunk(rows, row_bytes);
  return (rows + per_chunk - 1) / per_chunk;
}

/// Returns the size of each chunk, including the padded last chunk.
GB_HD std::size_t chunk_bytes(std::size_t rows, std::size_t row_bytes) {
  return rows == 0 ? 0 : rows_per_chunk(rows, row_bytes) * row_bytes;
}

}  // namespace gigabake
