/// Transfers columns from device memory to host memory, raw or in storage format.
#pragma once

#include <memory>
#include <vector>

#include "kernels/cuda/device/memory.cuh"
#include "kernels/pack/packer.h"
#include "kernels/pack/pinned_pool.cuh"

namespace gigabake::kernels {

/// A column in the buffer that holds all raw columns.
struct RawColumn {
  PackedColumn* column;  ///< its rows are set; the transfer sets its bytes
  RowShape shape;
  std::size_t at;     ///< offset in the buffer
  std::size_t bytes;  ///< size of all its chunks; zeros follow the last row
};

/// Reads back all columns and sets the `raw` bytes of each. Returns the memory that the columns borrow. Waits for the
/// stream.
/// Errors  CudaFailure.
std::shared_ptr<const void> read_back_raw(DeviceHeap& heap, const DeviceArray<std::uint8_t>& raw,
                                          const std::vector<RawColumn>& columns, PinnedPool& pinned);

/// Like read_back_raw(), but compresses the columns on the device and sets the `stored` chunks, with their checksums.
/// Cost    Device memory like pack_chunks().
std::shared_ptr<const void> read_back_stored(DeviceHeap& heap, const DeviceArray<std::uint8_t>& raw,
                                             const std::vector<RawColumn>& columns, PinnedPool& pinned);

}  // namespace gigabake::kernels
