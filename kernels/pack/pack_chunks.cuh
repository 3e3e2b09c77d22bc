/// Chunks of raw bytes on a device to chunks as HDF5 stores them, by the rules of lattice/pack.
///
/// Exact   The bytes that encode_chunk() of format/shard makes with deflate, chunk for chunk.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/cuda/clock.cuh"
#include "kernels/cuda/memory.cuh"
#include "kernels/pack/raw_chunk.h"

namespace gigabake::kernels {

struct PackedChunks {
  /// All chunks back to back in their first ends.back() bytes. It is as large as if nothing had been packed.
  DeviceArray<std::uint8_t> bytes;
  std::vector<std::uint64_t> ends;  ///< where each chunk ends, and the next one begins
};

/// raw: of the device; the chunks may lie in it as they like. clock: null, or marked with steps 0 … 6 of the last
/// batch, whose names are in `pack_steps`. Cost    Device memory besides the result: six bytes for each raw byte of a
/// batch, which is at most pack_batch_bytes,
///         or one chunk that is larger. The host waits once, at the end.
/// Errors  DeviceFull, CudaFailure; also where a chunk is larger than largest_packed_chunk.
PackedChunks pack_chunks(DeviceHeap& heap, const std::uint8_t* raw, std::span<const RawChunk> chunks,
                         StreamClock* clock);

}  // namespace gigabake::kernels
