/// The bytes of one stored chunk: shuffled or not, then LZ4 in the frame of HDF5 filter 32004 or deflate in a zlib
/// frame, then HDF5's Fletcher-32.
///
/// Source  The HDF Group's registered filter 32004 ("HDF5_LZ4"): big-endian uint64 size, uint32 block size, then per
///         block a uint32 stored size and the data, raw where the size equals the block's. HDF5 file format: shuffle,
///         deflate, Fletcher-32.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lattice/rules.h"

namespace gigabake {

/// What was done to a column's chunks, before the checksum.
struct ChunkFilters {
  Codec codec = Codec::lz4;
  /// The first bytes of all elements of so many bytes, then their second ones, and so on. 1: as they are.
  /// Range  Chunks are whole elements.
  std::size_t shuffled_bytes = 1;
};

/// A chunk's bytes in the order that they are packed in, to `to`. Range  raw is whole elements; 0 and 1: as they are.
void shuffle_chunk(std::span<const std::uint8_t> raw, std::size_t element_bytes, std::uint8_t* to);

/// Deflate   As lattice/pack says: a device makes the same bytes (kernels/pack).
std::vector<std::uint8_t> encode_chunk(std::span<const std::uint8_t> raw, const ChunkFilters& filters);

/// Fills `raw` with the first bytes of a chunk of `chunk_bytes`. Range  raw.size() ≤ chunk_bytes.
/// Cost    The checksum is of the whole chunk. Of a plain LZ4 chunk only what is asked for is unpacked, else all of it.
/// False where the checksum is wrong or the frame is none of so many bytes.
bool decode_chunk(std::span<const std::uint8_t> stored, const ChunkFilters& filters, std::size_t chunk_bytes,
                  std::span<std::uint8_t> raw);

}  // namespace gigabake
