/// How many rows of a column a chunk has.
#pragma once

#include <algorithm>
#include <cstddef>

namespace gigabake {

/// Pages of 128 KiB read well from disks; HDF5 slows down beyond a few thousand chunks, so large columns get larger
/// ones. Range  rows ≥ 1.
inline std::size_t rows_per_chunk(std::size_t rows, std::size_t row_bytes) {
  constexpr std::size_t chunk_bytes = 128 << 10, most_chunks = 1024;
  const std::size_t wanted = std::max(chunk_bytes / row_bytes, (rows + most_chunks - 1) / most_chunks);
  return std::clamp<std::size_t>(wanted, 1, rows);
}

}  // namespace gigabake
