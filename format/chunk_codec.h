/// The bytes of one stored chunk: LZ4 in the frame of HDF5 filter 32004, then HDF5's Fletcher-32.
///
/// Source  The HDF Group's registered filter 32004 ("HDF5_LZ4"): big-endian uint64 size, uint32 block size, then per
///         block a uint32 stored size and the data, raw where the size equals the block's. HDF5 file format,
///         Fletcher-32.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gigabake {

std::vector<std::uint8_t> encode_chunk(std::span<const std::uint8_t> raw);

/// Fills `raw` with the first bytes of a chunk of `chunk_bytes`. Range  raw.size() ≤ chunk_bytes.
/// Cost    The checksum is of the whole chunk; only what is asked for is unpacked.
/// False where the checksum is wrong or the frame is none of so many bytes.
bool decode_chunk(std::span<const std::uint8_t> stored, std::size_t chunk_bytes, std::span<std::uint8_t> raw);

}  // namespace gigabake
