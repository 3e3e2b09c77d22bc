/// Deflate of one chunk in a zlib frame, by the rules of core/codec. A device writes the same bytes.
/// Range   The chunk has at most 2^30 bytes.
/// Cost    4 ns of one core per byte, less than libdeflate's level 1 (docs/experiments/kernels.md). Each thread keeps
///         its working memory: 0.2 MB plus twice its largest chunk.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace gigabake {

/// Returns the zlib frame of `bytes`, whose matches have at least `min_match_bytes` bytes. Reserves `buffer` more
/// bytes, so that the caller can append to the frame without a reallocation.
/// Range   min_match_bytes ≥ deflate::min_match. `bytes` must be followed by deflate::readable_beyond readable bytes,
///         whose values do not matter.
std::vector<std::uint8_t> zlib_frame(std::span<const std::uint8_t> bytes, std::uint32_t min_match_bytes,
                                     std::size_t buffer);

}  // namespace gigabake
