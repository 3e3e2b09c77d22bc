/// First message to a bake process; it contains everything that the process needs to bake.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/octree/parameters.h"
#include "worker/pipeline/backend.h"
#include "worker/pipeline/cell_pipeline.h"

namespace gigabake {

struct WorkerSetup {
  BakeParameters parameters;
  WorkerOptions worker;  ///< except cuda_device, which the process chooses
  DeviceRequest device;
  /// Serialized as in format/job/source_bytes.h. Relative paths are relative to the process's working folder, which it
  /// inherits.
  std::shared_ptr<const std::vector<std::uint8_t>> sources;
};

/// Serializes all fields except the sources, which are sent before the setup, in parts.
std::vector<std::uint8_t> to_bytes(const WorkerSetup& setup);
/// Reads what to_bytes() wrote.
/// Errors  InputError when malformed, UsageError if a parameter is out of range.
WorkerSetup setup_from_bytes(std::span<const std::uint8_t> bytes);

}  // namespace gigabake
