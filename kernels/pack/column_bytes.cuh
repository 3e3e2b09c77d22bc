/// From columns in device memory to what a file holds of them, in the host's memory.
#pragma once

#include <memory>
#include <vector>

#include "kernels/cuda/memory.cuh"
#include "kernels/pack/packer.h"
#include "kernels/pack/pinned_pool.cuh"

namespace gigabake::kernels {

/// A column in the buffer that holds all of them raw.
struct RawColumn {
  PackedColumn* column;  ///< to be told where its bytes are; rows are set
  RowShape shape;
  std::size_t at;     ///< in the buffer
  std::size_t bytes;  ///< of all of its chunks; zeros stand after the last row
};

/// Brings all columns to the host, and tells each of them where it is. Returns what they borrow. Waits for the stream.
/// Errors  CudaFailure.
std::shared_ptr<const void> bring_raw(DeviceHeap& heap, const DeviceArray<std::uint8_t>& raw,
                                      const std::vector<RawColumn>& columns, PinnedPool& pinned);

/// As chunks that deflate has compressed here, with their checksums: what a file holds.
/// Cost    Device memory as pack_chunks().
std::shared_ptr<const void> bring_stored(DeviceHeap& heap, const DeviceArray<std::uint8_t>& raw,
                                         const std::vector<RawColumn>& columns, PinnedPool& pinned);

}  // namespace gigabake::kernels
