/// How many rows of a column a chunk has, and how many chunks that makes.
///
/// A stored chunk is always whole: zeros stand after the data's end.
/// Exact  Integers: the same for whoever packs a column.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lattice/host_device.h"

namespace gigabake {

/// Pages of 128 KiB read well from disks; HDF5 slows down beyond a few thousand chunks, so large columns get larger
/// ones. Range  rows ≥ 1.
GB_HD std::size_t rows_per_chunk(std::size_t rows, std::size_t row_bytes) {
  constexpr std::size_t chunk_bytes = 128 << 10, most_chunks = 1024;
  const std::size_t of_a_page = chunk_bytes / row_bytes, of_few = (rows + most_chunks - 1) / most_chunks;
  const std::size_t wanted = of_a_page > of_few ? of_a_page : of_few;
  return wanted < 1 ? 1 : wanted < rows ? wanted : rows;
}

/// 0 where there are no rows.
GB_HD std::size_t chunk_count(std::size_t rows, std::size_t row_bytes) {
  if (rows == 0) return 0;
  const std::size_t per_chunk = rows_per_chunk(rows, row_bytes);
  return (rows + per_chunk - 1) / per_chunk;
}

/// Of the chunk that holds fewer rows too.
GB_HD std::size_t chunk_bytes(std::size_t rows, std::size_t row_bytes) {
  return rows == 0 ? 0 : rows_per_chunk(rows, row_bytes) * row_bytes;
}

}  // namespace gigabake
