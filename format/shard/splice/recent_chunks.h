/// A column of a stored shard that several threads read in the order of its rows, in pieces smaller than a chunk.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "format/shard/hdf5/hdf5_rows.h"

namespace gigabake {

/// Reads a column and keeps its last unpacked chunks, so that a chunk of which two pieces are read is unpacked once.
class RecentChunks {
 public:
  /// Borrows `rows`. `kept` is the number of chunks before the last one that are kept: at least that of the threads.
  RecentChunks(const Hdf5Rows& rows, int kept) : rows_(rows), kept_(std::uint64_t(kept)) {}

  /// Fills `to` with the rows from `first` on. Thread-safe.
  /// Range   `row_bytes` is the size of the column's rows, of which `to` has a whole number.
  /// Errors  The errors of Hdf5Rows::read().
  void read(std::uint64_t first, std::size_t row_bytes, std::span<std::uint8_t> to);

 private:
  struct Chunk {
    std::once_flag unpacked;
    std::vector<std::uint8_t> bytes;
  };
  std::shared_ptr<Chunk> chunk(std::uint64_t index, std::size_t row_bytes);

  const Hdf5Rows& rows_;
  const std::uint64_t kept_;
  std::mutex mutex_;
  std::map<std::uint64_t, std::shared_ptr<Chunk>> chunks_;  ///< by index
};

}  // namespace gigabake
