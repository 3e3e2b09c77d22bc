/// The zlib frame of one chunk, by the rules of lattice/pack: the bytes that a device makes of it too.
///
/// Range   Up to 2^30 bytes.
/// Cost    A core's 4 ns a byte, less than libdeflate's level 1 (docs/experiments/kernels.md). A thread keeps its
///         working memory: 0.2 MB, and twice its largest chunk.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace gigabake {

/// bytes: with deflate::readable_beyond bytes more behind them, which do not count. room: left for what follows the
/// frame, so that it can be appended without moving it.
std::vector<std::uint8_t> zlib_frame(std::span<const std::uint8_t> bytes, std::size_t room);

}  // namespace gigabake
