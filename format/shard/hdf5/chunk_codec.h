/// Encoding of one stored chunk. The bytes are optionally shuffled, then packed by LZ4 (frame of HDF5 filter 32004) or
/// deflate (zlib frame). HDF5's Fletcher-32 checksum follows.
///
/// Source  The HDF Group's registered filter 32004 ("HDF5_LZ4"). A frame begins with the unpacked size (uint64) and the
///         block size (uint32). Each block has its stored size (uint32) and its data. The data is raw if the stored
///         size equals the unpacked size of the block. Integers are big-endian. HDF5 File Format Specification:
///         shuffle, deflate and Fletcher-32 filters.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/rules.h"
#include "core/codec/matches.h"

namespace gigabake {

/// The filters applied to a column's chunks before the checksum.
struct ChunkFilters {
  Codec codec = Codec::lz4;
  /// Element size in bytes for the shuffle filter. The filter stores the first bytes of all elements, then the second
  /// bytes, and so on. The value 1 means that chunks are not shuffled.
  /// Range   The size of a chunk is a multiple of shuffled_bytes.
  std::size_t shuffled_bytes = 1;
  /// The shortest match that deflate may write. Readers need not know it.
  /// Range   ≥ deflate::min_match.
  std::uint32_t min_match_bytes = deflate::min_match;
};

/// Writes the chunk's bytes to `to` in shuffled order. Copies them unchanged if `element_bytes` is 0 or 1.
/// Range   raw.size() is a multiple of element_bytes.
void shuffle_chunk(std::span<const std::uint8_t> raw, std::size_t element_bytes, std::uint8_t* to);

/// Returns the chunk in its stored form, checksum included. Deflate follows the rules of core/codec, so a device
/// writes the same bytes (kernels/pack).
std::vector<std::uint8_t> encode_chunk(std::span<const std::uint8_t> raw, const ChunkFilters& filters);

/// Returns whether the chunk's checksum is the one of its bytes.
bool has_valid_checksum(std::span<const std::uint8_t> stored);

/// Fills `raw` with the first unpacked bytes of a chunk that has `chunk_bytes` bytes in total. Returns false if the
/// checksum is wrong or the frame does not hold `chunk_bytes` bytes.
/// Range   raw.size() ≤ chunk_bytes.
/// Cost    Checksums the whole chunk. Unpacks only the requested bytes of an LZ4 chunk that is not shuffled, and the
///         whole of every other chunk.
bool decode_chunk(std::span<const std::uint8_t> stored, const ChunkFilters& filters, std::size_t chunk_bytes,
                  std::span<std::uint8_t> raw);

}  // namespace gigabake
