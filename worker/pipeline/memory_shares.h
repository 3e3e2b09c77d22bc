/// The shares of a rank's memory, and of its device's memory, that the stages of the pipeline take.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "worker/pipeline/writer_pool_size.h"

namespace gigabake {

inline constexpr std::uint64_t min_kernel_bytes = std::uint64_t(16) << 20;

/// Returns the memory for tiles and textures of the source.
inline std::uint64_t cache_bytes(const WorkerOptions& options) {
  return options.memory_bytes == 0 ? std::numeric_limits<std::uint64_t>::max() : options.memory_bytes / 4;
}

/// Returns the kernels' memory for one of the cells that are computed concurrently. 0 means no limit.
inline std::uint64_t kernel_bytes(const WorkerOptions& options) {
  if (options.memory_bytes == 0) return 0;
  return std::max(options.memory_bytes / 2 / concurrent_cells_for(options), min_kernel_bytes);
}

/// Returns the target for the memory of the device. 0 means no limit.
inline std::uint64_t device_bytes(const WorkerOptions& options) {
  return options.device_bytes != 0 ? options.device_bytes : options.memory_bytes;
}

/// Returns the kernels' memory on the device. 0 means no limit.
inline std::uint64_t device_kernel_bytes(const WorkerOptions& options) {
  const std::uint64_t bytes = device_bytes(options);
  return bytes == 0 ? 0 : std::max(bytes / 2, min_kernel_bytes);
}

/// Returns the memory for rows from which overviews are made.
inline std::uint64_t overview_bytes(const WorkerOptions& options) {
  constexpr std::uint64_t unbounded = std::uint64_t(512) << 20;
  return options.memory_bytes == 0 ? unbounded : options.memory_bytes / 32;
}

/// Returns the memory for packing on the device, of all packers together. 0 means no limit.
inline std::uint64_t packing_bytes(const WorkerOptions& options) { return device_bytes(options) / 4; }

/// Returns the memory for textures on the device. 0 means the default of CudaBaker.
inline std::uint64_t texture_bytes(const WorkerOptions& options) { return device_bytes(options) / 4; }

}  // namespace gigabake
