/// What a bake process is told before anything else: enough to bake by itself.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lattice/parameters.h"
#include "worker/backend.h"
#include "worker/cell_pipeline.h"

namespace gigabake {

struct WorkerSetup {
  BakeParameters parameters;
  WorkerOptions worker;  ///< but for cuda_device, which the process chooses
  DeviceWish device;
  /// format/job/source_bytes.h. Relative paths count from the process's working folder, which it inherits.
  std::shared_ptr<const std::vector<std::uint8_t>> sources;
};

/// All but the sources, which travel before it, in parts.
std::vector<std::uint8_t> to_bytes(const WorkerSetup& setup);
/// Errors  InputError when malformed, UsageError where a parameter is out of range.
WorkerSetup setup_from_bytes(std::span<const std::uint8_t> bytes);

}  // namespace gigabake
