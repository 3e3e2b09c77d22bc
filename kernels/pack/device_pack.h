/// Packing on a device, for whoever has its bytes on the host: tests and benchmarks.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/pack/raw_chunk.h"
#include "lattice/cuda_failure.h"

namespace gigabake::kernels {

/// What pack_steps of the last batch took, in its order.
inline constexpr std::array<const char*, 6> pack_steps = {"candidates", "matches", "parse", "codes", "write", "sums"};

struct DevicePacked {
  std::vector<std::uint8_t> bytes;       ///< all chunks back to back
  std::vector<std::uint64_t> ends;       ///< where each chunk ends
  std::vector<double> seconds;           ///< of each round, on the device, without transfers
  std::array<double, 6> step_seconds{};  ///< of the last round's last batch
  std::uint64_t peak_bytes = 0;          ///< device memory, raw bytes and result included
};

/// Packs the same chunks `rounds` times. Errors  CudaFailure; without CUDA always.
DevicePacked pack_on_device(int device, std::span<const std::uint8_t> raw, std::span<const RawChunk> chunks,
                            int rounds);

}  // namespace gigabake::kernels
