/// A column whose shape and chunks are found by HDF5: a dataset and its chunk index.
#pragma once

#include <cstdint>

#include "format/shard/hdf5/chunk_table.h"
#include "format/shard/hdf5/hdf5_file.h"

namespace gigabake {

/// An open dataset. Borrows the file.
class IndexedColumn {
 public:
  /// Checks that the dataset's shape, type and filters are those that `column` has in a shard.
  /// Errors  InputError naming file, dataset and fault.
  IndexedColumn(const Hdf5File& file, const Hdf5Column& column);

  /// Returns the shape without chunks.
  const ChunkedColumn& shape() const { return shape_; }
  /// Returns the place of a chunk. It has 0 bytes if the chunk is missing, or is stored without one of the filters.
  /// Thread-safe.
  /// Cost    Proportional to `index`: HDF5 visits all chunks before it.
  ChunkPlace locate(std::uint64_t index) const;
  /// Returns the shape with all chunks.
  ChunkedColumn with_chunks() const;
  /// Returns whether HDF5 finds the same shape and chunks.
  /// Cost    Chunks are located only if the shape is the same, because a damaged shape can have any number of them.
  bool matches(const ChunkedColumn& listed) const;
  /// Returns the stored size of all chunks in bytes.
  std::uint64_t stored_bytes() const;

 private:
  IndexedColumn(const Hdf5File& file, const Hdf5Column& column, OpenColumn open);

  const Hdf5File& file_;
  Hdf5Column column_;
  ChunkedColumn shape_;
  Hdf5Id set_;
};

}  // namespace gigabake
