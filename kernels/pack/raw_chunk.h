/// What is packed on a device: a chunk's place among raw bytes, and how its bytes are ordered first.
#pragma once

#include <cstdint>

namespace gigabake::kernels {

struct RawChunk {
  std::uint64_t begin = 0;          ///< its first byte
  std::uint32_t bytes = 0;          ///< all of them: the last chunk's padding is the caller's
  std::uint32_t element_bytes = 1;  ///< more than 1: HDF5's shuffle of such elements first. Range  divides `bytes`
};

inline constexpr std::uint32_t largest_packed_chunk = 1u << 26;
/// Raw bytes that are packed at a time.
inline constexpr std::uint64_t pack_batch_bytes = std::uint64_t(1) << 26;

}  // namespace gigabake::kernels
