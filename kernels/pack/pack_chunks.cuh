/// Compression of raw chunks in device memory to chunks in HDF5's storage format, by the rules of core/codec.
///
/// Exact   The same bytes as deflate in encode_chunk() of format/shard, chunk by chunk.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/cuda/device/clock.cuh"
#include "kernels/cuda/device/memory.cuh"
#include "kernels/pack/raw_chunk.h"

namespace gigabake::kernels {

struct PackedChunks {
  /// All chunks, concatenated in the first ends.back() bytes. The array has the max size of packed chunks.
  DeviceArray<std::uint8_t> bytes;
  std::vector<std::uint64_t> ends;  ///< the end of each chunk, where the next chunk begins
};

/// Packs `chunks`, which may be in any order. `raw` is in device memory. `clock` is null or receives the marks 0 … 6 of
/// the last batch; `pack_steps` has the names of the steps between marks.
/// Cost    Device memory in addition to the result: at most memory_per_batch_byte per raw byte of a batch. A batch has
///         at most pack_batch_bytes, or is one larger chunk. Batches are smaller if the heap's limit requires it. The
///         host waits once, at the end.
/// Errors  DeviceFull. CudaFailure, also if a chunk is larger than max_packed_chunk_bytes.
PackedChunks pack_chunks(DeviceHeap& heap, const std::uint8_t* raw, std::span<const RawChunk> chunks,
                         StreamClock* clock);

}  // namespace gigabake::kernels
