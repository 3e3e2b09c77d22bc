/// Device packing of bytes in host memory, for tests and benchmarks.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/error.h"
#include "kernels/pack/raw_chunk.h"

namespace gigabake::kernels {

/// The names of the steps that DevicePacked::step_seconds measures, in order.
inline constexpr std::array<const char*, 6> pack_steps = {"candidates", "matches", "parse", "codes", "write", "sums"};

struct DevicePacked {
  std::vector<std::uint8_t> bytes;       ///< all chunks, concatenated
  std::vector<std::uint64_t> ends;       ///< the end of each chunk in `bytes`
  std::vector<double> seconds;           ///< device time of each round, without transfers
  std::array<double, 6> step_seconds{};  ///< device time per step in the last batch of the last round
  std::uint64_t peak_bytes = 0;          ///< max device memory, including raw bytes and result
};

/// Packs the same chunks `rounds` times.
/// Errors  CudaFailure; always thrown in builds without CUDA.
DevicePacked pack_on_device(int device, std::span<const std::uint8_t> raw, std::span<const RawChunk> chunks,
                            int rounds);

}  // namespace gigabake::kernels
