/// Transfer of columns from device memory to host memory, raw or in storage format.
#pragma once

#include <memory>
#include <vector>

#include "kernels/cuda/device/memory.cuh"
#include "kernels/pack/packer.h"
#include "kernels/pack/pinned_pool.cuh"

namespace gigabake::kernels {

/// A column in the buffer that holds all raw columns.
struct RawColumn {
  PackedColumn* column;  ///< `rows` is set already; the transfer sets `raw` or `stored`
  RowShape shape;
  std::size_t at;     ///< offset of the column in the buffer
  std::size_t bytes;  ///< size of all chunks of the column; zeros follow the last row
};

/// Reads back all columns and sets the member `raw` of each PackedColumn. Returns the memory that the columns borrow.
/// Waits for the stream.
/// Errors  CudaFailure.
std::shared_ptr<const void> read_back_raw(DeviceHeap& heap, const DeviceArray<std::uint8_t>& raw,
                                          const std::vector<RawColumn>& columns, PinnedPool& pinned);

/// Compresses the columns on the device, reads them back and sets the member `stored` of each PackedColumn: chunks with
/// checksums. Otherwise like read_back_raw().
/// Cost    The device memory of pack_chunks().
std::shared_ptr<const void> read_back_stored(DeviceHeap& heap, const DeviceArray<std::uint8_t>& raw,
                                             const std::vector<RawColumn>& columns, PinnedPool& pinned);

}  // namespace gigabake::kernels
