/// A chunk to pack on a device: its position among the raw bytes, and its shuffle.
#pragma once

#include <cstdint>

#include "core/codec/matches.h"

namespace gigabake::kernels {

struct RawChunk {
  std::uint64_t begin = 0;          ///< offset of the chunk's first byte
  std::uint32_t bytes = 0;          ///< total size; the caller pads the last chunk
  std::uint32_t element_bytes = 1;  ///< element size of HDF5's shuffle, which divides `bytes`; 1: no shuffle
  std::uint32_t min_match_bytes = deflate::min_match;
};

inline constexpr std::uint32_t max_packed_chunk_bytes = 1u << 26;
/// The limits of the number of raw bytes in a batch, unless the batch is one larger chunk. Few bytes leave a part of
/// the device idle.
inline constexpr std::uint64_t min_pack_batch_bytes = std::uint64_t(1) << 20, pack_batch_bytes = std::uint64_t(1) << 26;
/// The max number of bytes of device memory per raw byte of a batch.
inline constexpr std::uint64_t memory_per_batch_byte = 6;

}  // namespace gigabake::kernels
